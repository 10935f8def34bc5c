"""Stamps that stand in several columns: seconds and nanoseconds, date and time, hour, minute and second."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from ssmr_ident.readers.table.columns import Column, Table
from ssmr_ident.readers.table.stamp_units import DAY, date_of
from ssmr_ident.readers.table.vocabulary import words_of

_SECOND = {"sec", "secs", "s", "second", "seconds"}
_BELOW = {
    **dict.fromkeys(("nanosec", "nanosecs", "nsec", "nsecs", "ns", "nanoseconds", "nanosecond", "nanos"), 1e-9),
    **dict.fromkeys(("usec", "usecs", "us", "microsec", "microseconds", "micros"), 1e-6),
    **dict.fromkeys(("msec", "msecs", "ms", "millis", "millisec", "milliseconds"), 1e-3),
}


def in_one_column(columns: list[Column], table: Table) -> list[Column]:
    """Stamps of several columns put together: seconds and a part of one, date and time of day, hour, minute, second."""
    columns = _of_calendar_parts(columns, table)
    made = list(columns)
    for seconds in columns:
        words = _with_unit(seconds)
        if seconds.given or not words or words[-1] not in _SECOND:
            continue
        for below in columns:
            parts = _with_unit(below)
            if not parts or below is seconds or parts[-1] not in _BELOW or parts[:-1] != words[:-1]:
                continue
            factor = _BELOW[parts[-1]]
            if not _whole(seconds.values) or not _whole(below.values) or np.nanmax(below.values) * factor >= 1.0:
                continue
            label = " ".join(words[:-1]) or "stamp"
            first = float(np.nanmin(seconds.values))
            together = (seconds.values - first) + below.values * factor
            table.inform(f"time: {seconds.shown} + {factor:g} × {below.shown}, from {date_of(first)} on")
            stamp = Column(label, "s", together, quantity="time", number=seconds.number)
            made = [stamp if c is seconds else c for c in made if c is not below]
    made = _with_fractions(made, table)
    dates = [c for c in made if c.clock and _is_date(c)]
    clocks = [c for c in made if c.clock and not _is_date(c) and _within_a_day(c)]
    if dates and clocks and not dates[0].given:
        day, clock = dates[0], clocks[0]
        stamp = Column(f"{day.label} {clock.label}", None, day.values + clock.values, True, "time", number=clock.number)
        made = [stamp if c is clock else c for c in made if c is not day]
    return made


_PARTS = {"hour": 3600.0, "minute": 60.0, "second": 1.0, "millisecond": 1e-3, "microsecond": 1e-6}
_PART_WORDS = {
    **dict.fromkeys(("hour", "hours", "hh", "h", "hr", "stunde", "heure", "hora"), "hour"),
    **dict.fromkeys(("minute", "minutes", "min", "mm", "minuto"), "minute"),
    **dict.fromkeys(("second", "seconds", "sec", "ss", "s", "sekunde", "seconde", "segundo"), "second"),
    **dict.fromkeys(("millisecond", "milliseconds", "ms", "msec", "millis", "millisekunde"), "millisecond"),
    **dict.fromkeys(("microsecond", "microseconds", "us", "usec", "micros", "mikrosekunde"), "microsecond"),
}
_CALENDAR = {"year", "yyyy", "yr", "month", "mon", "day", "dd", "doy", "jahr", "monat", "tag", "année", "mois", "jour"}


def _of_calendar_parts(columns: list[Column], table: Table) -> list[Column]:
    """One time of columns for hour, minute and second; year, month and day beside them are left out."""
    parts: dict[str, Column] = {}
    for column in columns:
        words = words_of(column.label) or words_of(column.unit or "")
        part = _PART_WORDS.get(words[0]) if len(words) == 1 else None
        if part and part not in parts and not column.given and not column.clock:
            parts[part] = column
    if not {"minute", "second"} <= parts.keys() or not _whole(parts["minute"].values):
        return columns
    if np.any(parts["minute"].values > 59) or np.any(parts["second"].values > 61):
        return columns
    turns = np.diff(parts["second"].values) < 0
    if not np.array_equal(np.diff(parts["minute"].values) != 0, turns):
        return columns  # a minimum beside seconds
    seconds = np.sum([_PARTS[name] * column.values for name, column in parts.items()], axis=0)
    calendar = [c for c in columns if words_of(c.label) and words_of(c.label)[0] in _CALENDAR and _whole(c.values)]
    gone = [*parts.values(), *calendar]
    table.inform(f"time: put together of the columns {', '.join(c.shown for c in gone)}")
    first = min(gone, key=lambda c: c.number)
    over = 86400.0 if "hour" in parts else 3600.0
    days = np.cumsum(np.r_[0, np.diff(seconds) < -over / 2]) * over  # midnight, or the full hour where none is told
    stamp = Column("time", "s", seconds + days, quantity="time", number=first.number)
    return [stamp if c is first else c for c in columns if c is first or not any(c is one for one in gone)]


def _with_fractions(columns: list[Column], table: Table) -> list[Column]:
    """Clock times in whole seconds with the milli- or microseconds that stand in a column of their own."""
    made = list(columns)
    for clock in columns:
        if not clock.clock or _is_date(clock) or not (np.nan_to_num(clock.values) % 1 == 0).all():
            continue
        for below in columns:
            words = _with_unit(below)
            factor = _BELOW.get(words[-1]) if words else None
            if factor is None or below.clock or below.given or not _whole(below.values):
                continue
            if np.nanmax(below.values) * factor >= 1.0 or not (np.diff(below.values) < 0).any():
                continue
            table.inform(f"time: {clock.shown} + {factor:g} × {below.shown}")
            whole = replace(clock, values=clock.values + below.values * factor)
            return [whole if c is clock else c for c in made if c is not below]
    return made


def _with_unit(column: Column) -> tuple[str, ...]:
    """Words of a header with its unit: ``stamp/secs`` and ``stamp.sec`` alike."""
    words = words_of(column.label)
    return (*words, column.unit.lower()) if column.unit and column.unit.lower() not in words[-1:] else words


def _is_date(column: Column) -> bool:
    finite = column.values[np.isfinite(column.values)]
    return len(finite) > 0 and bool((finite % DAY == 0).all()) and float(finite.max()) > DAY


def _within_a_day(column: Column) -> bool:
    finite = column.values[np.isfinite(column.values)]
    return len(finite) > 0 and float(finite.max()) <= DAY + 1


def _whole(values: np.ndarray) -> bool:
    return bool(np.isfinite(values).all() and (values == np.round(values)).all() and values.min(initial=0) >= 0)
