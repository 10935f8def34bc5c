"""Which delimiter and which decimal sign a text log has: the pair that yields the longest run of number rows."""

from __future__ import annotations

from ssmr_ident.readers.options import ReadOptions
from ssmr_ident.readers.source import Source
from ssmr_ident.readers.text.encoding import Text
from ssmr_ident.readers.text.numbers import Dialect, clock, dated, evidence_for_decimal, number

# In the order of preference among equals: a tab or a semicolon is never part of a number
_CANDIDATES = [
    Dialect(d, m) for d, m in (("\t", "."), ("\t", ","), (";", "."), (";", ","), (",", "."), (" ", "."), (" ", ","))
]
LONGEST_LINE = 20_000  # bytes; no log has such rows, so a longer line is taken as text
_HEAD_LINES = (120, 5000)  # first look, second look when the first found hardly any numbers


def value_of(token: str, decimal: str) -> float | None:
    """Value of a cell: a number, NaN for 'no number', seconds for clock times and dates; None for text."""
    try:
        return number(token, decimal)
    except ValueError:
        if ":" not in token:
            return None
        seconds = clock(token)
        return seconds if seconds is not None else dated(token)


def is_number_row(cells: list[str], decimal: str) -> bool:
    """True when every cell is a number, a time or empty, and at least one is a finite number."""
    found = False
    for cell in cells:
        if not cell:
            continue
        value = value_of(cell, decimal)
        if value is None:
            return False
        found = found or value == value
    return found


def sniff(source: Source, text: Text, options: ReadOptions, *, delimiters: str = "\t;, ") -> Dialect:
    """The dialect of a text.

    Raises
    ------
    InputError
        When there are no rows of numbers, or the numbers can be read with either decimal sign.
    """
    for count in _HEAD_LINES:
        head = text.data[: count * 400].split(b"\n", count)[:count]
        lines = [text.decode(line) for line in head if len(line) <= LONGEST_LINE]
        best, length, rows = None, 0, []
        for dialect in _CANDIDATES:
            if dialect.delimiter not in delimiters or (options.decimal or dialect.decimal) != dialect.decimal:
                continue
            run = _longest_run(lines, dialect)
            score = len(run) * (2 if run and len(run[0]) > 1 else 1)
            if score > length:
                best, length, rows = dialect, score, run
        if best is not None and len(rows) >= 20:
            break
    if best is None:
        raise source.error("holds no rows of numbers", "Export the data, not a report or a picture of it.")
    if options.decimal:
        return best
    return _with_decimal(source, best, rows)


def _longest_run(lines: list[str], dialect: Dialect) -> list[list[str]]:
    """Longest run of rows of numbers with one count of columns."""
    best: list[list[str]] = []
    run: list[list[str]] = []
    for line in lines:
        cells = dialect.cells(line)
        if cells and is_number_row(cells, dialect.decimal):
            if run and len(run[-1]) != len(cells):
                run = []
            run.append(cells)
            if len(run) > len(best):
                best = run
        elif cells:
            run = []
    return best


def _with_decimal(source: Source, dialect: Dialect, rows: list[list[str]]) -> Dialect:
    """Decide by the whole columns whether ``1,234`` is a thousand or one and a bit."""
    if dialect.delimiter == "," and not any("," in cell for row in rows for cell in row):
        return dialect  # an unquoted comma separates cells here, so no comma is left inside a number
    votes = {evidence_for_decimal(cell) for row in rows for cell in row if ":" not in cell}
    if "." in votes and "," in votes:
        raise source.error("has numbers with decimal points and with decimal commas", "Give --decimal . or ,")
    if "," in votes or "." in votes:
        return Dialect(dialect.delimiter, "," if "," in votes else ".")
    undecided = next((cell for row in rows for cell in row if "." in cell or "," in cell), None)
    if undecided is not None:
        raise source.error(f"number {undecided!r} may hold a decimal or a thousands separator", "Give --decimal . or ,")
    return dialect
