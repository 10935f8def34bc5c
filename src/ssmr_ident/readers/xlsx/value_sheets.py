"""Sheets of values: a workbook in which a sheet holds time and all channels, as testing machines and loggers export.

A sheet's cells go the way of a text log's: what stands above the numbers is a header, a results table, a fact.
"""

from __future__ import annotations

from datetime import date, datetime, time, timedelta
from typing import Any

from ssmr_ident.core.errors import InputError
from ssmr_ident.core.recording import Note, Recording
from ssmr_ident.readers.options import ReadOptions
from ssmr_ident.readers.source import Source
from ssmr_ident.readers.table.headings import split_header
from ssmr_ident.readers.text.delimited import recordings_of_text
from ssmr_ident.readers.text.encoding import Text
from ssmr_ident.readers.xlsx.sheet_axes import is_filled
from ssmr_ident.readers.xlsx.workbook import Sheet, letter, what_is_in

_HEAD = 60  # rows that are looked at for a header
_ASKED = 5  # cells that openpyxl is asked about


def value_sheets(source: Source, sheets: list[Sheet], options: ReadOptions) -> list[Sheet]:
    """Sheets that hold a table of more than time and one voltage; none when the workbook holds an axis a sheet."""
    if set(options.sheets) == {"data"}:
        return [_chosen(source, sheets, options.sheets["data"])]
    if options.sheets:
        return []
    filled = [sheet for sheet in sheets if is_filled(sheet)]
    wide = [sheet for sheet in filled if _is_wide(source, sheet)]
    return [] if any(_is_pair(sheet) for sheet in filled if sheet not in wide) else wide


def _chosen(source: Source, sheets: list[Sheet], which: int | str) -> Sheet:
    for sheet in sheets:
        if str(which) in (sheet.name, str(sheet.number)):
            return sheet
    raise source.error(f"has no sheet {which!r}", f"Sheets: {', '.join(s.name for s in sheets)}.")


def _is_wide(source: Source, sheet: Sheet) -> bool:
    widths = [sum(cell != "" for cell in row) for row in sheet.rows[-3:]]
    words = [cell for row in sheet.rows[:_HEAD] for cell in row if isinstance(cell, str) and cell]
    units = [source.vocabulary.unit(word) for word in words]
    united = any(unit is not None and unit.unit not in ("s", "V") for unit in units) or any(
        unit and source.vocabulary.unit(unit) for _, unit in (split_header(word, source.vocabulary) for word in words)
    )
    return bool(widths) and (max(widths) > 2 or (united and max(widths) == 2))


def _is_pair(sheet: Sheet) -> bool:
    """Two columns of numbers: time and volts of one axis."""
    rows = [[c for c in row if c != ""] for row in sheet.rows[-20:]]
    pairs = [row for row in rows if len(row) == 2 and all(isinstance(c, (int, float, date)) for c in row)]
    return len(pairs) > len(rows) / 2


def read_values(source: Source, sheets: list[Sheet], wide: list[Sheet], options: ReadOptions) -> list[Recording]:
    """Recordings of the sheets of values; the others are named as left out.

    Raises
    ------
    InputError
        No sheet can be read; the error is of the one with most rows.
    """
    found: dict[str, list[Recording]] = {}
    errors: dict[str, InputError] = {}
    for sheet in wide:
        own = Source(source.path, source.data, source.kind, source.digest, list(source.notes))
        try:
            found[sheet.name] = _recordings(own, sheet, options)
        except InputError as error:
            errors[sheet.name] = error
    if not found:
        largest = max((s for s in wide if s.name in errors), key=lambda s: len(s.rows))
        raise errors[largest.name]
    asked = [e for name, e in errors.items() if "unit" in e.problem]
    if asked:
        raise asked[0]
    left = [sheet.name for sheet in sheets if sheet.name not in found]
    note = Note("info", f"sheet(s) that are no log left out: {', '.join(left)}") if left else None
    return [
        recording.with_channels(recording.channels, *([note] if note else []))
        for recordings in found.values()
        for recording in recordings
    ]


def _recordings(source: Source, sheet: Sheet, options: ReadOptions) -> list[Recording]:
    rows = sheet.rows
    while rows and not any(cell != "" for cell in rows[-1]):
        rows = rows[:-1]
    _refuse_uncalculated(source, sheet, rows)
    lines = ["\t".join(map(_printed, row)) for row in rows]
    text = Text(("\n".join(lines) + "\n").encode(), "utf-8")
    places = f"sheet {sheet.name}"

    def place(line: int) -> str:
        return f"{sheet.name}, row {line}"

    return recordings_of_text(source, text, options, "labview-xlsx", place, places, delimiters="\t")


def _refuse_uncalculated(source: Source, sheet: Sheet, rows: list[list[Any]]) -> None:
    """Formulas that were saved without their values are blank cells to every reader but the one that asks."""
    asked = 0
    for index in range(len(rows) - 1, max(0, len(rows) - 3), -1):
        numbers = [isinstance(cell, (int, float)) for cell in rows[index]]
        for column, cell in enumerate(rows[index]):
            if cell == "" and any(numbers) and asked < _ASKED:
                asked += 1
                held = what_is_in(source, sheet.name, index, column)
                if "never calculated" in held:
                    raise source.error(
                        f"formulas were never calculated ({held})",
                        "Open the workbook in Excel and save it.",
                        f"{sheet.name}:{letter(column)}{index + 1}",
                    )


def _printed(cell: Any) -> str:
    """A cell as a text log would have it: the very double, a stamp with all its digits, words in one line."""
    if isinstance(cell, float):
        return repr(cell)
    if isinstance(cell, datetime):
        return cell.isoformat(sep=" ", timespec="microseconds")
    if isinstance(cell, (date, time)):
        return cell.isoformat() if isinstance(cell, date) else cell.isoformat(timespec="microseconds")
    if isinstance(cell, timedelta):
        return repr(cell.total_seconds())
    return " ".join(str(cell).split())
