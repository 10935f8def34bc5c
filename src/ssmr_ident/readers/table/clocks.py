"""Several clocks in one table (a time column per channel) onto one."""

from __future__ import annotations

import numpy as np

from ssmr_ident.core.recording import Note
from ssmr_ident.core.units import find_unit
from ssmr_ident.readers.options import ReadOptions
from ssmr_ident.readers.source import Source
from ssmr_ident.readers.table.channels import apply_units
from ssmr_ident.readers.table.columns import Column, Table
from ssmr_ident.readers.table.headings import quantity_of


def onto_one_clock(source: Source, table: Table, options: ReadOptions) -> None:
    """Replace time columns of their own per channel by one.

    Equal clocks: the first stays. Different ones: every channel is reduced to the rows in which its clock ticked,
    the slowest clock becomes the time of all, and the channels of the others are interpolated linearly onto it.
    Both are noted, with how far the interpolated channel moves between two of its samples.
    """
    if options.columns:
        return
    times = [i for i, c in enumerate(table.columns) if _is_time(c)]
    if len(times) < 2:
        return
    apply_units(source, table.columns, options)  # now, because columns that the user named may go
    table.units_given = True
    clocks = {i: table.columns[i].values for i in times}
    first = times[0]
    if all(np.array_equal(clocks[i], clocks[first], equal_nan=True) for i in times[1:]):
        table.columns = [c for i, c in enumerate(table.columns) if i == first or i not in times]
        table.notes.append(Note("info", f"{len(times)} equal time columns; the first is used"))
        _plain_time_label(table.columns[0])
        return
    owner = _owners(table.columns, times)
    if options.fs is not None or owner is None:
        raise source.error(
            f"has {len(times)} time columns that differ", "Choose one with --columns time=0,…", table.part
        )
    _merge(source, table, times, owner)


def _is_time(column: Column) -> bool:
    return (column.quantity or quantity_of(column.label, column.unit)) == "time" or column.label.startswith("time[")


def _plain_time_label(column: Column) -> None:
    if quantity_of(column.label, column.unit) != "time":
        column.quantity = "time"


def _owners(columns: list[Column], times: list[int]) -> dict[int, int] | None:
    """Time column of each data column: the nearest one to its left; None when a data column has none."""
    owner = {}
    current = None
    for index in range(len(columns)):
        if index in times:
            current = index
        elif current is None:
            return None
        else:
            owner[index] = current
    return owner


def _merge(source: Source, table: Table, times: list[int], owner: dict[int, int]) -> None:
    units = {table.columns[index].unit for index in times}
    if len(units) > 1:
        raise source.error(
            f"has clocks in different units: {', '.join(sorted(str(unit) for unit in units))}",
            "Choose one with --columns time=0,…",
            table.part,
        )
    ticked: dict[int, np.ndarray] = {}
    for index in times:
        stamps = table.columns[index].values
        finite = np.isfinite(stamps)
        fresh = finite & np.r_[True, np.diff(stamps) != 0]
        ticked[index] = np.flatnonzero(fresh)
        chosen = stamps[ticked[index]]
        if len(chosen) < 2 or (np.diff(chosen) < 0).any():
            raise source.error(
                f"clock {table.columns[index].label!r} runs backwards", "Keep one recording per file.", table.part
            )
    slowest = min(times, key=lambda index: (len(ticked[index]), index))
    rows = ticked[slowest]
    origin = min(float(table.columns[i].values[ticked[i][0]]) for i in times)
    time = table.columns[slowest].values[rows]
    begin = max(float(table.columns[i].values[ticked[i][0]]) for i in times)
    finish = min(float(table.columns[i].values[ticked[i][-1]]) for i in times)
    inside = (time >= begin) & (time <= finish)
    merged = [Column(table.columns[slowest].label, table.columns[slowest].unit, time[inside] - origin, quantity="time")]
    for index, clock in owner.items():
        column = table.columns[index]
        if clock == slowest:
            values = column.values[rows][inside]
        else:
            own_rows = ticked[clock]
            own_time, own = table.columns[clock].values[own_rows], column.values[own_rows]
            values = np.interp(time[inside], own_time, own)
            step = float(np.abs(np.diff(own)).max()) if len(own) > 1 else 0.0
            table.notes.append(
                Note(
                    "warning",
                    f"{column.label} has a clock of its own ({table.columns[clock].label}); "
                    f"interpolated onto {table.columns[slowest].label} (it moves {step:.3g} "
                    f"{column.unit or 'units'} between two of its samples at most)",
                    table.part,
                )
            )
        merged.append(Column(column.label, column.unit, values))
    repeated = len(table.columns[slowest].values) - len(rows)
    table.notes.append(
        Note(
            "warning",
            f"{len(times)} clocks: {table.columns[slowest].label} is the slowest with "
            f"{len(rows)} ticks; {repeated} rows that repeat its value dropped",
            table.part,
        )
    )
    kept = rows[inside]
    place = table.place
    table.columns = merged
    table.place = lambda row: place(int(kept[row]))
    if find_unit(merged[0].unit or "") is None:
        merged[0].unit = None
