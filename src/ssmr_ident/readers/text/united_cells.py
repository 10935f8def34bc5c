"""Cells that bear their units, as dashboards, MATLAB's timetables and sketches print: ``1.52 N``, ``0.005 sec``."""

from __future__ import annotations

import re
from collections import Counter

from ssmr_ident.readers.source import Source
from ssmr_ident.readers.text.encoding import Text

_MOST = 0.6  # share of the rows that must have the form
_UNITED = re.compile(
    r'"?([-+]?(?:\d+(?:[.,]\d*)?|[.,]\d+)(?:[eE][-+]?\d{1,3})?)[ \u00a0]?([^\W\d_][^\s\d,;|"]{0,9}\d?|[°%][CF]?)"?\Z'
)


def without_units(source: Source, text: Text, sample: list[str]) -> Text:
    """Cells that bear their unit, ``1.52 N``, as plain numbers below a header that says it."""
    rows = [line for line in sample if any(c.isdigit() for c in line)]
    if not rows or not any(c.isalpha() for c in rows[-1]):
        return text
    for sign in "\t;,|":
        cells = [line.rstrip().split(sign) for line in rows]
        width = Counter(map(len, cells)).most_common(1)[0][0]
        alike = [row for row in cells if len(row) == width]
        if (width < 2 and sign != "|") or len(alike) < max(3, _MOST * len(rows)):
            continue
        units = [_unit_of(source, [row[k].strip() for row in alike]) for k in range(width)]
        if any(units):
            return _rewritten(source, text, sign, units)
    return text


def _unit_of(source: Source, cells: list[str]) -> str:
    """The unit behind most of the numbers of a column; empty for none."""
    found = Counter(match[2] for cell in cells if (match := _UNITED.match(cell)))
    unit, count = found.most_common(1)[0] if found else ("", 0)
    known = unit and source.vocabulary.unit(unit) is not None
    return unit if known and count >= max(3, _MOST * len(cells)) else ""


def _rewritten(source: Source, text: Text, sign: str, units: list[str]) -> Text:
    made: list[str] = []
    begun = False
    for raw in text.data.split(b"\n"):
        line = text.decode(raw)
        cells = line.rstrip().split(sign)
        numbers = [_UNITED.match(cell.strip()) for cell in cells]
        row = len(cells) == len(units) and all(
            not unit or (match is not None and match[2] == unit) for unit, match in zip(units, numbers, strict=True)
        )
        if not row:
            made.append(line)
            continue
        if not begun:
            begun = True
            _say_units(made, sign, units)
        plain = [match[1] if unit and match else cell for unit, match, cell in zip(units, numbers, cells, strict=True)]
        made.append(sign.join(plain))
    source.inform(f"cells bear their units: {', '.join(unit for unit in units if unit)}")
    return Text("\n".join(made).encode(), "utf-8")


def _say_units(above: list[str], sign: str, units: list[str]) -> None:
    """Units put behind the names of the line above; where there are no names, a line of numbers with units."""
    names = above[-1].split(sign) if above else []
    if len(names) == len(units) and not any(name.strip()[:1].isdigit() for name in names):
        pairs = zip(names, units, strict=True)
        above[-1] = sign.join(f"{name.strip().strip(chr(34))} [{unit}]" if unit else name for name, unit in pairs)
    else:
        above.append(sign.join(f"column {k} [{unit}]" if unit else "" for k, unit in enumerate(units, start=1)))
