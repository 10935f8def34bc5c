"""Numbers as logs print them: decimal comma, thousands separators, marks for 'no number', times, dates."""

from __future__ import annotations

import csv
import math
import re
from dataclasses import dataclass

from ssmr_ident.core.shown import Shown

LONGEST = 400  # characters of a number; a longer cell is text, and no pattern looks at it
_POINT = re.compile(r"[+-]?(?:\d+(?:\.\d*)?|\.\d+)(?:[eEdD][+-]?\d{1,4})?\Z", re.ASCII)
_COMMA = re.compile(r"[+-]?(?:\d+(?:,\d*)?|,\d+)(?:[eEdD][+-]?\d{1,4})?\Z", re.ASCII)
# a group of thousands never starts with 0: 0,001 is a decimal comma, not one thousandth of thousands
_GROUPED_POINT = re.compile(
    r"[+-]?[1-9]\d{0,2}(?:(?:,\d{3})+|(?:'\d{3})+|(?:[ \u00a0\u202f]\d{3})+)(?:\.\d*)?\Z", re.ASCII
)
_GROUPED_COMMA = re.compile(
    r"[+-]?[1-9]\d{0,2}(?:(?:\.\d{3})+|(?:'\d{3})+|(?:[ \u00a0\u202f]\d{3})+)(?:,\d*)?\Z", re.ASCII
)
_NO_NUMBER = {
    "nan", "-nan", "+nan", "1.#qnan", "-1.#qnan", "1.#ind", "-1.#ind", "1.#snan", "1.#nan", "-nan(ind)", "1,#qnan",
    "-1,#ind", "n/a", "#n/a", "na", "nat", "<na>", "---", "--", "null", "none", "#nv", "#wert!", "#value!", "#num!",
    "#div/0!", "#ref!", "n.def.", "overload", "overflow", "overrange", "over range", "ovrflw", "ovrng", "ovld", "ovl",
    "+ovl", "-ovl", "over", "+over", "-over", "under", "underflow", "underrange", "saturated", "out of range", "open",
    "error", "err", "invalid", "bad", "missing", "no data", "nodata", "*****", "********",
}  # fmt: skip
_INFINITE = {
    "inf": math.inf,
    "+inf": math.inf,
    "-inf": -math.inf,
    "1.#inf": math.inf,
    "-1.#inf": -math.inf,
    "infinity": math.inf,
    "-infinity": -math.inf,
}


@dataclass(frozen=True)
class Dialect(Shown):
    """How a text log separates its cells and its decimals.

    Parameters
    ----------
    delimiter : str
        ``\\t``, ``;``, ``,``, ``|`` or a blank (any run of white space).
    decimal : str
        ``.`` or ``,``.
    """

    delimiter: str
    decimal: str = "."

    def cells(self, line: str) -> list[str]:
        """Cells of a line, unquoted and stripped; empty cells at the end are dropped."""
        if self.delimiter == " ":
            cells = line.split()
        elif self.delimiter == "|":
            cells = line.strip().removeprefix("|").split("|")
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
        names = {"\t": "tab", "|": "bar", ";": "semicolon", ",": "comma", " ": "blanks"}
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
    if len(token) > LONGEST:
        raise ValueError(token[:40])
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


def evidence_for_decimal(token: str) -> str:
    """What a token says about the decimal sign: ``.``, ``,`` or '' when it could be read either way."""
    marks = [mark for mark in token[:LONGEST] if mark in ".,"]
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
