"""The numbers of one worksheet: where the data begin, what stands above them, and what is wrong among them.

``xlsread`` (the thesis) takes the bounding box of the numeric cells and keeps its rows ``11:end``. Two headers
give a box of which ten rows are passed over: an LVM segment header, whose ten rows begin at ``Channels 1`` (H1,
nothing is lost), or none at all, so that ten samples are lost (H2). With ``skip="auto"`` the rows tell: rows of
numbers that lie on the time grid of the rest are samples.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, field
from datetime import UTC, date, datetime, time, timedelta
from itertools import chain
from typing import Any

import numpy as np

from ssmr_ident.core.recording import Note
from ssmr_ident.readers.options import ReadOptions
from ssmr_ident.readers.source import Source
from ssmr_ident.readers.table.headings import quantity_of, split_header
from ssmr_ident.readers.text.numbers import evidence_for_decimal, number
from ssmr_ident.readers.xlsx.workbook import Sheet, letter, what_is_in

_THESIS_SKIP = 10


@dataclass
class SheetNumbers:
    """Values (n, m) float of one sheet; ``rows`` (n,) are Excel's row numbers, ``labels`` the headers."""

    values: np.ndarray
    rows: np.ndarray
    labels: list[str]
    dated: bool = False
    first_column: int = 0
    notes: list[Note] = field(default_factory=list)


def _is_number(cell: Any) -> bool:
    return isinstance(cell, (int, float)) and not isinstance(cell, bool)


def _is_stamp(cell: Any) -> bool:
    return _is_number(cell) or isinstance(cell, (date, time, timedelta))


def numbers_of(source: Source, sheet: Sheet, what: str, options: ReadOptions) -> SheetNumbers:
    """The data of a sheet.

    Parameters
    ----------
    what : str
        What the sheet stands for, for messages (``axis z``).

    Raises
    ------
    InputError
        No numbers, no data below the header, text, errors or blanks among the data.
    """
    rows = sheet.rows
    notes: list[Note] = []
    begin = _first_data_row(rows)
    if begin is None:
        converted = _from_text(rows, sheet, options, notes)
        if converted is not None:
            rows = converted
            begin = _first_data_row(rows)
    if begin is None:
        raise _no_numbers(source, sheet, what, rows)
    block = _block_begin(rows, begin)
    columns = [index for index, cell in enumerate(rows[begin]) if _is_stamp(cell)]
    begin = _skip(source, sheet, rows, block, begin, columns, options, notes)
    labels = _labels(rows, begin, columns)
    values, kept, dated = _values(source, sheet, rows, begin, columns, options, notes)
    return SheetNumbers(values, kept, labels, dated, columns[0], notes)


def _first_data_row(rows: list[list[Any]]) -> int | None:
    """First of two rows in a row that hold numbers (or a date and numbers) and no text."""
    previous = False
    for index, row in enumerate(rows):
        filled = [cell for cell in row if cell != ""]
        good = bool(filled) and all(map(_is_stamp, filled)) and any(map(_is_number, filled))
        if good and previous:
            return index - 1
        previous = good
    return None


def _block_begin(rows: list[list[Any]], begin: int) -> int:
    """Top of the box of numeric cells, which ``xlsread`` returns."""
    return next((i for i, row in enumerate(rows[:begin]) if any(map(_is_number, row))), begin)


def _skip(
    source: Source,
    sheet: Sheet,
    rows: list[list[Any]],
    block: int,
    begin: int,
    columns: list[int],
    options: ReadOptions,
    notes: list[Note],
) -> int:
    above = begin - block
    box = len(rows) - block
    if box <= _THESIS_SKIP and options.skip == "auto":
        raise source.error(
            f"only {box} numeric rows; 11:end would be empty",
            "Export the whole recording, or give --skip 0.",
            sheet.name,
        )
    if options.skip == "auto":
        how = (
            f"{above} header rows in the block of numbers passed over (LVM segment header)"
            if above
            else "block of numbers holds samples from its first row on, none passed over"
        )
    else:
        begin = max(block + int(options.skip), begin)
        how = f"{options.skip} rows of the block of numbers passed over, as --skip says"
        if begin >= len(rows):
            raise source.error(
                f"only {box} numeric rows; --skip {options.skip} leaves none", "Give a smaller --skip.", sheet.name
            )
    first = rows[begin][columns[0]]
    shown = f"t = {first:g} s" if _is_number(first) and len(columns) > 1 else f"{first}"
    notes.append(Note("info", f"{how}; first sample is row {begin + 1}, {shown}", sheet.name))
    return begin


def _labels(rows: list[list[Any]], begin: int, columns: list[int]) -> list[str]:
    """Texts of the nearest row above the data that has one over a data column."""
    for row in reversed(rows[max(0, begin - 3) : begin]):
        cells = [
            str(row[index]).strip() if index < len(row) and isinstance(row[index], str) else "" for index in columns
        ]
        if any(cells) and not cells[0].startswith("***"):
            return cells
    return [""] * len(columns)


def _values(
    source: Source,
    sheet: Sheet,
    rows: list[list[Any]],
    begin: int,
    columns: list[int],
    options: ReadOptions,
    notes: list[Note],
) -> tuple[np.ndarray, np.ndarray, bool]:
    body = rows[begin:]
    if len(columns) != len(body[0]):
        low, high = columns[0], columns[-1] + 1
        outside = {cell for row in body for cell in row[:low] + row[high:] if cell != ""}
        if outside:
            notes.append(Note("warning", f"{len(outside)} filled cell(s) beside the data not read", sheet.name))
        body = [row[low:high] for row in body]
        columns = list(range(low, high))
    types = set(map(type, chain.from_iterable(body)))
    if types <= {float, int}:
        values = np.fromiter(chain.from_iterable(body), dtype=float).reshape(len(body), -1)  # half of np.array's time
        if not np.isfinite(values).all():  # a literal NaN in a numeric cell, which Excel never writes
            return _mixed(source, sheet, body, begin, columns, options, notes)
        return values, np.arange(begin + 1, begin + 1 + len(body)), False
    return _mixed(source, sheet, body, begin, columns, options, notes)


def _mixed(
    source: Source,
    sheet: Sheet,
    body: list[list[Any]],
    begin: int,
    columns: list[int],
    options: ReadOptions,
    notes: list[Note],
) -> tuple[np.ndarray, np.ndarray, bool]:
    """Rows with cells that are no plain numbers: dates, blanks, text, Excel errors."""
    while body and not any(map(_is_stamp, body[-1])):
        last = body.pop()
        if any(cell != "" for cell in last):
            notes.append(
                Note(
                    "warning",
                    f"text below the data not read: {_shown(last)}",
                    f"{sheet.name}, row {begin + len(body) + 1}",
                )
            )
    values = []
    kept = []
    dated = False
    asked = 0
    for offset, row in enumerate(body):
        index = begin + offset
        line = []
        for position, cell in enumerate(row):
            if _is_number(cell) and math.isfinite(cell):
                line.append(float(cell))
                continue
            if position == 0 and isinstance(cell, (date, time, timedelta)):
                line.append(_seconds(cell))
                dated = True
                continue
            place = f"{sheet.name}:{letter(columns[position])}{index + 1}"
            if cell == "":
                problem = what_is_in(source, sheet.name, index, columns[position]) if asked < 5 else "empty cell"
                asked += 1
                stamp = row[0] if _is_number(row[0]) and position else None
                where = f" (1 gap at t = {stamp:g} s)" if stamp is not None else ""
            elif _is_number(cell):
                problem, where = f"{cell} in a numeric cell", ""
            else:
                problem, where = f"text {str(cell)[:40]!r} inside the data", ""
            if options.on_bad != "nan":
                mend = (
                    "Open the workbook in Excel and save it, so that formulas get their values."
                    if "never calculated" in problem
                    else "Mend the cell, or keep a gap with --on-bad nan."
                )
                raise source.error(f"{problem}{where}", mend, place)
            notes.append(Note("warning", f"{problem}{where}; taken as missing", place))
            line.append(np.nan)
        if np.isnan(line[0]) and len(columns) > 1:
            notes.append(Note("warning", "row without time dropped", f"{sheet.name}, row {index + 1}"))
            continue
        values.append(line)
        kept.append(index + 1)
    return np.array(values, dtype=float).reshape(len(values), len(columns)), np.array(kept, dtype=int), dated


def _seconds(cell: date | time | timedelta) -> float:
    if isinstance(cell, date):  # midnight to the millisecond arrives as a bare date
        moment = cell if isinstance(cell, datetime) else datetime(cell.year, cell.month, cell.day)
        return moment.replace(tzinfo=UTC).timestamp()
    if isinstance(cell, time):
        return cell.hour * 3600 + cell.minute * 60 + cell.second + cell.microsecond * 1e-6
    return float(cell.total_seconds())


def _from_text(rows: list[list[Any]], sheet: Sheet, options: ReadOptions, notes: list[Note]) -> list[list[Any]] | None:
    """Rows whose numbers were stored as text (a decimal comma that Excel did not know), as numbers."""
    texts = [cell for row in rows for cell in row if isinstance(cell, str) and cell[:1] in "+-0123456789" and cell]
    votes = {evidence_for_decimal(text) for text in texts if text.strip("+-0123456789.,eE") == ""} - {""}
    if len(votes) != 1 and options.decimal is None:
        return None
    decimal = options.decimal or votes.pop()
    converted = []
    count = 0
    for row in rows:
        line: list[Any] = []
        for cell in row:
            if isinstance(cell, str) and cell:
                try:
                    cell = number(cell.strip(), decimal)
                    count += 1
                except ValueError:
                    pass
            line.append(cell)
        converted.append(line)
    if count:
        notes.append(
            Note(
                "warning",
                f"{count} numbers are stored as text, with decimal "
                f"{'comma' if decimal == ',' else 'point'}; read as numbers",
                sheet.name,
            )
        )
    return converted if count else None


def _no_numbers(source: Source, sheet: Sheet, what: str, rows: list[list[Any]]) -> Exception:
    if not any(cell != "" for row in rows for cell in row):
        return source.error(f"sheet {sheet.name} ({what}) has no numbers: it is empty", "Export that axis again.")
    header = next(row for row in rows if any(cell != "" for cell in row))
    named = any(quantity_of(*split_header(str(cell))) == "time" for cell in header if cell)
    filled = sum(any(cell != "" for cell in row) for row in rows)
    if named or filled < 3:
        return source.error(f"sheet {sheet.name} ({what}): no data below the header", "Export that axis again.")
    return source.error(f"sheet {sheet.name} ({what}) has no numbers", "Export that axis again.")


def _shown(row: list[Any]) -> str:
    return " ".join(str(cell) for cell in row if cell != "")[:60]
