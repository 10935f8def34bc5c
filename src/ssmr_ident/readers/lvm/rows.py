"""Rows of an .lvm segment: numbers, empty cells, a comment behind them, and what a power loss leaves."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np

from ssmr_ident.core.recording import Note
from ssmr_ident.readers.lvm.header import MAGIC, Lines, is_segment_start
from ssmr_ident.readers.options import ReadOptions
from ssmr_ident.readers.source import Source
from ssmr_ident.readers.text.dialect import NUMBER, value_of
from ssmr_ident.readers.text.numbers import Dialect
from ssmr_ident.readers.text.numeric_run import LONG, compiled_rows


@dataclass
class Rows:
    """Values (n, m) float with NaN for empty cells, and the line number of each row, (n,) int."""

    values: np.ndarray
    lines: np.ndarray
    notes: list[Note] = field(default_factory=list)


def read_rows(source: Source, lines: Lines, decimal: str, width: int | None, options: ReadOptions) -> Rows:
    """Rows up to the next header or the end; leaves ``lines`` there.

    Parameters
    ----------
    width : int or None
        Count of columns without the comment; None takes that of the first row.

    Raises
    ------
    InputError
        Too many cells, or text where a number belongs.
    """
    parts: list[np.ndarray] = []
    numbers: list[np.ndarray] = []
    pending: list[list[float]] = []
    pending_lines: list[int] = []
    notes: list[Note] = []
    comments = 0
    dialect = Dialect(lines.dialect.delimiter, decimal)

    def flush() -> None:
        if pending:
            parts.append(np.array(pending))
            numbers.append(np.array(pending_lines))
            pending.clear()
            pending_lines.clear()

    while not lines.ended:
        if width is not None and not len(pending) % 50 and len(lines.text.data) - lines.position > LONG:
            kinds = (NUMBER,) * width
            block, lines.position, _ = compiled_rows(lines.text.data, lines.position, dialect, kinds)
            if len(block):
                flush()
                parts.append(block)
                numbers.append(np.arange(lines.number, lines.number + len(block)))
                lines.number += len(block)
                if lines.ended:
                    break
        line, _ = lines.peek()
        cells = [cell.strip().strip('"') for cell in line.split(dialect.delimiter)]
        while cells and not cells[-1]:
            cells.pop()
        if not cells or line.startswith(MAGIC) or is_segment_start(cells):
            if cells or _segment_follows(lines):
                break
            lines.take()
            continue
        number_of_line = lines.number
        lines.take()
        width = width or len(cells)
        if len(cells) > width + 1:
            raise source.error(
                f"row has {len(cells)} cells, {width} are expected", "Mend the row.", f"line {number_of_line}"
            )
        if len(cells) == width + 1:
            comments += 1
            notes.append(
                Note("info", f"comment: {cells[-1].replace(chr(92) + '09', ' ')[:100]}", f"line {number_of_line}")
            )
        values = _values(source, cells, width, decimal, number_of_line, options, notes)
        if values is None:
            continue
        pending.append(values)
        pending_lines.append(number_of_line)
    flush()
    if not parts:
        return Rows(np.empty((0, width or 1)), np.empty(0, dtype=int), notes)
    return Rows(_joined(parts), _joined(numbers), notes if comments < 20 else notes[:20])


def _joined(parts: list[np.ndarray]) -> np.ndarray:
    return parts[0] if len(parts) == 1 else np.concatenate(parts)


def _segment_follows(lines: Lines) -> bool:
    """After a blank row: True when the next filled row begins a header, so that the segment has ended."""
    saved = lines.position, lines.number
    lines.skip_blank()
    line = "" if lines.ended else lines.peek()[0]
    starts = lines.ended or line.startswith(MAGIC) or is_segment_start(lines.dialect.cells(line))
    lines.position, lines.number = saved
    return starts


def _values(
    source: Source, cells: list[str], width: int, decimal: str, line: int, options: ReadOptions, notes: list[Note]
) -> list[float] | None:
    values = [np.nan] * width
    for index, cell in enumerate(cells[:width]):
        if not cell:
            continue
        value = value_of(cell, decimal)
        if value is None:
            if options.on_bad != "nan":
                raise source.error(
                    f"{cell[:40]!r} where a number belongs",
                    "Take it as missing with --on-bad nan.",
                    f"line {line}",
                )
            notes.append(Note("warning", f"{cell[:40]!r} taken as missing", f"line {line}"))
            continue
        values[index] = value
    return values
