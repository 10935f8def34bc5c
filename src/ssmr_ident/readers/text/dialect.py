"""How a text log is written: delimiter, decimal sign, and which columns hold numbers, stamps, or text.

The way of reading that makes the longest run of rows with most numbers and least text is the log's own.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import lru_cache

from ssmr_ident.readers.options import ReadOptions
from ssmr_ident.readers.source import Source
from ssmr_ident.readers.text.encoding import Text
from ssmr_ident.readers.text.numbers import Dialect, evidence_for_decimal, number
from ssmr_ident.readers.text.stamps import is_date, is_stamp

# In the order of preference among equals: a tab or a semicolon is never part of a number
_CANDIDATES = [
    Dialect(d, m)
    for d, m in (("\t", "."), ("\t", ","), (";", "."), (";", ","), (",", "."), (",", ","), ("|", "."), ("|", ","),
                 (" ", "."), (" ", ","))
]  # fmt: skip
LONGEST_LINE = 20_000  # bytes; no log has such rows, so a longer line is taken as text
_HEAD_LINES = (120, 5000)  # first look, second look when the first found hardly any numbers
_ELSEWHERE = 60  # lines from the middle and from the end that say what a column holds
_HEADER_ROWS = 3  # rows of words that a header may have
NUMBER, TEXT, STAMP = 0, 1, 2


@dataclass(frozen=True)
class Layout:
    """How the body of a log is written.

    Parameters
    ----------
    dialect : Dialect
    kinds : tuple of int
        ``NUMBER``, ``TEXT`` or ``STAMP`` for every column of the body.
    """

    dialect: Dialect
    kinds: tuple[int, ...] = ()

    def kinds_for(self, width: int) -> tuple[int, ...]:
        """What the columns of rows of a width hold; rows of another width than the body's hold numbers alone."""
        return self.kinds if len(self.kinds) == width else (NUMBER,) * width


def value_of(token: str, decimal: str) -> float | None:
    """Value of a cell: a number, NaN for 'no number'; None for text."""
    try:
        return number(token, decimal)
    except ValueError:
        return None


def filled_up(cells: list[str], line: bytes, layout: Layout) -> list[str]:
    """The cells with the empty ones at the end of a line that the body's columns are counted with."""
    sign, count = layout.dialect.delimiter, len(layout.kinds)
    if sign == " " or len(cells) >= count or line.count(sign.encode()) < count - 1:
        return cells
    return cells + [""] * (count - len(cells))


def numbers_of(cells: list[str], layout: Layout) -> list[float | None] | None:
    """The cells' numbers, NaN for empty ones and for text, None for a stamp; None for cells that are no row.

    A row is one of the body, or cells that are all numbers or stamps, at least one a finite one.
    """
    found = False
    kinds = layout.kinds if 1 < len(cells) == len(layout.kinds) else ()
    decimal = layout.dialect.decimal
    numbers: list[float | None] = [math.nan] * len(cells)
    for k, cell in enumerate(cells):
        if not cell or (kinds and kinds[k] == TEXT):
            continue
        value = numbers[k] = value_of(cell, decimal)
        if value is None and not (is_stamp(cell) or (kinds and kinds[k] == STAMP and is_date(cell))):
            return None
        found = found or value is None or value == value
    return numbers if found else None


def is_row(cells: list[str], layout: Layout) -> bool:
    """True when the cells are a row of numbers."""
    return numbers_of(cells, layout) is not None


def sniff(source: Source, text: Text, options: ReadOptions, *, delimiters: str = "\t;,| ") -> Layout:
    """The layout of a text.

    Raises
    ------
    InputError
        When there are no rows of numbers, or the numbers can be read with either decimal sign.
    """
    best: Dialect | None = None
    rows: list[list[str]] = []
    for count in _HEAD_LINES:
        head = text.data[: count * 400].split(b"\n", count)[:count]
        lines = [text.decode(line) for line in head if len(line) <= LONGEST_LINE]
        best, most, rows = None, 0.0, []
        whole = 0
        absent: set[str] = set()  # decimal signs tried with a delimiter that no line holds: another one reads the same
        for dialect in _CANDIDATES:
            if dialect.delimiter == dialect.decimal and not any('"' in line for line in lines):
                continue  # a comma between numbers and within them needs quotes around them
            if dialect.delimiter not in delimiters or (options.decimal or dialect.decimal) != dialect.decimal:
                continue
            if dialect.delimiter != " " and not any(dialect.delimiter in line for line in lines):
                if dialect.decimal in absent:
                    continue
                absent.add(dialect.decimal)
            run, worth = _longest_run(lines, dialect)
            if dialect.delimiter == " " and len(run) <= whole:
                continue  # blanks within cells of a table that a sign separates throughout
            if dialect.delimiter != " " and len(run) > whole and _without_words(run, dialect):
                whole = len(run)
            if worth > most:
                best, most, rows = dialect, worth, run
        if best is not None and len(rows) >= 20:
            break
    if best is None:
        raise source.error("holds no rows of numbers", "Export the data, not a report or a picture of it.")
    more = _elsewhere(text, best, len(rows[0])) if len(rows) >= _ELSEWHERE // 2 else []
    kinds = _kinds(rows, more, best)
    if not options.decimal:
        best = _with_decimal(source, best, rows, kinds)
    return Layout(best, kinds)


def _elsewhere(text: Text, dialect: Dialect, width: int) -> list[list[str]]:
    """Rows of the same width from the middle and the end of a text."""
    found = []
    for begin in (len(text.data) // 2, max(0, len(text.data) - 200 * _ELSEWHERE)):
        for line in text.data[begin : begin + 200 * _ELSEWHERE].split(b"\n")[1 : _ELSEWHERE + 1]:
            cells = dialect.cells(text.decode(line))
            if len(cells) == width:
                found.append(cells)
    return found


def _longest_run(lines: list[str], dialect: Dialect) -> tuple[list[list[str]], float]:
    """Longest run of rows with one count of columns of which some hold numbers throughout, and what it is worth."""
    best: list[list[str]] = []
    rows, most = 0, 0.0  # of the best run, which grows on
    run: list[list[str]] = []
    numeric: frozenset[int] = frozenset()
    words: frozenset[int] = frozenset()
    written = 0  # cells of the run's first row, empty ones at its end counted
    for line in lines:
        cells = dialect.cells(line)
        if not cells:
            continue
        kinds = [_sure(cell, dialect.decimal) for cell in cells]
        numbers = frozenset(k for k, kind in enumerate(kinds) if kind == NUMBER)
        text = frozenset(k for k, kind in enumerate(kinds) if kind == TEXT)
        if not numbers:
            run, numeric, words = [], frozenset(), frozenset()
            continue
        # a row may lack cells at its end, which were empty; it may not turn a column of numbers to words, or back
        apart = run and (len(cells) > written or 2 * len(cells) < len(run[0]) or numeric & text or numbers & words)
        if apart:
            run, numeric, words = [], frozenset(), frozenset()
        if not run:
            written = len(cells) if dialect.delimiter == " " else max(len(cells), line.count(dialect.delimiter) + 1)
        run.append(cells)
        numeric, words = numeric | numbers, words | text
        worth = len(run) * len(numeric) ** 2 / max(len(run[0]), len(cells))
        if worth > most:
            best, rows, most = run, len(run), worth
    return best[:rows], most


def _without_words(run: list[list[str]], dialect: Dialect) -> bool:
    """True for rows of several cells that hold numbers, stamps, or nothing."""
    return min(map(len, run), default=0) > 1 and not any(
        _sure(c, dialect.decimal) == TEXT for row in run for c in row if c
    )


@lru_cache(maxsize=20_000)  # cells are looked at once for every dialect that does not cut them
def _sure(cell: str, decimal: str) -> int:
    """What a cell holds; -1 for an empty one and for a mark of 'no number', which stand in columns of either kind."""
    value = value_of(cell, decimal) if cell else float("nan")
    if value is not None:
        return NUMBER if value == value else -1
    return NUMBER if is_stamp(cell) or is_date(cell) else TEXT


def _kinds(rows: list[list[str]], more: list[list[str]], dialect: Dialect) -> tuple[int, ...]:
    """What the columns of a run hold; rows from elsewhere can only say that a column of numbers holds words later."""
    kinds = []
    for k in range(max(map(len, rows))):
        cells = [row[k] for row in rows if k < len(row) and row[k]]
        stamps = sum(is_stamp(cell) or is_date(cell) for cell in cells)
        later = [_sure(row[k], dialect.decimal) for row in more if k < len(row)]
        sure = [_sure(cell, dialect.decimal) for cell in cells]
        # words for 'no number' alone are a state's as well, if other words follow and never a number
        state = bool(sure) and NUMBER not in sure + later and later.count(TEXT) > _HEADER_ROWS
        if TEXT in sure or state or later.count(TEXT) > len(later) / 2:
            kinds.append(TEXT)
        else:
            kinds.append(STAMP if 2 * stamps > len(cells) else NUMBER)
    return tuple(kinds)


def _with_decimal(source: Source, dialect: Dialect, rows: list[list[str]], kinds: tuple[int, ...]) -> Dialect:
    """Decide by the whole columns whether ``1,234`` is a thousand or one and a bit."""
    numbers = [cell for row in rows for k, cell in enumerate(row) if kinds[k] == NUMBER and ":" not in cell]
    if dialect.delimiter == "," and not any("," in cell for cell in numbers):
        return dialect  # an unquoted comma separates cells here, so no comma is left inside a number
    votes = {evidence_for_decimal(cell) for cell in numbers}
    if "." in votes and "," in votes:
        raise source.error("has numbers with decimal points and with decimal commas", "Give --decimal . or ,")
    if "," in votes or "." in votes:
        return Dialect(dialect.delimiter, "," if "," in votes else ".")
    undecided = next((cell for cell in numbers if "." in cell or "," in cell), None)
    if undecided is not None:
        raise source.error(f"number {undecided!r} may hold a decimal or a thousands separator", "Give --decimal . or ,")
    return dialect
