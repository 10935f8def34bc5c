"""Walking a text log: rows of numbers become arrays, everything else stays text with its line number.

Long runs go through a compiled loop that takes only rows it can read exactly: a mantissa below 2**53 times a power
of ten up to 22, where one division rounds correctly (Clinger 1990, "How to read floating point numbers
accurately"). Any other row goes through Python, so both ways give the same numbers bit for bit.
"""

from __future__ import annotations

import threading
from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from ssmr_ident.readers.text.dialect import LONGEST_LINE, is_number_row, value_of
from ssmr_ident.readers.text.encoding import Text
from ssmr_ident.readers.text.numbers import Dialect

LONG = 200_000  # bytes from which on compiling pays
VERY_LONG = 4_000_000  # bytes from which on a second thread pays


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
        if not cells or len(line) > LONGEST_LINE or not is_number_row(cells, dialect.decimal):
            yield TextRow(line_number, cells, raw)
            position, line_number = following, line_number + 1
            continue
        run, position, line_number = _run(text, dialect, position, line_number, width or len(cells))
        yield run


def _line_at(data: bytes, position: int) -> tuple[bytes, int]:
    newline = data.find(b"\n", position)
    stop = len(data) if newline < 0 else newline
    line = data[position : min(stop, position + LONGEST_LINE + 1)]
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
        if not cells or len(cells) > width or len(line) > LONGEST_LINE or not is_number_row(cells, dialect.decimal):
            break
        row = [np.nan] * width
        for index, cell in enumerate(cells):
            if cell:
                value = value_of(cell, dialect.decimal)
                row[index] = np.nan if value is None else value
                if ":" in cell:
                    timed.add(index)
        if len(cells) < width:
            short.append(line_number)
        rows.append(row)
        row_lines.append(line_number)
        position, line_number, patience = following, line_number + 1, patience + 1
    if rows:
        parts.append(np.array(rows))
        numbers.append(np.array(row_lines))
    values = parts[0] if len(parts) == 1 else np.concatenate(parts)
    lines = numbers[0] if len(numbers) == 1 else np.concatenate(numbers)
    run = NumberRun(values, lines, tuple(sorted(timed)), short)
    return run, position, line_number


def compiled_rows(data: bytes, position: int, dialect: Dialect, width: int) -> tuple[np.ndarray, int]:
    """Rows of plain numbers from a byte on, (n, width) with contiguous columns, and the byte where they end."""
    from ssmr_ident.readers.text.fast_rows import parse_rows

    buffer = np.frombuffer(data, dtype=np.uint8)
    delimiter, decimal = ord(dialect.delimiter), ord(dialect.decimal)
    if len(data) - position > VERY_LONG:
        whole, end = _in_halves(buffer, data, position, delimiter, decimal, width)
        if len(whole):
            return whole, end
    head = data[position : position + 65536]
    rows_per_byte = (head.count(b"\n") + 1) / max(len(head), 1)
    blocks = []
    while True:
        # a little more than the head promises, never more than two bytes per cell allow
        guess = int(min(1.05 * rows_per_byte, 1 / (2 * width)) * (len(data) - position)) + 16
        out = np.empty((width, guess))
        count, position = parse_rows(buffer, position, delimiter, decimal, out)
        block = out[:, :count].T
        blocks.append(block if 2 * count > guess else block.copy(order="F"))
        if count < guess:
            return (np.concatenate(blocks) if len(blocks) > 1 else blocks[0]), position


def _in_halves(
    buffer: np.ndarray, data: bytes, position: int, delimiter: int, decimal: int, width: int
) -> tuple[np.ndarray, int]:
    """Both halves of a very long run at once; nothing when the first half is not plain rows throughout."""
    from ssmr_ident.readers.text.fast_rows import count_lines, parse_rows

    middle = data.find(b"\n", (position + len(data)) // 2) + 1
    if not middle:
        return np.empty((0, width)), position
    first = count_lines(buffer[position:middle])
    rest = int(1.05 * first / (middle - position) * (len(data) - middle)) + 16  # what is beyond it comes later
    out = np.empty((width, first + rest))
    ends: list[tuple[int, int]] = []
    beside = threading.Thread(
        target=lambda: ends.append(parse_rows(buffer, middle, delimiter, decimal, out[:, first:]))
    )
    beside.start()
    count, end = parse_rows(buffer[:middle], position, delimiter, decimal, out[:, :first])
    beside.join()
    if count < first or end < middle or not ends:
        return np.empty((0, width)), position
    return out[:, : first + ends[0][0]].T, ends[0][1]
