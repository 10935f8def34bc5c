"""National Instruments TDMS, by npTDMS (the extra ``tdms``)."""

from __future__ import annotations

import io
import logging
import struct
from typing import Any

import numpy as np

from ssmr_ident.core.recording import Note, Recording
from ssmr_ident.readers.options import ReadOptions
from ssmr_ident.readers.source import Source, missing_library
from ssmr_ident.readers.table.assemble import recordings_of
from ssmr_ident.readers.table.columns import Column, Table, facts
from ssmr_ident.readers.table.headings import quantity_of, split_header
from ssmr_ident.readers.text.header_rows import rate_from

NAMES = ("tdms",)
_UNIT_KEYS = ("unit_string", "Unit", "unit", "Units", "units", "NI_UnitDescription")


def recognises(source: Source) -> bool:
    return source.kind == "tdms"


def read(source: Source, options: ReadOptions) -> list[Recording]:
    """Recordings of a .tdms file, one per group.

    Raises
    ------
    InputError
        npTDMS is not installed, the file is damaged, or it does not say its rate.
    """
    try:
        from nptdms import TdmsFile
        from nptdms.log import log_manager
    except ImportError as error:
        raise missing_library(source, "a TDMS file", "npTDMS", "tdms") from error
    _check_segments(source)
    level = log_manager.log_level
    log_manager.set_level(logging.CRITICAL)  # what it would say about a cut file is said below, with the mend
    try:
        file = TdmsFile.read(io.BytesIO(source.data))
        status = file.file_status
        recordings = [
            recording
            for group in file.groups()
            if len(group.channels())
            for recording in _group(source, group, bool(status.incomplete_final_segment), file.properties, options)
        ]
    except (
        ValueError,
        KeyError,
        IndexError,
        TypeError,
        EOFError,
        OSError,
        AttributeError,
        OverflowError,
        MemoryError,
        NotImplementedError,
        AssertionError,
        RuntimeError,
        struct.error,
    ) as error:
        # npTDMS reports damage by whatever its parsing stumbles over
        raise source.error(f"TDMS is damaged ({type(error).__name__}: {str(error)[:100]})", "Copy it again.") from error
    finally:
        log_manager.set_level(level)
    if not recordings:
        raise source.error("has no channels with data", "Copy it again, or check that the log was closed.")
    return recordings


def _check_segments(source: Source) -> None:
    """Follow the lead-ins (28 bytes: tag, flags, version, next offset, raw offset) and stop at garbage."""
    data, offset, end = source.data, 0, len(source.data)
    while offset < end:
        if data[offset : offset + 4] != b"TDSm":
            raise source.error(
                f"garbage between segments: {data[offset : offset + 4]!r} instead of TDSm",
                "Copy it again.",
                f"byte {offset}",
            )
        if offset + 28 > end:
            return
        following = int.from_bytes(data[offset + 12 : offset + 20], "little")
        if following >= 2**63:
            return  # the last segment of a log that was not closed
        offset += 28 + following


def _group(source: Source, group: Any, incomplete: bool, properties: Any, options: ReadOptions) -> list[Recording]:
    channels = [channel for channel in group.channels() if len(channel)]
    if not channels:
        return []
    notes: list[Note] = []
    columns: list[Column] = []
    starts: list[float] = []
    for number, channel in enumerate(channels):
        values = np.asarray(channel[:])
        label, unit = split_header(channel.name, source.vocabulary)
        stated = next((str(channel.properties[k]).strip() for k in _UNIT_KEYS if channel.properties.get(k)), "") or unit
        if np.issubdtype(values.dtype, np.datetime64):
            seconds = (values - values[0]) / np.timedelta64(1, "us") * 1e-6
            columns.append(Column(label, "s", seconds.astype(float), quantity="time", number=number))
        elif np.issubdtype(values.dtype, np.number) and not np.issubdtype(values.dtype, np.complexfloating):
            column = Column(label, stated, values.astype(float), number=number)
            starts.append(_own_clock(source, group, channel, column, properties))
            columns.append(column)
        else:
            notes.append(Note("info", f"channel {channel.name} holds {values.dtype}, no numbers; left out"))
    if not columns:
        return []
    timed = any((c.quantity or quantity_of(c.label, c.unit, source.vocabulary)) == "time" for c in columns)
    if timed or options.fs is not None:
        for column in columns:
            column.step = 0.0
    else:
        _one_zero(source, group, [c for c in columns if c.quantity is None], starts, notes)
    _lengths(source, group, columns, incomplete, timed or options.fs is not None, options, notes)
    keep = {
        **{str(k): str(v) for k, v in properties.items()},
        **{str(k): str(v) for k, v in group.properties.items()},
    }
    table = Table(
        columns,
        lambda row: f"{group.name}, sample {row + 1}",
        f"group {group.name}",
        facts(keep),
        notes,
        "V",
        axes_in_volts=True,
        split=False,
    )
    return recordings_of(source, "tdms", table, options)


def _own_clock(source: Source, group: Any, channel: Any, column: Column, of_file: Any) -> float:
    """Step and start of a channel's waveform; the moment of its start in seconds since 1970, 0 where none stands.

    Without a waveform a sampling rate among the properties of channel, group or file says the step.
    """
    properties = channel.properties
    step = properties.get("wf_increment")
    if step is None:
        for facts_of in (properties, group.properties, of_file):
            told = rate_from({str(k): str(v) for k, v in facts_of.items()}, source.vocabulary)
            if told is not None:
                column.step = 1.0 / told[0]
                break
    else:
        column.step = float(step)
        if not (0 < column.step < float("inf")):
            raise source.error(f"wf_increment is {column.step:g} s", "Give --fs.", f"group {group.name}")
    column.start = float(properties.get("wf_start_offset") or 0.0)
    moment = properties.get("wf_start_time")
    if moment is None:
        return 0.0
    return float((np.datetime64(moment) - np.datetime64("1970-01-01")) / np.timedelta64(1, "us")) * 1e-6


def _one_zero(source: Source, group: Any, columns: list[Column], starts: list[float], notes: list[Note]) -> None:
    """Starts counted from the earliest channel's ``wf_start_time``."""
    if not any(c.step for c in columns):
        raise source.error("has no time channel and no wf_increment", "Give --fs.", f"group {group.name}")
    first = next(c.step for c in columns if c.step)
    for column in columns:
        column.step = column.step or first
    if min(starts) > 0:
        earliest = min(starts)
        for column, start in zip(columns, starts, strict=True):
            column.start += start - earliest
    rates = ", ".join(f"{rate:.6g} Hz" for rate in sorted({1 / c.step for c in columns}))
    notes.append(Note("info", f"time from wf_start_time, wf_start_offset and wf_increment: {rates}"))
    begins = {c.shown: c.start for c in columns}
    if max(begins.values()) > min(begins.values()):
        apart = max(begins.values()) - min(begins.values())
        shown = ", ".join(f"{label} at {begin:.6g} s" for label, begin in begins.items())
        text = f"the channels begin {apart:.6g} s apart by wf_start_time: {shown}"
        notes.append(Note("warning", text, group.name))


def _lengths(
    source: Source, group: Any, columns: list[Column], incomplete: bool, timed: bool, options: ReadOptions,
    notes: list[Note],
) -> None:  # fmt: skip
    """Channels of one clock must be of one length; a cut file is trimmed to what all have."""
    lengths = {c.shown: len(c.values) for c in columns}
    shortest = min(lengths.values())
    alike = timed or len({(c.start, c.step) for c in columns}) == 1
    if incomplete:
        text = f"the last segment is incomplete (the log was cut off); {shortest} samples per channel are whole"
        notes.append(Note("warning", text, group.name))
    elif len(set(lengths.values())) > 1 and alike:
        shown = ", ".join(f"{name} {count}" for name, count in lengths.items())
        if not options.trim:
            raise source.error(f"channels differ: {shown} samples", "Keep what all have with --trim.", group.name)
        notes.append(Note("warning", f"channels differ ({shown} samples); trimmed to {shortest}", group.name))
    if alike:
        for column in columns:
            column.values = column.values[:shortest]
