"""Walking a text log: rows of numbers become arrays, everything else stays text with its line number.

Long runs go through a compiled loop that takes only rows it can read exactly: a mantissa below 2**53 times a power
of ten up to 22, where one division rounds correctly (Clinger 1990, "How to read floating point numbers
accurately"). Any other row goes through Python, so both ways give the same numbers bit for bit.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from ssmr_ident.readers.dialect import is_number_row, value_of
from ssmr_ident.readers.numbers import Dialect
from ssmr_ident.readers.text import Text

LONG = 200_000  # bytes from which on compiling pays
LONGEST_LINE = 1_000_000  # bytes; no log has such rows


@dataclass
class NumberRun:
    """Consecutive rows of numbers with one count of columns.

    Parameters
    ----------
    values : (n, m) float
        Empty cells are NaN.
    lines : (n,) int
        Line number in the file of each row, from 1.
    timed : tuple of int
        Columns that hold clock times or dates, in seconds.
    short : list of int
        Lines with fewer cells than the run.
    """

    values: np.ndarray
    lines: np.ndarray
    timed: tuple[int, ...]
    short: list[int]


@dataclass
class TextRow:
    """A line that is no row of numbers."""

    line: int
    cells: list[str]
    raw: str


def walk(
    text: Text, dialect: Dialect, *, start: int = 0, first_line: int = 1, width: int | None = None
) -> Iterator[NumberRun | TextRow]:
    """Runs of numbers and lines of text, in the order of the file.

    Parameters
    ----------
    text : Text
    dialect : Dialect
    start : int
        Byte to begin at.
    first_line : int
        Its line number.
    width : int or None
        Count of columns that a row of numbers has; None takes each run's first row.
    """
    data, end = text.data, len(text.data)
    position, line_number = start, first_line
    while position < end:
        line, following = _line_at(data, position)
        raw = text.decode(line)
        cells = dialect.cells(raw)
        if not cells or not is_number_row(cells, dialect.decimal):
            yield TextRow(line_number, cells, raw)
            position, line_number = following, line_number + 1
            continue
        run, position, line_number = _run(text, dialect, position, line_number, width or len(cells))
        yield run


def _line_at(data: bytes, position: int) -> tuple[bytes, int]:
    newline = data.find(b"\n", position)
    stop = len(data) if newline < 0 else newline
    line = data[position : min(stop, position + LONGEST_LINE)]
    return line, stop + 1


def _run(text: Text, dialect: Dialect, position: int, line_number: int, width: int) -> tuple[NumberRun, int, int]:
    data, end = text.data, len(text.data)
    parts: list[np.ndarray] = []
    numbers: list[np.ndarray] = []
    rows: list[list[float]] = []
    row_lines: list[int] = []
    timed: set[int] = set()
    short: list[int] = []
    compiled = end - position > LONG
    patience = 50  # rows through Python before the compiled loop is tried again
    while position < end:
        if compiled and patience >= 50:
            block, position = compiled_rows(data, position, dialect, width)
            patience = 0
            if len(block):
                if rows:
                    parts.append(np.array(rows))
                    numbers.append(np.array(row_lines))
                    rows, row_lines = [], []
                parts.append(block)
                numbers.append(np.arange(line_number, line_number + len(block)))
                line_number += len(block)
                continue
        line, following = _line_at(data, position)
        cells = dialect.cells(text.decode(line))
        if not cells or len(cells) > width or not is_number_row(cells, dialect.decimal):
            break
        values = [np.nan] * width
        for index, cell in enumerate(cells):
            if cell:
                value = value_of(cell, dialect.decimal)
                values[index] = np.nan if value is None else value
                if ":" in cell:
                    timed.add(index)
        if len(cells) < width:
            short.append(line_number)
        rows.append(values)
        row_lines.append(line_number)
        position, line_number, patience = following, line_number + 1, patience + 1
    if rows:
        parts.append(np.array(rows))
        numbers.append(np.array(row_lines))
    run = NumberRun(np.concatenate(parts), np.concatenate(numbers), tuple(sorted(timed)), short)
    return run, position, line_number


def compiled_rows(data: bytes, position: int, dialect: Dialect, width: int) -> tuple[np.ndarray, int]:
    """Rows of plain numbers from a byte on, (n, width), and the byte where they end."""
    from ssmr_ident.readers.fast_rows import parse_rows

    buffer = np.frombuffer(data, dtype=np.uint8)
    # rows cannot be shorter than one digit and one separator per cell; grow only as far as the text goes
    guess = min((len(data) - position) // (2 * width) + 1, 65536)
    blocks = []
    while True:
        out = np.empty((guess, width))
        count, position = parse_rows(buffer, position, ord(dialect.delimiter), ord(dialect.decimal), out)
        blocks.append(out[:count])
        if count < guess:
            return (np.concatenate(blocks) if len(blocks) > 1 else blocks[0]), position
        guess = min((len(data) - position) // (2 * width) + 1, 4 * guess)
