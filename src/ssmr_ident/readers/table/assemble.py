"""From columns of a table to a Recording: which one is time, units to SI, names, checks. Shared by all formats."""

from __future__ import annotations

import itertools
from collections.abc import Callable, Sequence

import numpy as np

from ssmr_ident.core.errors import did_you_mean
from ssmr_ident.core.recording import Channel, Note, Recording
from ssmr_ident.core.units import find_unit
from ssmr_ident.readers.health import warnings_of
from ssmr_ident.readers.options import ReadOptions
from ssmr_ident.readers.source import Source
from ssmr_ident.readers.table import time_axis
from ssmr_ident.readers.table.channels import apply_units, channels_of
from ssmr_ident.readers.table.columns import Column, Table, all_finite
from ssmr_ident.readers.table.headings import quantity_of


def recordings_of(source: Source, reader: str, table: Table, options: ReadOptions) -> list[Recording]:
    """The recordings that a table holds; several when time begins again.

    Raises
    ------
    InputError
        Time or a unit is missing, or time cannot be used.
    """
    columns = _chosen(source, table, options)
    if not table.units_given:
        apply_units(source, columns, options)
    time_column = _time_column(source, columns, options, table)
    data = [column for column in columns if column is not time_column]
    if not data:
        raise source.error("has a time column and no other", "Export the measured channels too.", table.part)
    notes = list(table.notes)
    count = len(data[0].values)
    if time_column is None or options.fs is not None:
        assert options.fs is not None
        stamps = np.arange(count) / options.fs
        notes.append(
            Note(
                "info",
                f"time from --fs {options.fs:g} Hz"
                + ("" if time_column is None else f"; column {time_column.label!r} not used"),
            )
        )
    else:
        stamps = _seconds(source, time_column, options, table, notes)
    rows: np.ndarray | None = None  # None: all; a copy of a million rows costs more than reading them
    if not all_finite(stamps):
        kept = np.isfinite(stamps)
        row = int(np.flatnonzero(~kept)[0])
        if options.on_bad != "nan":
            raise source.error("time is missing", "Drop the row with --on-bad nan, or mend it.", table.place(row))
        notes.append(Note("warning", f"{int((~kept).sum())} row(s) without time dropped", table.place(row)))
        rows = np.flatnonzero(kept)
        stamps = stamps[rows]
    try:
        axis = time_axis.check(stamps, _place(table, rows, 0), split=table.split)
    except time_axis.TimeProblem as error:
        raise source.error(error.problem, error.mend, _place(table, rows, 0)(error.row)) from error
    notes += axis.notes
    if axis.rows is not None:
        rows = axis.rows if rows is None else rows[axis.rows]
    channels = channels_of(source, data, rows, table, notes)
    edges = [0, *axis.restarts, len(axis.time)]
    return [
        _recording(
            source,
            reader,
            table,
            axis.time[a:b],
            _place(table, rows, a),
            [c.samples[a:b] for c in channels],
            channels,
            notes,
            (number, len(edges) - 1),
        )
        for number, (a, b) in enumerate(itertools.pairwise(edges), start=1)
    ]


def _place(table: Table, rows: np.ndarray | None, begin: int) -> Callable[[int], str]:
    """Names a kept row of the table, counted from ``begin``."""
    return lambda row: table.place(begin + row if rows is None else int(rows[begin + row]))


def _recording(
    source: Source,
    reader: str,
    table: Table,
    time: np.ndarray,
    place: Callable[[int], str],
    samples: Sequence[np.ndarray],
    channels: Sequence[Channel],
    notes: list[Note],
    of: tuple[int, int],
) -> Recording:
    if len(time) < 2:
        raise source.error(
            f"has {len(time)} row(s) of data",
            "A recording needs two samples at least.",
            place(0) if len(time) else table.part,
        )
    part = table.part
    if of[1] > 1:
        part = f"{part}, sample {of[0]} of {of[1]}".lstrip(", ")
    mine = notes + time_axis.gaps(time, place)
    for channel, values in zip(channels, samples, strict=True):
        if not all_finite(values):
            missing = np.flatnonzero(~np.isfinite(values))
            mine.append(
                Note(
                    "warning",
                    f"{len(missing)} value(s) of {channel.label or channel.name} are no number, "
                    f"kept as NaN; the first at t = {time[missing[0]]:.6g} s",
                    place(int(missing[0])),
                )
            )
            if len(missing) == len(values):
                raise source.error(
                    f"column {channel.label or channel.name} has no numbers",
                    "Export it again, or leave it out with --columns.",
                    part,
                )
    whole = tuple(
        Channel(c.name, np.ascontiguousarray(v), c.unit, c.label) for c, v in zip(channels, samples, strict=True)
    )
    return Recording(
        np.ascontiguousarray(time),
        whole,
        source.provenance(reader, part),
        (*source.notes, *mine, *warnings_of(whole)),
        dict(table.header),
    )


def _chosen(source: Source, table: Table, options: ReadOptions) -> list[Column]:
    """The columns that the user mapped, or all of them."""
    if not options.columns:
        return table.columns
    labels = [column.label for column in table.columns]
    chosen = []
    for quantity, which in options.columns.items():
        index = _index(source, labels, which, quantity)
        column = table.columns[index]
        chosen.append(Column(column.label, column.unit, column.values, column.clock, quantity))
    left = [
        label
        for label, column in zip(labels, table.columns, strict=True)
        if not any(column.values is one.values for one in chosen)
    ]
    if left:
        table.notes.append(Note("info", f"columns not read, as --columns says: {', '.join(left)}"))
    return chosen


def _index(source: Source, labels: list[str], which: int | str, quantity: str) -> int:
    if isinstance(which, str) and not which.lstrip("-").isdigit():
        folded = [label.lower() for label in labels]
        if which.lower() in folded:
            return folded.index(which.lower())
        raise source.error(f"has no column {which!r} for {quantity}", did_you_mean(which, labels))
    number = int(which)
    if not 0 <= number < len(labels):
        raise source.error(
            f"has {len(labels)} columns, numbered from 0; column {number} for {quantity} is not there",
            f"They are: {', '.join(f'{i}={label}' for i, label in enumerate(labels))}.",
        )
    return number


def _time_column(source: Source, columns: list[Column], options: ReadOptions, table: Table) -> Column | None:
    mapped = [column for column in columns if column.quantity == "time"]
    named = mapped or [c for c in columns if c.quantity is None and quantity_of(c.label, c.unit) == "time"]
    if not named:
        named = [c for c in columns if c.quantity is None and c.unit and (u := find_unit(c.unit)) and u.unit == "s"]
    if named:
        return named[0]
    if options.fs is not None:
        return None
    first = columns[0].values
    if len(columns) > 1 and columns[0].quantity is None and not columns[0].label and len(first) > 2:
        steps = np.diff(first)
        if (steps > 0).all() and np.ptp(steps) <= 0.02 * np.median(steps) + 1e-6:
            table.notes.append(Note("warning", "no header: the first column rises evenly and was taken as time in s"))
            return columns[0]
    labels = ", ".join(f"{i}={c.label or 'no header'}" for i, c in enumerate(columns))
    raise source.error(
        f"time column missing; columns: {labels}",
        "Give --fs 1000 for samples at a known rate, or --columns time=0.",
        table.part,
    )


def _seconds(source: Source, column: Column, options: ReadOptions, table: Table, notes: list[Note]) -> np.ndarray:
    values = column.values
    if not np.isfinite(values).any():
        raise source.error(f"time column {column.label!r} has no numbers", "Give --fs.", table.part)
    unit = options.time_unit or (None if column.clock else column.unit)
    if unit is None and not column.clock:
        finite = values[np.isfinite(values)]
        step = float(np.median(np.diff(finite))) if len(finite) > 1 else 0.0
        whole = len(finite) > 2 and bool((finite == np.round(finite)).all())
        if whole and step >= 1 and np.nanmin(values) < time_axis.SECONDS_1904:
            raise source.error(
                f"unit of time column {column.label!r} unknown: whole numbers in steps of {step:g}",
                "Give --time-unit s, ms or us, or --fs for a sample count.",
                table.part,
            )
        notes.append(Note("info", f"time column {column.label or '(no header)'} states no unit; taken as s"))
        unit = "s"
    if unit is not None:
        conversion = find_unit(unit)
        if conversion is None or conversion.unit != "s":
            raise source.error(
                f"unit {unit!r} of time column {column.label!r} is no time",
                "Give --time-unit s, ms or us.",
                table.part,
            )
        if conversion.changes:
            notes.append(Note("info", f"{column.label or 'time'}: {unit} × {conversion.factor:g} = s"))
            values = values * conversion.factor
    values, more = time_axis.elapsed(values, clock=column.clock)
    notes += more
    return values
