"""A log that was being written when the power went: its last line may end in the middle of a number.

``39.189`` cut to ``39.1`` is still a number, and no reader sees it. A last line without line end is therefore kept only
when its last number is printed like those above it (as many decimals, as many digits of exponent); otherwise it goes,
with a warning. At most one sample is lost that way.
"""

from __future__ import annotations

import re

from ssmr_ident.readers.source import Source
from ssmr_ident.readers.text.encoding import Text

_LINES_ABOVE = 20
_SHAPE = re.compile(r'"?[+-]?\d*(?:[.,](\d*))?(?:[eEdD][+-]?(\d+))?"?\Z', re.ASCII)


def without_cut_line(source: Source, text: Text, delimiter: str) -> Text:
    """The text without a last line that may be cut.

    Parameters
    ----------
    delimiter : str
        As in ``Dialect``.
    """
    data = text.data
    if not data or data.endswith((b"\n", b"\r")):
        return text
    begin = data.rfind(b"\n") + 1
    above = data[max(0, begin - 200 * _LINES_ABOVE) : begin].split(b"\n")[-_LINES_ABOVE - 1 : -1]
    last = _cells(text.decode(data[begin : begin + 100_000]), delimiter)
    rows = [cells for cells in (_cells(text.decode(line), delimiter) for line in above) if cells]
    # only lines of numbers: a log may well end in words
    numbers = [cells for cells in rows if _shape(cells[-1]) is not None and len(cells) == len(rows[-1])]
    if not numbers or not last or not rows or rows[-1] is not numbers[-1]:
        return text
    shapes = {_shape(cells[-1]) for cells in numbers[-_LINES_ABOVE:]}
    whole = len(last) == len(numbers[-1]) and shapes == {_shape(last[-1])} and _shape(last[-1]) != ("", "")
    if whole:
        return text
    line = data.count(b"\n") + 1
    source.warn("no line end at the end of the file: the last row is cut off and was dropped", f"line {line}")
    return Text(data[:begin], text.encoding)


def _cells(line: str, delimiter: str) -> list[str]:
    cells = line.strip().split() if delimiter == " " else [cell.strip() for cell in line.rstrip().split(delimiter)]
    while cells and not cells[-1]:
        cells.pop()
    return cells


def _shape(token: str) -> tuple[str, str] | None:
    """Decimals and exponent of a printed number as counts; None for text."""
    match = _SHAPE.match(token)
    if not match or not any(c.isdigit() for c in token):
        return None
    decimals, exponent = match[1], match[2]
    return ("" if not decimals else str(len(decimals)), "" if not exponent else str(len(exponent)))
