"""From a column of stamps in any unit to seconds: units stated, or told by size and step."""

from __future__ import annotations

import re
from dataclasses import dataclass
from datetime import UTC, datetime

import numpy as np

from ssmr_ident.readers.options import ReadOptions
from ssmr_ident.readers.source import Source
from ssmr_ident.readers.table.columns import Column, Table, all_finite

DAY = 86400.0
SECONDS_1904 = 2.0e9  # a LabVIEW stamp after 1967, counted from 1904; a count from 1970 comes there in 2033
EPOCH = (5.0e8, SECONDS_1904)  # seconds since 1970 from November 1985 on
LONGEST_STEP = 3600.0  # s; a log of this trade has more than a sample an hour
FASTEST = 1e5  # Hz; no logger of this trade samples faster
LARGEST = 1e20  # of a stamp as printed; nanoseconds since 1970 are 2e18, and what is larger is damage
_SCALES = (("s", 1.0), ("ms", 1e-3), ("us", 1e-6), ("ns", 1e-9))
_DAYS = {"spreadsheets count from 1900": (36526.0, 73051.0), "MATLAB counts from year 0": (730486.0, 767011.0),
         "days since 1970": (10957.0, 25568.0), "a Julian date": (2451545.0, 2488070.0)}  # fmt: skip
"""Days of this century's first hundred years by who counts them, as the note says."""
_WRAPS = (2.0**16, 2.0**32)  # counts of microcontrollers that begin again


@dataclass
class Clock:
    """Stamps in seconds.

    Parameters
    ----------
    label : str
        Of the column.
    seconds : (n,) float [s]
        NaN where there is none.
    begin : float [s]
        What was subtracted: the date or the count at which the log begins; 0 for stamps that stay as they are.
    notes : list of str
        What was done, for the user.
    column : Column
        Where it is from.
    """

    label: str
    seconds: np.ndarray
    begin: float
    notes: list[str]
    column: Column


def clock_of(source: Source, column: Column, options: ReadOptions, table: Table) -> Clock:
    """Seconds of a column of stamps.

    Raises
    ------
    InputError
        No numbers in it, a unit that is no time, or whole numbers of which nothing says what they count.
    """
    values = column.values
    if not (len(values) and values.min() > -LARGEST and values.max() < LARGEST):  # a copy only where one is needed
        values = np.where(np.abs(values) < LARGEST, values, np.nan)
    finite = values if all_finite(values) else values[np.isfinite(values)]
    if not len(finite):
        raise source.error(f"time column {column.shown} has no numbers", "Give --fs.", table.part)
    notes: list[str] = []
    if column.clock and options.time_unit is None:
        return _time_of_day(column, values, notes)
    values = _unwrapped(values, notes)
    unit = options.time_unit or (column.unit and re.split(r"\ssince\s", column.unit)[0])  # CF: seconds since 2024-03-01
    if unit is None:
        days = _days(finite)
        if days:
            whole = (values - np.floor(finite[0])) * DAY
            notes.append(f"{column.shown}: days ({days}), as its size and its step say; × {DAY:g} = s")
            since = (finite[0] - np.floor(finite[0])) * DAY
            return Clock(column.shown, whole - since, float(np.floor(finite[0])) * DAY + since, notes, column)
        unit = _told_by_size(finite, notes, column.shown)
        if unit is None:
            ask_for_whole_numbers(source, column, finite, table)
            step = float(np.median(np.diff(finite))) if len(finite) > 1 else 1.0
            if 0 < step < 1 / (10 * FASTEST):
                raise source.error(
                    f"unit of time column {column.shown} unknown: in s its steps of {step:.4g} would be "
                    f"{1 / step:.4g} Hz",
                    "Give --time-unit s, min, h or ms, or --fs.",
                    table.part,
                )
            notes.append(f"time column {column.shown} states no unit; taken as s")
            unit = "s"
    conversion = source.vocabulary.unit(unit)
    if conversion is None or conversion.unit != "s":
        raise source.error(
            f"unit {unit!r} of time column {column.shown} is no time", "Give --time-unit s, ms or us.", table.part
        )
    if conversion.changes and not any("since 1970" in note for note in notes):
        notes.append(f"{column.shown}: {unit} × {conversion.factor:g} = s")
    return _from_zero(column, values, float(finite[0]), conversion.factor, notes)


def _unwrapped(values: np.ndarray, notes: list[str]) -> np.ndarray:
    """Counts that run over the end of their bits, carried on: millis() and micros() of microcontrollers."""
    if len(values) < 4 or not bool((values[1:] < values[:-1]).any()):
        return values
    steps = np.diff(values)
    falls = np.flatnonzero(steps < 0)
    if not len(falls) or len(falls) > 1000 or not all_finite(values):
        return values
    typical = float(np.median(steps))
    for wrap in _WRAPS:
        over = steps[falls] + wrap
        if values.max() < wrap and values.min() >= 0 and typical > 0 and (np.abs(over - typical) <= 2 * typical).all():
            carried = np.zeros(len(values))
            carried[falls + 1] = wrap
            notes.append(f"the count begins again after 2^{int(np.log2(wrap))} {len(falls)} time(s); carried on")
            return values + np.cumsum(carried)
    return values


def _days(finite: np.ndarray) -> str:
    """Who counts days like these, where steps in seconds would be of no logger; empty for other numbers."""
    step = float(np.median(np.diff(finite))) if len(finite) > 1 else 0.0
    if not 0 < step < 1 / FASTEST or bool((finite == np.round(finite)).all()):
        return ""
    return next((who for who, (first, last) in _DAYS.items() if first < finite[0] < last), "")


def _from_zero(column: Column, values: np.ndarray, first: float, factor: float, notes: list[str]) -> Clock:
    """Scaled; counts since 1904 or 1970 begin at 0, subtracted before they are scaled to lose no digit."""
    begin = first * factor
    absolute = EPOCH[0] < begin
    seconds = (values - first) * factor if absolute else values * factor if factor != 1.0 else values
    if absolute:
        resolution = max(float(np.spacing(np.nanmax(np.abs(values)))) * factor, 1e-9)
        origin = "LabVIEW counts from 1904" if begin > SECONDS_1904 else f"since 1970: {date_of(begin)}"
        stamp = np.format_float_positional(round(begin, 9), trim="-")
        notes.append(
            f"time: absolute seconds ({origin}) became seconds since the first sample, which was at {stamp} s "
            f"(resolution of the stamp {resolution:.1g} s)"
        )
    return Clock(column.shown, seconds, begin if absolute else 0.0, notes, column)


def date_of(seconds: float) -> str:
    return datetime.fromtimestamp(seconds, tz=UTC).strftime("%Y-%m-%d %H:%M:%S") if seconds < 4e9 else f"{seconds:g} s"


def _time_of_day(column: Column, stamps: np.ndarray, notes: list[str]) -> Clock:
    """Clock times, which begin again at midnight, and dates."""
    finite = stamps[np.isfinite(stamps)]
    if finite.max() < DAY + 1:
        drops = np.flatnonzero(np.diff(stamps) < -DAY / 2)
        if len(drops):
            stamps = stamps.copy()
            for drop in drops:
                stamps[drop + 1 :] += DAY
            notes.append("clock times run over midnight; carried on")
    resolution = max(float(np.spacing(np.abs(finite).max())), 1e-9)
    kind = "dates" if finite.max() > DAY + 1 else "clock times"
    notes.append(f"time: {kind} became seconds since the first sample (resolution of the stamp {resolution:.1g} s)")
    return Clock(column.shown, stamps - finite[0], float(finite[0]), notes, column)


def _told_by_size(finite: np.ndarray, notes: list[str], shown: str) -> str | None:
    """The unit of a count since 1970: with one alone the numbers are a date of this age and the steps short."""
    step = float(np.median(np.diff(finite))) if len(finite) > 1 else 0.0
    for unit, factor in _SCALES:
        begin = float(finite[0]) * factor
        if EPOCH[0] < begin < SECONDS_1904 and 0 <= step * factor < LONGEST_STEP:
            if factor < 1.0:
                notes.append(f"{shown}: {unit} since 1970, as its size and its step of {step * factor:.4g} s say")
            return unit
    return "s" if SECONDS_1904 < float(finite[0]) < 2.2 * SECONDS_1904 and 0 <= step < LONGEST_STEP else None


def ask_for_whole_numbers(source: Source, column: Column, finite: np.ndarray, table: Table) -> None:
    """Stop where the stamps are whole numbers, of which nothing says what they count.

    Raises
    ------
    InputError
        With the rates that seconds, milli-, micro- and nanoseconds would give.
    """
    whole = len(finite) > 2 and bool((finite == np.round(finite)).all())
    step = float(np.median(np.diff(finite))) if len(finite) > 1 else 0.0
    if not whole or step < 1:
        return
    rates = [f"{1 / (step * f):.4g} Hz in {unit}" for unit, f in _SCALES if 0.1 < 1 / (step * f) < FASTEST]
    raise source.error(
        f"unit of time column {column.shown} unknown: whole numbers in steps of {step:g} ({', '.join(rates)}?)",
        "Give --time-unit s, ms or us, or --fs for a sample count.",
        table.part,
    )
