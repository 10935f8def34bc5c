"""Is this zip a workbook, and is it safe to unpack? Asked before any library parses it.

A cell reference alone sets the size of the table that a parser lays out: one cell in XFD1048576 stands for
17 thousand million cells. So the corners of every sheet are found first, in the unpacked XML.
"""

from __future__ import annotations

import io
import re
import zipfile
import zlib

from ssmr_ident.readers.source import Source
from ssmr_ident.readers.xlsx.sheet_corner import corner_of

MAX_UNPACKED = 150 * 2**20  # bytes of XML; three axes of 20 s at 1 kHz are 4 MB
_ROW = re.compile(rb'<row r="(\d{1,9})"')
_CONTROLS = bytes(b if b >= 32 or b in b"\t\n\r" else 32 for b in range(256))  # no XML has others; some instruments do
_FAR = 10_000  # rows that may be blank between two others
_FAR_APART = 4  # times as many rows as there are before them
MAX_CELLS = 6_000_000  # cells of a sheet from A1 to its last corner; a parser holds about 50 bytes for each


def checked(source: Source) -> io.BytesIO:
    """The workbook's parts, unpacked and looked over, as a zip without compression.

    What was checked is what is parsed: a zip can show different readers different parts. It also saves unpacking
    everything twice.

    Raises
    ------
    InputError
        For zips that are no workbook, are damaged, or would not fit into memory.
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
    parts = io.BytesIO()
    seen: set[str] = set()
    with archive, zipfile.ZipFile(parts, "w", zipfile.ZIP_STORED) as repacked:
        for member in members:
            if not member.filename.lower().endswith((".xml", ".rels")):
                continue
            data = _unpack(source, archive, member, budget)
            budget -= len(data)
            if b"\0" in data[:64]:
                raise source.error(
                    f"workbook part {member.filename} is not UTF-8", "Save it anew in Excel.", member.filename
                )
            if b"<!DOCTYPE" in data or b"<!ENTITY" in data:
                raise source.error(
                    "holds a document type definition, which no workbook needs",
                    "Save it anew in Excel.",
                    member.filename,
                )
            if member.filename.endswith("workbook.xml.rels") and b"sharedStrings.xml" in data:
                _require_shared_strings(source, names)
            if "/worksheets/" in member.filename or b"<sheetData" in data[:65536]:
                data = _without_strays(source, member.filename, data)
                data = data.translate(_CONTROLS)
                data = data[: _checked_corner(source, member.filename, data)]
            if member.filename not in seen:
                seen.add(member.filename)
                repacked.writestr(zipfile.ZipInfo(member.filename), data)
    parts.seek(0)
    return parts


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


def _without_strays(source: Source, name: str, data: bytes) -> bytes:
    """A sheet without rows that stand alone far below the rest: a parser would lay out all the rows between."""
    row = _ROW.search(data, max(0, data.rfind(b"<row ")))
    if row is None or int(row[1]) < _FAR or data.count(b"<row ") * _FAR_APART > int(row[1]):
        return data
    before, end = 0, data.rfind(b"</sheetData>")
    for match in _ROW.finditer(data):
        if int(match[1]) - before > max(_FAR, _FAR_APART * before):
            source.warn(f"row(s) from {int(match[1])} on stand alone far below the rest and are left out", name)
            return data[: match.start()] + data[end:] if end > match.start() else data
        before = int(match[1])
    return data


def _checked_corner(source: Source, name: str, data: bytes) -> int:
    """Up to which byte a sheet may be parsed: whoever meets its sudden end calls it damaged, by its name."""
    try:
        rows, columns, sound = corner_of(data)
    except LookupError as error:
        raise source.error(f"workbook part {name} is not UTF-8", "Save it anew in Excel.", name) from error
    if rows * columns > MAX_CELLS:
        raise source.error(
            f"sheet reaches to row {rows}, column {columns}: {rows * columns:.3g} cells",
            "Delete stray cells far from the data.",
            name,
        )
    return sound
