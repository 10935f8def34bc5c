"""Numbers as logs print them: decimal comma, thousands separators, marks for 'no number', times, dates."""

from __future__ import annotations

import csv
import math
import re
from dataclasses import dataclass
from datetime import UTC, datetime

from ssmr_ident.core.shown import Shown

_POINT = re.compile(r"[+-]?(?:\d+\.?\d*|\.\d+)(?:[eEdD][+-]?\d{1,4})?\Z", re.ASCII)
_COMMA = re.compile(r"[+-]?(?:\d+,?\d*|,\d+)(?:[eEdD][+-]?\d{1,4})?\Z", re.ASCII)
# a group of thousands never starts with 0: 0,001 is a decimal comma, not one thousandth of thousands
_GROUPED_POINT = re.compile(
    r"[+-]?[1-9]\d{0,2}(?:(?:,\d{3})+|(?:'\d{3})+|(?:[ \u00a0\u202f]\d{3})+)(?:\.\d*)?\Z", re.ASCII
)
_GROUPED_COMMA = re.compile(
    r"[+-]?[1-9]\d{0,2}(?:(?:\.\d{3})+|(?:'\d{3})+|(?:[ \u00a0\u202f]\d{3})+)(?:,\d*)?\Z", re.ASCII
)
_NO_NUMBER = {
    "nan",
    "-nan",
    "+nan",
    "1.#qnan",
    "-1.#qnan",
    "1.#ind",
    "-1.#ind",
    "1.#snan",
    "n/a",
    "#n/a",
    "1.#nan",
    "-nan(ind)",
    "1,#qnan",
    "-1,#ind",
    "---",
}
_INFINITE = {
    "inf": math.inf,
    "+inf": math.inf,
    "-inf": -math.inf,
    "1.#inf": math.inf,
    "-1.#inf": -math.inf,
    "infinity": math.inf,
    "-infinity": -math.inf,
}
_CLOCK = re.compile(r"(\d{1,2}):(\d{2}):(\d{2}(?:[.,]\d+)?)\s*([AaPp][Mm])?\Z", re.ASCII)
_DATED = re.compile(r"(\S+?)[T\s]+(\d{1,2}:\d{2}:\d{2}(?:[.,]\d+)?(?:\s*[AaPp][Mm])?)Z?\Z", re.ASCII)


@dataclass(frozen=True)
class Dialect(Shown):
    """How a text log separates its cells and its decimals.

    Parameters
    ----------
    delimiter : str
        ``\\t``, ``;``, ``,`` or a blank (any run of white space).
    decimal : str
        ``.`` or ``,``.
    """

    delimiter: str
    decimal: str = "."

    def cells(self, line: str) -> list[str]:
        """Cells of a line, unquoted and stripped; empty cells at the end are dropped."""
        if self.delimiter == " ":
            cells = line.split()
        elif '"' in line and len(line) < 100_000:
            try:
                cells = next(csv.reader([line], delimiter=self.delimiter, skipinitialspace=True), [])
            except csv.Error:
                cells = line.split(self.delimiter)
        else:
            cells = line.split(self.delimiter)
        cells = [cell.strip() for cell in cells]
        while cells and not cells[-1]:
            cells.pop()
        return cells

    def __str__(self) -> str:
        names = {"\t": "tab", ";": "semicolon", ",": "comma", " ": "blanks"}
        return f"{names[self.delimiter]} separated, decimal {'point' if self.decimal == '.' else 'comma'}"


def number(token: str, decimal: str = ".") -> float:
    """A printed number; NaN for the marks that mean 'no number'.

    Raises
    ------
    ValueError
        For text. ``float`` itself is too kind: it takes ``1_000`` and digits of other scripts.

    >>> number("1.234,5", ",")
    1234.5
    """
    plain, grouped = (_POINT, _GROUPED_POINT) if decimal == "." else (_COMMA, _GROUPED_COMMA)
    if plain.match(token):
        return float(token.replace(",", ".").replace("d", "e").replace("D", "e"))
    if grouped.match(token):
        digits = re.sub(r"['\s\u00a0\u202f]", "", token).replace("," if decimal == "." else ".", "")
        return float(digits.replace(",", "."))
    lowered = token.lower()
    if lowered in _NO_NUMBER:
        return math.nan
    if lowered in _INFINITE:
        return _INFINITE[lowered]
    raise ValueError(token)


def clock(token: str) -> float | None:
    """Seconds since midnight of ``14:03:11.5`` or ``2:03:11 PM``; None for anything else.

    >>> clock("2:03:11 PM")
    50591.0
    """
    match = _CLOCK.match(token)
    if not match:
        return None
    hour, minute, second = int(match[1]), int(match[2]), float(match[3].replace(",", "."))
    if match[4]:
        if not 1 <= hour <= 12:
            return None
        hour = hour % 12 + (12 if match[4].lower() == "pm" else 0)
    return None if hour > 24 or minute > 59 or second >= 61 else hour * 3600.0 + minute * 60.0 + second


def dated(token: str) -> float | None:
    """Seconds since 1970 of a date with a clock time; None for anything else."""
    match = _DATED.match(token)
    seconds = clock(match[2]) if match else None
    if match is None or seconds is None:
        return None
    for pattern in ("%Y-%m-%d", "%Y/%m/%d", "%d.%m.%Y", "%m/%d/%Y", "%d/%m/%Y", "%d-%m-%Y"):
        # the day does not matter for elapsed seconds unless a recording runs over midnight
        try:
            day = datetime.strptime(match[1], pattern).replace(tzinfo=UTC)
        except ValueError:
            continue
        return day.timestamp() + seconds
    return None


def evidence_for_decimal(token: str) -> str:
    """What a token says about the decimal sign: ``.``, ``,`` or '' when it could be read either way."""
    marks = [mark for mark in token if mark in ".,"]
    if not marks:
        return ""
    if "." in marks and "," in marks:
        return marks[-1]
    mark = marks[0]
    other = "," if mark == "." else "."
    if len(marks) > 1:
        return other
    before, _, after = token.lstrip("+-").partition(mark)
    digits = re.match(r"\d*", after)[0]  # type: ignore[index]  # always matches
    if len(digits) == 3 and digits == after and 1 <= len(before) <= 3 and not before.startswith("0"):
        return ""
    return mark
