"""The last row and column of a worksheet, from its XML: how large a table a parser will lay out."""

from __future__ import annotations

import re
from xml.parsers import expat

import numpy as np

LONG = 200_000  # bytes from which on compiling pays
_REFERENCE = re.compile(r"([A-Za-z]+)([0-9]+)")
_DIGITS, _LETTERS = 18, 9  # of a place that is read at all: as many stand for a sheet that is too large


def corner_of(data: bytes) -> tuple[int, int, int]:
    """Last row and column of any cell, and up to which byte a sheet is XML at all.

    Parameters
    ----------
    data : bytes
        XML of a worksheet.

    Returns
    -------
    rows, columns : int
    sound : int
        Of what follows, nobody can foresee which places a lenient parser takes out of it.

    Raises
    ------
    LookupError
        For an encoding that is not known.
    """
    if len(data) > LONG:
        from ssmr_ident.readers.xlsx.sheet_scan import scan  # only long sheets are worth waiting for the compiler

        plain, rows, columns = scan(np.frombuffer(data, dtype=np.uint8))
        if plain:
            return rows, columns, len(data)
    return _parse(data)


def _parse(data: bytes) -> tuple[int, int, int]:
    rows = columns = row = column = 0

    def start(name: str, attributes: dict[str, str]) -> None:
        nonlocal rows, columns, row, column
        local = name.rsplit(":", 1)[-1]
        if local == "row":
            row = int(attributes["r"][:_DIGITS]) if re.fullmatch(r"[0-9]+", attributes.get("r", "")) else row + 1
            column = 0
        elif local == "c":
            match = _REFERENCE.fullmatch(attributes.get("r", ""))
            if match:
                column, row = _column(match[1][:_LETTERS]), int(match[2][:_DIGITS])
            else:
                column += 1
            rows, columns = max(rows, row), max(columns, column)

    parser = expat.ParserCreate()
    parser.StartElementHandler = start
    try:
        parser.Parse(data, True)
    except expat.ExpatError:
        return rows, columns, parser.ErrorByteIndex
    return rows, columns, len(data)


def _column(letters: str) -> int:
    number = 0
    for letter in letters.upper():
        number = number * 26 + ord(letter) - 64
    return number
