"""Worksheets of an .xlsx as rows of cells, by python-calamine; openpyxl is asked only what a wrong cell holds."""

from __future__ import annotations

import io
from dataclasses import dataclass
from typing import Any

from python_calamine import CalamineError, CalamineWorkbook, SheetTypeEnum, SheetVisibleEnum

from ssmr_ident.core.errors import InputError
from ssmr_ident.readers.source import Source
from ssmr_ident.readers.xlsx import zip_safety


@dataclass
class Sheet:
    """A worksheet.

    Parameters
    ----------
    name : str
    number : int
        From 1, worksheets only: chart sheets do not count.
    rows : list of list
        From A1 on; empty cells are ``''``.
    """

    name: str
    number: int
    rows: list[list[Any]]
    hidden: bool


def open_sheets(source: Source) -> list[Sheet]:
    """Worksheets in their order; notes about chart sheets and hidden ones.

    Raises
    ------
    InputError
        Damaged, unsafe, or no workbook.
    """
    parts = zip_safety.checked(source)
    book = _guarded(source, "", lambda: CalamineWorkbook.from_filelike(parts))
    sheets: list[Sheet] = []
    for index, entry in enumerate(book.sheets_metadata):
        if entry.typ != SheetTypeEnum.WorkSheet:
            source.inform(f"{entry.name} is no worksheet and does not count", entry.name)
            continue
        rows = _guarded(source, entry.name, lambda i=index: book.get_sheet_by_index(i).to_python(skip_empty_area=False))
        sheets.append(Sheet(entry.name, len(sheets) + 1, rows, entry.visible != SheetVisibleEnum.Visible))
    if not sheets:
        raise source.error("is a zip, but not a workbook with worksheets", "Give the .xlsx itself.")
    return sheets


def _guarded(source: Source, sheet: str, work: Any) -> Any:
    try:
        return work()
    except InputError:
        raise
    except (CalamineError, OSError, ValueError) as error:
        problem = f"sheet {sheet} is damaged ({error})" if sheet else f"workbook is damaged ({error})"
        raise source.error(problem, "Save it anew in Excel, or copy it again.") from error
    except BaseException as error:
        # A panic of the Rust parser arrives as a BaseException of its own; whatever else stays what it is
        if type(error).__name__ != "PanicException":
            raise
        raise source.error(
            f"{'sheet ' + sheet if sheet else 'workbook'} cannot be parsed", "Save it anew in Excel."
        ) from error


def letter(column: int) -> str:
    """Excel's name of a column from 0.

    >>> letter(0), letter(27)
    ('A', 'AB')
    """
    name = ""
    column += 1
    while column:
        column, rest = divmod(column - 1, 26)
        name = chr(65 + rest) + name
    return name


def what_is_in(source: Source, sheet: str, row: int, column: int) -> str:
    """What a cell that calamine gives as empty holds: an Excel error, a formula without value, or nothing.

    Parameters
    ----------
    row, column : int
        From 0.
    """
    import warnings

    import openpyxl

    address = f"{letter(column)}{row + 1}"
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")  # styles that openpyxl does not know have no bearing on a value
            cached = openpyxl.load_workbook(io.BytesIO(source.data), data_only=True)[sheet].cell(row + 1, column + 1)
            if isinstance(cached.value, str) and cached.value.startswith("#"):
                return f"Excel error {cached.value} in {address}"
            formula = openpyxl.load_workbook(io.BytesIO(source.data))[sheet].cell(row + 1, column + 1)
    except Exception:  # openpyxl fails in many ways on files that calamine reads; then the cell stays just empty
        return f"no number in {address}"
    if formula.data_type == "f" or (isinstance(formula.value, str) and formula.value.startswith("=")):
        return f"formula in {address} was never calculated"
    return f"blank cell {address}" if formula.value is None else f"{str(formula.value)[:40]!r} in {address}"
