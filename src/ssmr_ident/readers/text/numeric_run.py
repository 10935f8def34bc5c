"""Walking a text log: rows of numbers become arrays, everything else stays text with its line number.

Long runs go through a compiled loop that takes only rows it can read exactly: a mantissa below 2**53 times a power
of ten up to 22, where one division rounds correctly (Clinger 1990, "How to read floating point numbers
accurately"). Any other row goes through Python, so both ways give the same numbers bit for bit.
"""

from __future__ import annotations

import threading
from collections.abc import Iterator
from dataclasses import dataclass, field

import numpy as np

from ssmr_ident.readers.text.dialect import LONGEST_LINE, NUMBER, STAMP, TEXT, Layout, filled_up, is_row, numbers_of
from ssmr_ident.readers.text.encoding import Text
from ssmr_ident.readers.text.numbers import Dialect
from ssmr_ident.readers.text.stamps import seconds_of

LONG = 200_000  # bytes from which on compiling pays
VERY_LONG = 4_000_000  # bytes from which on a second thread pays
_AHEAD = 50  # rows that say how wide a run is


@dataclass
class NumberRun:
    """Consecutive rows of numbers with one count of columns.

    Parameters
    ----------
    values : (n, m) float
        Empty cells are NaN, and so are cells of text.
    lines : (n,) int
        Line number in the file of each row, from 1.
    timed : tuple of int
        Columns that hold clock times or dates, in seconds.
    short : list of int
        Lines with fewer cells than the run.
    text : tuple of int
        Columns of words.
    written : int
        Columns with those at the end that hold nothing.
    """

    values: np.ndarray
    lines: np.ndarray
    timed: tuple[int, ...]
    short: list[int] = field(default_factory=list)
    text: tuple[int, ...] = ()
    written: int = 0


@dataclass
class TextRow:
    """A line that is no row of numbers."""

    line: int
    cells: list[str]
    raw: str


def walk(
    text: Text, layout: Layout, *, start: int = 0, first_line: int = 1, width: int | None = None
) -> Iterator[NumberRun | TextRow]:
    """Runs of numbers and lines of text, in the order of the file.

    Parameters
    ----------
    text : Text
    layout : Layout
    start : int
        Byte to begin at.
    first_line : int
        Its line number.
    width : int or None
        Count of columns that a row of numbers has; None takes each run's widest row of the first fifty.
    """
    data, end = text.data, len(text.data)
    position, line_number = start, first_line
    while position < end:
        line, following = _line_at(data, position)
        raw = text.decode(line)
        cells = layout.dialect.cells(raw)
        if width is None:
            cells = filled_up(cells, line, layout)
        if not cells or len(line) > LONGEST_LINE or not is_row(cells, layout):
            yield TextRow(line_number, cells, raw)
            position, line_number = following, line_number + 1
            continue
        run = _Run(text, layout, width or _width(text, layout, position, cells))
        behind = run.fill(position, line_number)
        if behind[0] == position:  # a row on its own, and none in the columns of a run
            yield TextRow(line_number, cells, raw)
            position, line_number = following, line_number + 1
            continue
        position, line_number = behind
        whole = run.whole()
        sign = layout.dialect.delimiter
        whole.written = whole.values.shape[1] if sign == " " else line.count(sign.encode()) + 1
        yield whole


def _line_at(data: bytes, position: int) -> tuple[bytes, int]:
    newline = data.find(b"\n", position)
    stop = len(data) if newline < 0 else newline
    line = data[position : min(stop, position + LONGEST_LINE + 1)]
    return line, stop + 1


def _width(text: Text, layout: Layout, position: int, first: list[str]) -> int:
    """Columns of a run: of its first row, or of wider rows below it where it ends in empty cells."""
    sign = layout.dialect.delimiter
    line, position = _line_at(text.data, position)
    if sign == " ":
        return len(first)
    written = line.count(sign.encode())
    widest = len(first)
    for _ in range(_AHEAD):
        if widest > written or position >= len(text.data):
            break
        line, position = _line_at(text.data, position)
        cells = layout.dialect.cells(text.decode(line))
        if line.count(sign.encode()) != written or not is_row(filled_up(cells, line, layout), layout):
            break
        widest = max(widest, len(cells))
    return widest


class _Run:
    """A run while it is read."""

    def __init__(self, text: Text, layout: Layout, width: int) -> None:
        self.text, self.layout, self.width = text, layout, width
        self.kinds = layout.kinds_for(width)
        self.parts: list[np.ndarray] = []
        self.numbers: list[np.ndarray] = []
        self.stamps: dict[int, list[bytes]] = {k: [] for k, kind in enumerate(self.kinds) if kind == STAMP}
        self.rows: list[list[float]] = []
        self.lines: list[int] = []
        self.short: list[int] = []
        self.filled = 0

    def fill(self, position: int, line_number: int) -> tuple[int, int]:
        """Read rows from a byte on; the byte and the line number behind them."""
        data, end = self.text.data, len(self.text.data)
        signs = self.layout.dialect
        compiled = end - position > LONG and signs.delimiter != signs.decimal
        patience = 50  # rows through Python before the compiled loop is tried again
        while position < end:
            if compiled and patience >= 50:
                block, position, spans = compiled_rows(data, position, self.layout.dialect, self.kinds)
                patience = 0
                if len(block):
                    self._flush()
                    self.parts.append(block)
                    self.numbers.append(np.arange(line_number, line_number + len(block)))
                    for stamps, places in zip(self.stamps.values(), spans, strict=True):
                        stamps += [data[a:b] for a, b in places.tolist()]
                    line_number += len(block)
                    self.filled += len(block)
                    continue
            line, following = _line_at(data, position)
            cells = self.layout.dialect.cells(self.text.decode(line))
            if not cells or len(cells) > self.width or len(line) > LONGEST_LINE or not self._take(cells, line):
                break
            self.lines.append(line_number)
            if len(cells) < self.width and self._cells_missing(line):
                self.short.append(line_number)
            position, line_number, patience = following, line_number + 1, patience + 1
        self._flush()
        return position, line_number

    def _take(self, cells: list[str], line: bytes) -> bool:
        padded = cells + [""] * (self.width - len(cells))
        numbers = numbers_of(padded, self.layout)
        if numbers is None:
            return False
        row = [np.nan if v is None or kind != NUMBER else v for v, kind in zip(numbers, self.kinds, strict=True)]
        for k, number in enumerate(numbers):
            if number is None and k not in self.stamps and self.kinds[k] != TEXT:
                self.stamps[k] = [b""] * (self.filled + len(self.rows))  # in a run whose columns nobody looked over
        for k, stamps in self.stamps.items():
            stamps.append(padded[k].encode("utf-8", errors="replace") if np.isnan(row[k]) else b"")
        self.rows.append(row)
        return True

    def _cells_missing(self, line: bytes) -> bool:
        sign = self.layout.dialect.delimiter
        return sign == " " or line.count(sign.encode()) < self.width - 1

    def _flush(self) -> None:
        if self.rows:
            self.parts.append(np.array(self.rows))
            self.numbers.append(np.array(self.lines))
            self.filled += len(self.rows)
            self.rows, self.lines = [], []

    def whole(self) -> NumberRun:
        values = self.parts[0] if len(self.parts) == 1 else np.concatenate(self.parts)
        lines = self.numbers[0] if len(self.numbers) == 1 else np.concatenate(self.numbers)
        for k, cells in self.stamps.items():
            seconds = seconds_of(cells).seconds
            values[:, k] = np.where(np.isnan(values[:, k]), seconds, values[:, k])
        words = tuple(k for k, kind in enumerate(self.kinds) if kind == TEXT)
        return NumberRun(values, lines, tuple(sorted(self.stamps)), self.short, words)


def compiled_rows(
    data: bytes, position: int, dialect: Dialect, kinds: tuple[int, ...]
) -> tuple[np.ndarray, int, list[np.ndarray]]:
    """Rows of plain numbers, text and stamps from a byte on.

    Returns
    -------
    values : (n, width) float
        Contiguous columns.
    position : int
        The byte where they end.
    spans : list of (n, 2) int
        Where each stamp stands, a column each.
    """
    from ssmr_ident.readers.text.fast_rows import parse_rows

    buffer = np.frombuffer(data, dtype=np.uint8)
    delimiter, decimal = ord(dialect.delimiter), ord(dialect.decimal)
    width, columns = len(kinds), np.array(kinds, dtype=np.int64)
    stamps = kinds.count(STAMP)
    if len(data) - position > VERY_LONG and not stamps:
        whole, end = _in_halves(buffer, data, position, delimiter, decimal, columns)
        if len(whole):
            return whole, end, []
    head = data[position : position + 65536]
    rows_per_byte = (head.count(b"\n") + 1) / max(len(head), 1)
    blocks, places = [], []
    while True:
        # a little more than the head promises, never more than two bytes per cell allow
        guess = int(min(1.05 * rows_per_byte, 1 / (2 * width)) * (len(data) - position)) + 16
        out, spans = np.empty((width, guess)), np.zeros((stamps, guess, 2), dtype=np.int64)
        count, position = parse_rows(buffer, position, delimiter, decimal, columns, out, spans)
        block = out[:, :count].T
        blocks.append(block if 2 * count > guess else block.copy(order="F"))
        places.append(spans[:, :count])
        if count < guess:
            whole = np.concatenate(blocks) if len(blocks) > 1 else blocks[0]
            return whole, position, list(np.concatenate(places, axis=1))


def _in_halves(
    buffer: np.ndarray, data: bytes, position: int, delimiter: int, decimal: int, kinds: np.ndarray
) -> tuple[np.ndarray, int]:
    """Both halves of a very long run at once; nothing when the first half is not plain rows throughout."""
    from ssmr_ident.readers.text.fast_rows import count_lines, parse_rows

    width = len(kinds)
    none = np.zeros((0, 0, 2), dtype=np.int64)
    middle = data.find(b"\n", (position + len(data)) // 2) + 1
    if not middle:
        return np.empty((0, width)), position
    first = count_lines(buffer[position:middle])
    rest = int(1.05 * first / (middle - position) * (len(data) - middle)) + 16  # what is beyond it comes later
    out = np.empty((width, first + rest))
    ends: list[tuple[int, int]] = []
    beside = threading.Thread(
        target=lambda: ends.append(parse_rows(buffer, middle, delimiter, decimal, kinds, out[:, first:], none))
    )
    beside.start()
    count, end = parse_rows(buffer[:middle], position, delimiter, decimal, kinds, out[:, :first], none)
    beside.join()
    if count < first or end < middle or not ends:
        return np.empty((0, width)), position
    return out[:, : first + ends[0][0]].T, ends[0][1]
