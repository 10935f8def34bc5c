"""What a column's header says: its label without the unit, the unit, and the quantity in this package's words."""

from __future__ import annotations

import re

from ssmr_ident.core.units import QUANTITY_OF_UNIT, find_unit

_WORDS = {
    "time": "time zeit prüfzeit godzina czas tiempo temps elapsed timestamp x_value tempo t",
    "force": "load force kraft standardkraft prüfkraft obciążenie siła charge carga fuerza",
    "position": "position posn pos extension displacement crosshead stroke travel weg standardweg traverse "
    "traversenweg przemieszczenie déplacement deplacement desplazamiento verformung",
    "strain": "strain dehnung odkształcenie",
    "stress": "stress spannung naprężenie",
    "torque": "torque moment drehmoment",
    "acceleration": "acceleration accel beschleunigung",
    "velocity": "velocity speed geschwindigkeit",
    "angle": "angle winkel",
    "angular_rate": "angular_rate gyro",
}
_QUANTITY = {word: quantity for quantity, words in _WORDS.items() for word in words.split()}
_AXES = {"ax", "ay", "az", "wx", "wy", "wz"}
# A letter names a quantity only when the unit agrees
_SYMBOLS = {
    "f": "force",
    "x": "position",
    "s": "position",
    "a": "acceleration",
    "v": "velocity",
    "t": "time",
    "p": "force",
}
_MODIFIERS = {
    "axial",
    "running",
    "elapsed",
    "total",
    "measured",
    "test",
    "abs",
    "channel",
    "ch",
    "standard",
    "the",
}
_BRACKETED = re.compile(r"^(.*?)\s*[(\[{]\s*([^()\[\]{}]*)\s*[)\]}]\s*$")
_ONLY_UNIT = re.compile(r"^\s*[(\[]\s*([^()\[\]]+?)\s*[)\]]\s*$")
_DASHED = re.compile(r"^(.*\S)\s+-\s+(\S+)$")


def split_header(header: str) -> tuple[str, str | None]:
    """Label and unit of a header; the unit is None when none is written.

    >>> split_header("Load (N)"), split_header("Time - sec"), split_header("Amplitude - Plot 0")
    (('Load', 'N'), ('Time', 'sec'), ('Amplitude - Plot 0', None))
    """
    header = header.strip().strip("\"'").strip()
    match = _BRACKETED.match(header)
    if match and match[1]:
        inside = match[2].strip()
        if re.fullmatch(r"\d+", inside) or not inside:  # time[0], a count and no unit
            return header, None
        return match[1].strip(), inside
    match = _DASHED.match(header)
    if match and find_unit(match[2]) is not None:
        return match[1].strip(), match[2]
    match = re.match(r"^(.*\S)\s*/\s*(\S+)$", header)
    if match and find_unit(match[2]) is not None and find_unit(header) is None:
        return match[1].strip(), match[2]
    return header, None


def bare_unit(cell: str) -> str | None:
    """The unit in a cell of a units row: ``(mm)``, ``[N]`` or plain ``s``; None when the cell is no unit."""
    match = _ONLY_UNIT.match(cell)
    text = match[1] if match else cell.strip().strip("\"'")
    if find_unit(text) is not None:
        return text
    return text if match else None


def is_units_row(cells: list[str]) -> bool:
    """True when every filled cell is a unit, and at least one cell is filled."""
    filled = [cell for cell in cells if cell.strip()]
    return bool(filled) and all(bare_unit(cell) is not None for cell in filled)


def quantity_of(label: str, unit: str | None) -> str | None:
    """The quantity that a label names, or None.

    Parameters
    ----------
    label : str
        Header without its unit.
    unit : str or None
        Unit as written; confirms one-letter symbols (``F (N)``) and nothing else.
    """
    folded = label.strip().lower()
    if re.match(r"time(\[\d*\]| - )", folded):  # LabVIEW's exports: time[0], Time - Plot 0
        return "time"
    if folded in _AXES:
        return folded
    if folded in _QUANTITY and len(folded) > 1:
        return _QUANTITY[folded]
    if folded in _SYMBOLS and unit is not None:
        conversion = find_unit(unit)
        expected = _SYMBOLS[folded]
        return expected if conversion and QUANTITY_OF_UNIT.get(conversion.unit) == expected else None
    if folded == "t":
        return "time"
    words = [word for word in re.findall(r"[^\W\d_]+", folded) if word not in _MODIFIERS]
    if words and all(word in _QUANTITY for word in words):
        named = {_QUANTITY[word] for word in words}
        if len(named) == 1:
            return named.pop()
        if "time" in named and words[-1] in ("timestamp", "time"):
            return "time"
    if words and words[-1] in ("timestamp", "time") and len(words) <= 3:
        return "time"
    return None
