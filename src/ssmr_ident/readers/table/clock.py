"""Which column is the time, and which time is whose: one clock, one of several, a clock per channel, a rate."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from ssmr_ident.core.errors import InputError
from ssmr_ident.readers.options import ReadOptions
from ssmr_ident.readers.source import Source
from ssmr_ident.readers.table.columns import Column, Table
from ssmr_ident.readers.table.stamp_parts import in_one_column
from ssmr_ident.readers.table.stamp_units import Clock, ask_for_whole_numbers, clock_of
from ssmr_ident.readers.table.vocabulary import words_of

_FALLS = 0.1
"""Choice: share of a column's steps that go back from which on it is no clock, whatever it is called."""


@dataclass
class Clocked:
    """Columns with the stamps that they share.

    Parameters
    ----------
    stamps : (n,) float [s]
        NaN where there is none.
    columns : list of Column
    rows : (n,) int or None
        Rows of the table that are meant; None for all.
    exact : bool
        True when the stamps are a start and steps, so that nothing about them needs a look.
    label : str
        Of the clock's column.
    """

    stamps: np.ndarray
    columns: list[Column]
    rows: np.ndarray | None = None
    exact: bool = False
    label: str = ""


def clocked(source: Source, columns: list[Column], options: ReadOptions, table: Table) -> list[Clocked]:
    """The columns with their stamps.

    Raises
    ------
    InputError
        No time and no rate, or stamps that nobody can read.
    """
    columns = in_one_column(columns, table)
    times = _ticking([c for c in columns if c.quantity in ("time", "date")])
    if table.rate or len(times) > 1:
        times = [c for c in times if c.given or np.isfinite(c.values).any()]
    data = [c for c in columns if c.quantity not in ("time", "date")]
    if not times and options.fs is None and not any(c.step for c in columns):
        times = [c for c in columns if not c.given and c.unit and _is_time_unit(source, c.unit)][:1]
        data = [c for c in columns if not any(c is t for t in times)]
    if not data:
        raise source.error("has a time column and no other", "Export the measured channels too.", table.part)
    if any(c.rows is not None for c in data):
        return _by_sensor(source, times, data, options, table)
    if options.fs is not None:
        used = f"; column {times[0].shown} not used" if times else ""
        table.inform(f"time from --fs {options.fs:g} Hz{used}")
        return [Clocked(np.arange(len(data[0].values)) / options.fs, data, exact=True)]
    own = [c for c in data if c.step]
    if own and not times:
        if len(own) < len(data):
            lost = ", ".join(c.shown for c in data if not c.step)
            raise source.error(f"states no rate for {lost}", "Give --fs.", table.part)
        return _own(data)
    if not times:
        return [_without_time(source, data, options, table)]
    if own:
        data = [c for c in data if not c.step]
        if not data:
            return _own(own)
        columns = [c for c in columns if not c.step]
    clocks = _clocks(source, _distinct(times, table), columns, options, table)
    if len(clocks) > 1:
        owners = _owners(columns, clocks)
        if owners is not None:
            return _per_channel(source, clocks, owners, table) + (_own(own) if own else [])
    best = clocks[0] if len(clocks) == 1 else _evenest(clocks, table)
    for note in best.notes:
        table.inform(note)
    for column in own:
        column.start -= best.begin
    return [Clocked(best.seconds, data, label=best.label), *(_own(own) if own else [])]


def _ticking(times: list[Column]) -> list[Column]:
    """Columns that are called a time; of several, what falls or stands still is none: an X_Value beside Y_Value."""
    if len(times) < 2:
        return times
    steps = [np.diff(c.values[np.isfinite(c.values)]) for c in times]
    falls = [
        c for c, step in zip(times, steps, strict=True)
        if not c.given and ((step < 0).sum() > _FALLS * len(step) or (len(step) > 1 and not step.any() and not c.clock))
    ]  # fmt: skip
    if len(falls) == len(times):
        return times
    for column in falls:
        column.quantity = None
    return [c for c in times if not any(c is one for one in falls)]


def _clocks(
    source: Source, times: list[Column], columns: list[Column], options: ReadOptions, table: Table
) -> list[Clock]:
    """The clocks of a table; one whose unit nobody knows is left out where others stand beside it, before all data."""
    clocks: list[Clock] = []
    unclear: list[tuple[Column, InputError]] = []
    for column in times:
        try:
            clocks.append(clock_of(source, column, options, table))
        except InputError as error:
            unclear.append((column, error))
    together = [c.quantity in ("time", "date") for c in columns]
    if unclear and (not clocks or together != sorted(together, reverse=True)):
        raise unclear[0][1]
    for column, why in unclear:
        table.inform(f"clock {column.shown} left out: {why.problem}")
    return clocks


def _by_sensor(
    source: Source, times: list[Column], data: list[Column], options: ReadOptions, table: Table
) -> list[Clocked]:
    """Columns of a table in long form at the stamps of their own rows; sensors that tick together share a clock."""
    groups: dict[bytes, list[Column]] = {}
    for column in data:
        assert column.rows is not None
        groups.setdefault(column.rows.tobytes(), []).append(column)
    found: list[tuple[Clock, list[Column]]] = []
    for members in groups.values():
        rows = members[0].rows
        known = len(table.notes)
        mine = [replace(c, values=c.values[rows]) for c in times]
        if options.fs is not None:
            seconds = np.arange(len(mine[0].values)) / options.fs
            clock = Clock("--fs", seconds, 0.0, [f"time from --fs {options.fs:g} Hz for every sensor"], mine[0])
        else:
            clocks = _clocks(source, _distinct(mine, table), mine, options, table)
            clock = clocks[0] if len(clocks) == 1 else _evenest(clocks, table)
        if found:
            del table.notes[known:]  # said of the first sensor
        else:
            for note in clock.notes:
                table.inform(note)
        found.append((clock, members))
    earliest = min(clock.begin for clock, _ in found)
    made: list[Clocked] = []
    for clock, members in found:
        stamps = clock.seconds + (clock.begin - earliest)
        same = next((c for c in made if np.array_equal(c.stamps, stamps, equal_nan=True)), None)
        if same is None:
            made.append(Clocked(stamps, members, members[0].rows, label=clock.label))
            continue
        assert same.rows is not None
        for column in members:
            here = np.full(len(column.values), np.nan)
            here[same.rows] = column.values[column.rows]
            column.values = here
        same.columns += members
    return made


def _is_time_unit(source: Source, unit: str) -> bool:
    conversion = source.vocabulary.unit(unit)
    return conversion is not None and conversion.unit == "s"


def _own(data: list[Column]) -> list[Clocked]:
    """Columns by their own start, step and length."""
    groups: dict[tuple[float, float, int], list[Column]] = {}
    for column in data:
        groups.setdefault((column.start, column.step, len(column.values)), []).append(column)
    return [
        Clocked(start + step * np.arange(count), members, exact=True)
        for (start, step, count), members in groups.items()
    ]


def _without_time(source: Source, data: list[Column], options: ReadOptions, table: Table) -> Clocked:
    if table.rate:
        table.inform(f"time from {table.rate_from!r}: {table.rate:.6g} Hz")
        return Clocked(np.arange(len(data[0].values)) / table.rate, data, exact=True)
    first = data[0].values
    if len(data) > 1 and data[0].quantity is None and not data[0].label and len(first) > 2 and _rises_evenly(first):
        ask_for_whole_numbers(source, data[0], first, table)
        source.warn("no header: the first column rises evenly and was taken as time in s")
        return Clocked(first, data[1:])
    labels = ", ".join(f"{c.number}={c.label or 'no header'}" for c in data)
    raise source.error(
        f"time column missing, and no sampling rate; columns: {labels}",
        "Give --fs 1000 for samples at a known rate, or --columns time=0.",
        table.part,
    )


def _rises_evenly(values: np.ndarray) -> bool:
    if not np.isfinite(values).all() or np.abs(values).max() > 1e15:
        return False
    steps = np.diff(values)
    return bool((steps > 0).all() and np.ptp(steps) <= 0.02 * np.median(steps) + 1e-6)


def _distinct(times: list[Column], table: Table) -> list[Column]:
    """Time columns that differ."""
    kept: list[Column] = []
    for column in times:
        if not any(np.array_equal(column.values, one.values, equal_nan=True) for one in kept):
            kept.append(column)
    if len(kept) < len(times) and len(kept) == 1:
        table.inform(f"{len(times)} equal time columns; the first is used")
    return kept


def _owners(columns: list[Column], clocks: list[Clock]) -> dict[int, Clock] | None:
    """Clock of each data column: the nearest one to its left, where every clock has columns of its own.

    Two clocks that tick together at every row are two views of one instant, unless each is named after what stands
    behind it.
    """
    owner: dict[int, Clock] = {}
    current: Clock | None = None
    for column in columns:
        clock = next((c for c in clocks if c.column is column), None)
        if clock is not None:
            current = clock
        elif column.quantity in ("time", "date"):
            continue
        elif current is None:
            return None
        else:
            owner[id(column)] = current
    if any(not any(one is clock for one in owner.values()) for clock in clocks):
        return None
    paired = all(_paired(clock, [c for c in columns if owner.get(id(c)) is clock]) for clock in clocks)
    return owner if paired or any(_holds(clock.seconds) for clock in clocks) else None


def _holds(stamps: np.ndarray) -> bool:
    """True for a clock that stands still in a fifth of the rows while others go on."""
    finite = stamps[np.isfinite(stamps)]
    return len(finite) < 0.8 * len(stamps) or int(np.sum(np.diff(finite) == 0)) > 0.2 * (len(finite) - 1)


def _paired(clock: Clock, columns: list[Column]) -> bool:
    label = clock.column.label.lower()
    if label.startswith(("time[", "x_value")) or " - " in label:
        return True
    stem = set(words_of(clock.column.label)) - {"time", "timestamp", "stamp", "t", "ms", "us", "s"}
    return bool(stem) and all(stem & set(words_of(c.label)) for c in columns)


def _per_channel(source: Source, clocks: list[Clock], owners: dict[int, Clock], table: Table) -> list[Clocked]:
    units = {clock.column.unit for clock in clocks}
    if len(units) > 1 and None in units:
        raise source.error(
            f"has clocks in different units: {', '.join(sorted(str(unit) for unit in units))}",
            "Choose one with --columns time=0,…, or give every unit with --units.",
            table.part,
        )
    earliest = min(c.begin + float(c.seconds[np.isfinite(c.seconds)][0]) for c in clocks)
    result = []
    for clock in clocks:
        for note in clock.notes:
            table.inform(note)
        stamps = clock.seconds + (clock.begin - earliest)
        fresh = np.isfinite(stamps) & np.r_[True, np.diff(stamps) != 0]
        rows = np.flatnonzero(fresh)
        if len(rows) < 2 or (np.diff(stamps[rows]) < 0).any():
            raise source.error(f"clock {clock.label} runs backwards", "Keep one recording per file.", table.part)
        members = [c for c in table.columns if owners.get(id(c)) is clock]
        if len(rows) < len(stamps):
            table.warn(f"clock {clock.label} ticks in {len(rows)} of {len(stamps)} rows; rows that repeat it dropped")
        result.append(Clocked(stamps[rows], members, rows, label=clock.label))
    return result


def _evenest(clocks: list[Clock], table: Table) -> Clock:
    """Of several clocks of the same rows the one with the most even steps, the first of equals."""

    def unevenness(clock: Clock) -> float:
        steps = np.diff(clock.seconds[np.isfinite(clock.seconds)])
        typical = float(np.median(steps)) if len(steps) else 0.0
        if typical <= 0:
            return float("inf")
        return round(float(np.mean(np.abs(steps - typical))) / typical, 3) + float(np.mean(steps == 0))

    best = min(clocks, key=unevenness)
    others = ", ".join(c.label for c in clocks if c is not best)
    table.inform(f"several clocks: {best.label} has the most even steps and is the time; {others} left out")
    return best
