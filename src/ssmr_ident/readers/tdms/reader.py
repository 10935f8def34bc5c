"""National Instruments TDMS, by npTDMS (the extra ``tdms``)."""

from __future__ import annotations

import io
import logging
import struct
from typing import Any

import numpy as np

from ssmr_ident.core.recording import Note, Recording
from ssmr_ident.readers.options import ReadOptions
from ssmr_ident.readers.source import Source
from ssmr_ident.readers.table.assemble import recordings_of
from ssmr_ident.readers.table.columns import Column, Table, facts
from ssmr_ident.readers.table.headings import quantity_of, split_header

NAMES = ("tdms",)


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
        raise source.error("is a TDMS file, which needs npTDMS", 'Run: pip install "ssmr_ident[tdms]"') from error
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
    notes = []
    lengths = {channel.name: len(channel) for channel in channels}
    shortest = min(lengths.values())
    if incomplete:
        notes.append(
            Note(
                "warning",
                f"the last segment is incomplete (the log was cut off); {shortest} samples per channel are whole",
                group.name,
            )
        )
    elif len(set(lengths.values())) > 1:
        shown = ", ".join(f"{name} {count}" for name, count in lengths.items())
        if not options.trim:
            raise source.error(f"channels differ: {shown} samples", "Keep what all have with --trim.", group.name)
        notes.append(Note("warning", f"channels differ ({shown} samples); trimmed to {shortest}", group.name))
    columns = []
    for channel in channels:
        values = np.asarray(channel[:])[:shortest]
        label, unit = split_header(channel.name)
        stated = str(channel.properties.get("unit_string") or "").strip() or unit
        if np.issubdtype(values.dtype, np.datetime64):
            seconds = (values - values[0]) / np.timedelta64(1, "us") * 1e-6
            columns.append(Column(label, "s", seconds.astype(float), quantity="time"))
        elif np.issubdtype(values.dtype, np.number) and not np.issubdtype(values.dtype, np.complexfloating):
            columns.append(Column(label, stated, values.astype(float)))
        else:
            notes.append(Note("info", f"channel {channel.name} holds {values.dtype}, no numbers; left out"))
    if not columns:
        return []
    if not any((c.quantity or quantity_of(c.label, c.unit)) == "time" for c in columns) and options.fs is None:
        columns.insert(0, _computed_time(source, group, channels, shortest, notes))
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


def _computed_time(source: Source, group: Any, channels: Any, count: int, notes: list[Note]) -> Column:
    increments = {float(c.properties["wf_increment"]) for c in channels if c.properties.get("wf_increment")}
    if not increments:
        raise source.error("has no time channel and no wf_increment", "Give --fs.", f"group {group.name}")
    if len(increments) > 1:
        raise source.error(
            f"channels have different rates: {sorted(1 / i for i in increments)} Hz",
            "Put channels of one rate into one group.",
            f"group {group.name}",
        )
    step = increments.pop()
    if not (0 < step < float("inf")):
        raise source.error(f"wf_increment is {step:g} s", "Give --fs.", f"group {group.name}")
    begin = float(channels[0].properties.get("wf_start_offset") or 0.0)
    notes.append(Note("info", f"time from wf_start_offset and wf_increment: {1 / step:.6g} Hz"))
    return Column("wf_increment", "s", begin + np.arange(count) * step, quantity="time")
