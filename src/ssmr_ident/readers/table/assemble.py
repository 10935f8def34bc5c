"""From columns of a table to Recordings: names, time, units to SI, parts, clocks of their own, checks. All formats'."""

from __future__ import annotations

import itertools
from collections.abc import Callable
from dataclasses import replace

import numpy as np

from ssmr_ident.core.recording import Channel, Note, Recording, Series
from ssmr_ident.readers.health import warnings_of
from ssmr_ident.readers.options import ReadOptions
from ssmr_ident.readers.source import Source
from ssmr_ident.readers.table import time_axis
from ssmr_ident.readers.table.channels import channels_of
from ssmr_ident.readers.table.clock import Clocked, clocked
from ssmr_ident.readers.table.columns import Column, Table, all_finite
from ssmr_ident.readers.table.fill_values import without_fill_values
from ssmr_ident.readers.table.naming import named_columns
from ssmr_ident.readers.table.runs import runs_of

_BLANK = 0.9
"""Choice: share of filled cells below which a column that is filled at even distances has a rate of its own."""
_RARE = 0.01
"""Choice: share of rows without a stamp that are left out; with more of them the table is not understood."""


def recordings_of(source: Source, reader: str, table: Table, options: ReadOptions) -> list[Recording]:
    """The recordings that a table holds; several when time begins again.

    Raises
    ------
    InputError
        Time or a unit is missing, or time cannot be used.
    """
    runs = {} if options.columns else runs_of(table.columns, source.vocabulary)
    if runs:
        part = f"{table.part}, " if table.part else ""
        each = [replace(table, columns=made, part=part + run, notes=list(table.notes)) for run, made in runs.items()]
        return [recording for one in each for recording in recordings_of(source, reader, one, options)]
    columns = named_columns(source, table, options)
    without_fill_values(columns, table)
    groups = clocked(source, columns, options, table)
    made = [_on_rows(source, group, table, options) for group in groups]
    longest = max(made, key=lambda m: len(m[0].time))[0]
    channels = iter(channels_of(source, [c for _, members, _ in made for c in members], table, _seen(source, longest)))
    by_group = [(axis, rows, [next(channels) for c in members if _has_numbers(c)]) for axis, members, rows in made]
    by_group = [group for group in by_group if group[2]]
    if len(by_group) > 1:
        return [_of_several_clocks(source, reader, table, by_group)]
    axis, rows, found = by_group[0]
    edges = [0, *axis.restarts, len(axis.time)]
    return [
        _part(source, reader, table, axis.time[a:b], _place(table, rows, a), [_cut(c, a, b) for c in found],
              (number, len(edges) - 1))
        for number, (a, b) in enumerate(itertools.pairwise(edges), start=1)
    ]  # fmt: skip


def _has_numbers(column: Column) -> bool:
    return bool(np.isfinite(column.values).any())


def _seen(source: Source, axis: time_axis.TimeAxis) -> str:
    """What is understood of a log whose units are asked for."""
    count = len(axis.time)
    if count < 2:
        return f"{count} rows"
    parts = f", {len(axis.restarts) + 1} parts" if axis.restarts else ""
    end = axis.restarts[0] if axis.restarts else count
    lasting = float(axis.time[end - 1] - axis.time[0])
    rate = (end - 1) / lasting if lasting > 0 else 0.0
    doubts = [note for note in source.notes if note.level == "warning"] + axis.notes
    notes = "; ".join(note.text.split(";")[0] for note in doubts[:2])
    return f"{count} rows{parts} at {rate:.6g} Hz{'; ' + notes if notes else ''}"


def _on_rows(
    source: Source, group: Clocked, table: Table, options: ReadOptions
) -> tuple[time_axis.TimeAxis, list[Column], np.ndarray | None]:
    """A clock looked over, and its columns cut to the rows that it keeps."""
    stamps, rows = group.stamps, group.rows
    if not all_finite(stamps):
        kept = np.isfinite(stamps)
        lost = int((~kept).sum())
        row = int(np.flatnonzero(~kept)[0])
        place = _place(table, rows, 0)(row)
        if options.on_bad != "nan" and lost > max(3, _RARE * len(stamps)):
            raise source.error(
                f"time is missing in {lost} of {len(stamps)} rows", "Drop them with --on-bad nan, or mend them.", place
            )
        table.notes.append(Note("warning", f"{lost} row(s) without time dropped", place))
        rows = np.flatnonzero(kept) if rows is None else rows[kept]
        stamps = stamps[kept]
    if group.exact:
        axis = time_axis.TimeAxis(stamps)
    else:
        here = rows

        def repeats(of: np.ndarray) -> np.ndarray:
            places = of if here is None else here[of]
            before = of - 1 if here is None else here[of - 1]
            alike = [(c.values[places] == c.values[before]) | np.isnan(c.values[places]) for c in group.columns]
            same: np.ndarray = np.all(alike, axis=0)
            return same

        try:
            axis = time_axis.check(
                stamps, _place(table, rows, 0), split=table.split, repeats=repeats, stamps_are=options.stamps
            )
        except time_axis.TimeProblem as error:
            raise source.error(error.problem, error.mend, _place(table, rows, 0)(error.row)) from error
    table.notes += axis.notes
    if axis.rows is not None:
        rows = axis.rows if rows is None else rows[axis.rows]
    if rows is not None:  # a copy of a million rows costs more than reading them
        for column in group.columns:
            column.values = column.values[rows]
    return axis, group.columns, rows


def _place(table: Table, rows: np.ndarray | None, begin: int) -> Callable[[int], str]:
    """Names a kept row of the table, counted from ``begin``."""
    return lambda row: table.place(begin + row if rows is None else int(rows[begin + row]))


def _cut(channel: Channel, a: int, b: int) -> Channel:
    return replace(channel, samples=channel.samples[a:b])


def _part(
    source: Source,
    reader: str,
    table: Table,
    time: np.ndarray,
    place: Callable[[int], str],
    channels: list[Channel],
    of: tuple[int, int],
) -> Recording:
    """One part of a table with one clock, on which some columns may have samples in some of the rows only."""
    part = table.part
    if len(time) < 2:
        raise source.error(
            f"has {len(time)} row(s) of data",
            "A recording needs two samples at least.",
            place(0) if len(time) else part,
        )
    if of[1] > 1:
        part = f"{part}, sample {of[0]} of {of[1]}".lstrip(", ")
    notes = table.notes + time_axis.gaps(time, place)
    kept: list[Channel] = []
    for channel in channels:
        if all_finite(channel.samples):
            kept.append(channel)
            continue
        filled = np.flatnonzero(np.isfinite(channel.samples))
        if not len(filled):
            notes.append(Note("warning", f"{channel.label} has no number here; left out", part))
            continue
        series = _own_rate(time, channel.samples, filled)
        if series is not None:
            notes.append(
                Note(
                    "info",
                    f"{channel.label} has a rate of its own, {series.rate:.6g} Hz: {len(filled)} samples from "
                    f"{series.time[0]:.6g} s on, blank in the other rows",
                )
            )
            kept.append(replace(channel, logged=series))
            continue
        missing = np.flatnonzero(~np.isfinite(channel.samples))
        notes.append(
            Note(
                "warning",
                f"{len(missing)} value(s) of {channel.label} are no number, "
                f"kept as NaN; the first at t = {time[missing[0]]:.6g} s",
                place(int(missing[0])),
            )
        )
        kept.append(replace(channel, samples=np.where(np.isfinite(channel.samples), channel.samples, np.nan)))
    if not kept:
        raise source.error("has no channel with numbers", "Export it again.", part)
    return _recording(source, reader, table, part, time, kept, notes)


def _own_rate(time: np.ndarray, samples: np.ndarray, filled: np.ndarray) -> Series | None:
    """A column that is filled at even distances and blank between."""
    if len(filled) < 3 or len(filled) >= _BLANK * len(samples):
        return None
    steps = np.diff(time[filled])
    even = float(np.mean(np.abs(steps - np.median(steps)) <= 0.25 * np.median(steps)))
    return Series(time[filled], samples[filled]) if even >= _BLANK else None


def _of_several_clocks(
    source: Source,
    reader: str,
    table: Table,
    groups: list[tuple[time_axis.TimeAxis, np.ndarray | None, list[Channel]]],
) -> Recording:
    """A recording whose columns have clocks of their own."""
    channels: list[Channel] = []
    for axis, _, members in groups:
        if len(axis.time) < 2:
            raise source.error(f"{members[0].label} has {len(axis.time)} sample(s)", "Two are needed.", table.part)
        end = axis.restarts[0] if axis.restarts else len(axis.time)
        if axis.restarts:
            table.warn(f"the clock of {members[0].label} begins again; what is before that is read")
        channels += [
            replace(c, samples=c.samples[:end], logged=Series(axis.time[:end], c.samples[:end])) for c in members
        ]
    longest = max(groups, key=lambda g: len(g[0].time))[0]
    return _recording(source, reader, table, table.part, longest.time, channels, list(table.notes))


def _recording(
    source: Source, reader: str, table: Table, part: str, time: np.ndarray, channels: list[Channel], notes: list[Note]
) -> Recording:
    """Put channels on the clock of the one with most samples, where they have clocks of their own."""
    whole = tuple(replace(c, samples=np.ascontiguousarray(c.samples)) for c in channels)
    if any(c.logged is not None for c in whole):
        logged = {c.name: c.logged or Series(time, c.samples) for c in whole}
        base = max(logged, key=lambda name: len(logged[name].time))
        blank = tuple(replace(c, samples=np.zeros(len(time)), logged=logged[c.name]) for c in whole)
        recording = Recording(time, blank, source.provenance(reader, part)).on_clock_of(base)
        notes = [*notes, _own_clocks(logged, base, recording)]
        whole = recording.channels
        time = recording.time
    looked = tuple(c if c.logged is None else replace(c, samples=c.logged.samples) for c in whole)
    return Recording(
        np.ascontiguousarray(time),
        whole,
        source.provenance(reader, part),
        (*source.notes, *notes, *warnings_of(looked)),
        dict(table.header),
    )


def _own_clocks(logged: dict[str, Series], base: str, recording: Recording) -> Note:
    """How channels with clocks of their own are compared."""
    rates = ", ".join(f"{name} at {s.rate:.6g} Hz from {s.time[0]:.6g} s" for name, s in logged.items())
    begins = [float(s.time[0]) for s in logged.values()]
    apart = f"; they begin {max(begins) - min(begins):.6g} s apart" if max(begins) > min(begins) else ""
    return Note(
        "info",
        f"channels have clocks of their own: {rates}{apart}. Aligned by their start times; what all cover is "
        f"{recording.time[0]:.6g} to {recording.time[-1]:.6g} s, compared at the times of {base}, between the "
        "samples of the others by interpolation",
    )
