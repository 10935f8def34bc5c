"""Times of day and dates as logs print them, a whole column at once.

Which of two numbers is the day and which the month cannot be told from one stamp: the column tells, by a number above
twelve or by the order that lets the log last less long.
"""

from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import dataclass
from datetime import UTC, datetime
from functools import lru_cache

import numpy as np

LONGEST = 48  # characters of a stamp
_CLOCK = (
    r"(?P<hour>\d{1,2}):(?P<minute>\d{2})(?::(?P<second>\d{2})(?:[.,:](?P<fraction>\d{1,9}))?)?"
    r"(?:\s?(?P<half>[AaPp]\.?[Mm]\.?))?"
)
_SPAN = (
    r"(?P<days>-?\d{1,5}) days?,? \+?(?P<hour>\d{1,2}):(?P<minute>\d{2}):(?P<second>\d{2})(?:\.(?P<fraction>\d{1,9}))?"
)
_MINUTES = r"(?P<minute>\d{1,3}):(?P<second>\d{2})[.,](?P<fraction>\d{1,9})"
_NUMBERS = r"(?P<one>\d{1,4})(?P<mark>[-/.])(?P<two>\d{1,2})(?P=mark)(?P<three>\d{1,4})\.?"
_NAMED = r"(?P<day>\d{1,2})[-\s./]?(?P<month>[A-Za-zäéû]{3,9})\.?[-\s./,]?(?P<year>\d{4}|\d{2})"
_WEEKDAY = r"(?:[A-Za-zé]{2,9}\.?,? )?"  # Mon, Monday, Mo.
_CTIME = (
    r"(?P<month>[A-Za-z]{3,9}) {1,2}(?P<day>\d{1,2}) (?P<hour>\d{1,2}):(?P<minute>\d{2}):(?P<second>\d{2})"
    r"(?:[.,](?P<fraction>\d{1,9}))?(?: [A-Z]{3,4})? (?P<year>\d{4})"
)
_AMERICAN = r"(?P<month>[A-Za-z]{3,9})\.? (?P<day>\d{1,2}), ?(?P<year>\d{4})"
_COMPACT = (
    r"(?P<one>\d{4})(?P<two>\d{2})(?P<three>\d{2})[T_ -](?P<hour>\d{2}):?(?P<minute>\d{2}):?(?P<second>\d{2})"
    r"(?:[.,](?P<fraction>\d{1,9}))?"
)
_ZONE = r"\s?(?:Z|(?:UTC|GMT)?[+-]\d{2}:?\d{2}|UTC|GMT)?"
_FORMS = tuple(
    re.compile(form + r"\Z", re.ASCII if "ä" not in form else 0)
    for form in (
        _CLOCK, _MINUTES, _NUMBERS, _SPAN,
        *(f"{date}(?:[T_-]|,?\\s){_CLOCK}{_ZONE}" for date in (_NUMBERS, _WEEKDAY + _NAMED, _WEEKDAY + _AMERICAN)),
        _WEEKDAY + _CTIME,
        rf"{_CLOCK}[\s,]{_NUMBERS}", _NAMED, f"{_COMPACT}{_ZONE}",
    )
)  # fmt: skip
_BETWEEN = ("T", "_", "-", " ")  # a date of eight digits and its time
_MONTHS = {
    name: number
    for number, names in enumerate(
        ("jan ene", "feb fev fév", "mar mär mrz", "apr avr abr", "may mai", "jun juin", "jul juil", "aug aou aoû ago",
         "sep", "oct okt", "nov", "dec dez déc dic"), start=1)
    for name in names.split()
}  # fmt: skip


@dataclass(frozen=True)
class Stamps:
    """A column of stamps in seconds.

    Parameters
    ----------
    seconds : (n,) float [s]
        Since midnight, or since 1970 where a date is printed; NaN for cells that are no stamp.
    dated : bool
        True with dates.
    timed : bool
        True with a time of day; False for dates alone.
    """

    seconds: np.ndarray
    dated: bool
    timed: bool


def is_stamp(cell: str) -> bool:
    """True for a time of day, with a date or without.

    >>> is_stamp("2:03:11 PM"), is_stamp("2024-03-01 12:00:00.005"), is_stamp("20240301T120000.005Z"), is_stamp("12.5")
    (True, True, True, False)
    """
    return (":" in cell or cell[8:9] in _BETWEEN) and len(cell) <= LONGEST and _parts(cell) is not None


def is_date(cell: str) -> bool:
    """True for a date alone."""
    if len(cell) > LONGEST or ":" in cell:
        return False
    parts = _parts(cell)
    return parts is not None and ("one" in parts or "month" in parts) and parts.get("minute") is None


@lru_cache(maxsize=20_000)  # a cell is asked about as a stamp and as a date, for every dialect that does not cut it
def _parts(cell: str) -> dict[str, str] | None:
    """Named parts of a stamp; None for anything else, and for hours, minutes and months that are none."""
    for form in _FORMS:
        match = form.match(cell)
        if match is None:
            continue
        parts = {name: text for name, text in match.groupdict().items() if text is not None}
        if int(parts.get("hour", 0)) > 24 or int(parts.get("second", 0)) > 60:
            return None
        if int(parts.get("minute", 0)) > (59 if "hour" in parts else 999):
            return None
        if "half" in parts and not 1 <= int(parts["hour"]) <= 12:
            return None
        if "month" in parts and _month(parts["month"]) is None:
            return None
        return parts
    return None


def _month(name: str) -> int | None:
    folded = name.lower()
    return _MONTHS.get(folded[:4]) or _MONTHS.get(folded[:3])


def seconds_of(cells: Sequence[bytes]) -> Stamps:
    """Read a column.

    Parameters
    ----------
    cells : sequence of bytes
        Without quotes and blanks around; ASCII for all that is read.
    """
    width = min(LONGEST, max(map(len, cells), default=1) or 1)
    table = np.array(cells, dtype=f"S{width}")
    letters = table.view(np.uint8).reshape(len(table), width)
    digit = (letters >= 48) & (letters <= 57)
    template = np.where(digit, np.uint8(48), letters)
    parts: dict[str, np.ndarray] = {}
    left = np.ones(len(table), dtype=bool)
    dated = timed = False
    while left.any():
        first = int(np.flatnonzero(left)[0])
        alike = left & (template == template[first]).all(axis=1)
        left &= ~alike
        cell = cells[first][:LONGEST].decode("utf-8", errors="replace")
        found = _parts(cell)
        if found is None or len(cell) != len(cells[first][:LONGEST]):
            continue
        rows: np.ndarray | slice = slice(None) if alike.all() else np.flatnonzero(alike)
        dated |= "one" in found or "month" in found
        timed |= "minute" in found
        match = next(form.match(cell) for form in _FORMS if form.match(cell))
        assert match is not None
        for name, text in found.items():
            begin, end = match.span(name)
            column = parts.setdefault(name, np.full(len(table), np.nan))
            if text.isdigit():
                value = np.zeros(len(letters[rows, begin]))
                for k in range(begin, end):
                    value = 10.0 * value + (letters[rows, k] - 48.0)
                column[rows] = value / 10.0 ** (end - begin) if name == "fraction" else value
            elif name == "month":
                column[rows] = _month(text) or np.nan
            elif name == "half":
                column[rows] = 12.0 if text[0] in "pP" else 0.0
    return Stamps(_together(parts, len(table)), dated, timed)


def _together(parts: dict[str, np.ndarray], count: int) -> np.ndarray:
    """Seconds from the parts of the stamps."""

    def part(name: str) -> np.ndarray:
        column: np.ndarray = np.nan_to_num(parts.get(name, np.zeros(count)))
        return column

    hour = part("hour")
    if "half" in parts:
        hour = np.where(np.isfinite(parts["half"]), hour % 12 + part("half"), hour)
    hour = hour + 24.0 * part("days")
    clock = hour * 3600.0 + part("minute") * 60.0 + (part("second") + part("fraction"))
    known = np.isfinite(parts.get("minute", np.full(count, np.nan)))
    days = _days(parts, count)
    if days is not None:
        known |= np.isfinite(days)
        clock = clock + 86400.0 * days
    return np.where(known, clock, np.nan)


def _days(parts: dict[str, np.ndarray], count: int) -> np.ndarray | None:
    """Days since 1970, NaN where no date stands."""
    if "one" not in parts:
        if "month" not in parts:
            return None
        return _ordinals(parts["year"], parts["month"], parts["day"])
    one, two, three = parts["one"], parts["two"], parts["three"]
    if np.nanmax(one) > 31:
        return _ordinals(one, two, three)
    day_first, month_first = _ordinals(three, two, one), _ordinals(three, one, two)
    spoilt = [np.isnan(days[np.isfinite(one)]).sum() for days in (day_first, month_first)]
    if spoilt[0] != spoilt[1]:
        return day_first if spoilt[0] < spoilt[1] else month_first
    spans = [float(np.nanmax(days) - np.nanmin(days)) if np.isfinite(days).any() else 0.0
             for days in (day_first, month_first)]  # fmt: skip
    return month_first if spans[1] < spans[0] else day_first


def _ordinals(year: np.ndarray, month: np.ndarray, day: np.ndarray) -> np.ndarray:
    """Days since 1970 of dates; NaN for those that are none."""
    code = year * 1e4 + month * 1e2 + day
    result = np.full(len(code), np.nan)
    good = np.isfinite(code)
    if not good.any():
        return result
    unique, inverse = np.unique(code[good], return_inverse=True)
    days = np.full(len(unique), np.nan)
    for k, number in enumerate(unique.astype(int)):
        y, m, d = number // 10_000, number // 100 % 100, number % 100
        try:
            days[k] = datetime(y + 2000 if y < 100 else y, m, d, tzinfo=UTC).timestamp() / 86400.0
        except ValueError:
            continue  # 31 February: no date, and the stamp is none
    result[good] = days[inverse.ravel()]
    return result
