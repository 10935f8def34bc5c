"""Is this zip a workbook, and is it safe to unpack? Asked before any library parses it.

A cell reference alone sets the size of the table that a parser lays out: one cell in XFD1048576 stands for
17 thousand million cells. So the corners of every sheet are found first, in the unpacked XML.
"""

from __future__ import annotations

import contextlib
import io
import re
import zipfile
import zlib
from xml.parsers import expat

import numpy as np

from ssmr_ident.readers.source import Source

MAX_UNPACKED = 200 * 2**20  # bytes of XML; three axes of a million rows are 150 MB
MAX_CELLS = 6_000_000  # cells of a sheet from A1 to its last corner; a parser holds about 50 bytes for each


def check(source: Source) -> None:
    """Raise for zips that are no workbook, are damaged, or would not fit into memory.

    Raises
    ------
    InputError
    """
    try:
        archive = zipfile.ZipFile(io.BytesIO(source.data))
        members = archive.infolist()
    except (zipfile.BadZipFile, ValueError, NotImplementedError, OverflowError, EOFError, OSError) as error:
        raise source.error(
            "workbook is damaged or incompletely copied (zip directory missing)", "Copy it again."
        ) from error
    names = {member.filename for member in members}
    if not any(name.endswith("workbook.xml") for name in names):
        if any(name.endswith("workbook.bin") for name in names):
            raise source.error("is a binary workbook (.xlsb)", "Save it as .xlsx.")
        raise source.error("is a zip, but not a workbook (no workbook.xml)", "Give the .xlsx itself.")
    if sum(member.file_size for member in members) > MAX_UNPACKED:
        raise source.error(f"unpacks to more than {MAX_UNPACKED // 2**20} MB", "Split the recording.")
    budget = MAX_UNPACKED
    for member in members:
        if not member.filename.lower().endswith((".xml", ".rels")):
            continue
        data = _unpack(source, archive, member, budget)
        budget -= len(data)
        if b"<!DOCTYPE" in data or b"<!ENTITY" in data:
            raise source.error(
                "holds a document type definition, which no workbook needs",
                "Save it anew in Excel.",
                member.filename,
            )
        if member.filename.endswith("workbook.xml.rels") and b"sharedStrings.xml" in data:
            _require_shared_strings(source, names)
        if "/worksheets/" in member.filename or b"<sheetData" in data[:65536]:
            _check_corner(source, member.filename, data)


def _unpack(source: Source, archive: zipfile.ZipFile, member: zipfile.ZipInfo, budget: int) -> bytes:
    try:
        with archive.open(member) as stream:
            data = stream.read(budget + 1)
    except (
        zipfile.BadZipFile,
        zlib.error,
        EOFError,
        RuntimeError,
        NotImplementedError,
        ValueError,
        OSError,
    ) as error:
        raise source.error(f"workbook part {member.filename} is damaged", "Copy the workbook again.") from error
    if len(data) > budget:
        raise source.error(f"unpacks to more than {MAX_UNPACKED // 2**20} MB", "Split the recording.")
    return data


def _require_shared_strings(source: Source, names: set[str]) -> None:
    if not any(name.lower().endswith("sharedstrings.xml") for name in names):
        raise source.error("workbook part sharedStrings.xml missing", "Save the workbook anew in Excel.")


def _check_corner(source: Source, name: str, data: bytes) -> None:
    corner = _quick_corner(data)
    if corner is None or corner[0] * corner[1] > MAX_CELLS:
        corner = _exact_corner(data)
    rows, columns = corner
    if rows * columns > MAX_CELLS:
        raise source.error(
            f"sheet reaches to row {rows}, column {columns}: {rows * columns:.3g} cells",
            "Delete stray cells far from the data.",
            name,
        )


def _quick_corner(data: bytes) -> tuple[int, int] | None:
    """An upper bound of rows and columns, or None when references are written in an unusual way.

    Every cell and row must carry ``r="..."``; columns are bounded by the letters, rows by the count of digits.
    """
    if b"r='" in data or b"r =" in data or b":c " in data[:4096] or b'r= "' in data:
        return None
    text = np.frombuffer(data, dtype=np.uint8)
    if text.size < 16:
        return 0, 0
    at = np.flatnonzero((text[:-12] == 0x72) & (text[1:-11] == 0x3D) & (text[2:-10] == 0x22)) + 3
    if len(at) < data.count(b"<c ") + data.count(b"<row ") or b"<c>" in data or b"<row>" in data:
        return None
    first, second = text[at], text[at + 1]
    is_cell = (first >= 65) & (first <= 90)
    if not is_cell.any():
        return (0, 0) if not len(at) else None
    if ((second >= 65) & (second <= 90) & is_cell).any():
        return None
    columns = int(first[is_cell].max()) - 64
    cells = at[is_cell] + 1
    digits = np.zeros(len(cells), dtype=np.int64)
    open_ = np.ones(len(cells), dtype=bool)
    for step in range(8):
        where = np.minimum(cells + step, text.size - 1)
        open_ &= (text[where] >= 48) & (text[where] <= 57)
        digits += open_
    return 10 ** int(digits.max()) - 1, columns


_REFERENCE = re.compile(r"([A-Za-z]{1,3})(\d{1,9})")


def _exact_corner(data: bytes) -> tuple[int, int]:
    """Last row and column of any cell, by a streaming parse."""
    rows = columns = row = column = 0

    def start(name: str, attributes: dict[str, str]) -> None:
        nonlocal rows, columns, row, column
        local = name.rsplit(":", 1)[-1]
        if local == "row":
            row = int(attributes["r"]) if attributes.get("r", "").isdigit() else row + 1
            column = 0
        elif local == "c":
            match = _REFERENCE.fullmatch(attributes.get("r", ""))
            if match:
                column = 0
                for letter in match[1].upper():
                    column = column * 26 + ord(letter) - 64
                row = int(match[2])
            else:
                column += 1
            rows, columns = max(rows, row), max(columns, column)

    parser = expat.ParserCreate()
    parser.StartElementHandler = start
    # a damaged sheet is reported with its name by whoever parses it; the corner so far bounds it
    with contextlib.suppress(expat.ExpatError):
        parser.Parse(data, True)
    return rows, columns
