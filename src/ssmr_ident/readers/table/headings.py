"""What a column's header says: its label without the unit, the unit, and the quantity in this package's words."""

from __future__ import annotations

import re
from dataclasses import dataclass

from ssmr_ident.core.units import QUANTITY_OF_UNIT, Conversion
from ssmr_ident.readers.table.vocabulary import LONGEST, Vocabulary, shipped, words_of

AXES = {"acceleration": "a", "angular_rate": "w"}
_AXIS_NAMES = ("ax", "ay", "az", "wx", "wy", "wz")
OWN_NAMES = {*_AXIS_NAMES, "acceleration_2", "position_reference", "angular_rate"}
SI_UNIT = {quantity: unit for unit, quantity in QUANTITY_OF_UNIT.items()}
SI_UNIT |= {"ax": "m/s^2", "ay": "m/s^2", "az": "m/s^2", "wx": "rad/s", "wy": "rad/s", "wz": "rad/s"}
SI_UNIT |= {"acceleration_2": "m/s^2", "position_reference": "m", "base_acceleration": "m/s^2"}
_CLOSING = {")": "(", "]": "[", "}": "{", ">": "<"}
_WITHIN = re.compile(r"([^()\[\]]+)[(\[]([^()\[\]]+)[)\]][\s_:-]+([^()\[\]]+)\Z")
_BEFORE = re.compile(r"[(\[]([^()\[\]]+)[)\]][\s_:-]*([^()\[\]]+)\Z")
_MOST_TOKENS = 3  # of a unit behind an underscore: m_s_2
_SPELT = re.compile(r"(?:[mu]s|[mun]?secs?|\w{3,}s)\Z", re.IGNORECASE)  # ms, Seconds, millis; not second or min


@dataclass(frozen=True)
class Heading:
    """A header taken apart.

    Parameters
    ----------
    label : str
        Without a unit in brackets or behind a slash.
    unit : str or None
        As written; None when none is.
    quantity : str or None
        In this package's words (``ax``, ``force``, ``time``); None when none is named.
    source : str
        Where the unit is from when the header does not write it: a published definition.
    role : str
        ``counter`` or ``ignored`` for columns that are no measurement, else empty.
    """

    label: str
    unit: str | None
    quantity: str | None
    source: str = ""
    role: str = ""


def heading_of(header: str, unit: str | None = None, vocabulary: Vocabulary | None = None) -> Heading:
    """Take a header apart.

    Parameters
    ----------
    header : str
        As the file has it.
    unit : str or None
        From a row of units or an attribute; wins over the header's.
    vocabulary : Vocabulary or None
        None takes the shipped one.
    """
    known = vocabulary or shipped()
    label, written = split_header(header, known)
    unit = unit if unit is not None else written
    if unit is None:
        unit = unit_in_name(label, known)
    if unit is None and _SPELT.match(label) and known.unit(label) is not None:
        unit = label  # the unit stands for the name
    source = ""
    if unit is None:
        for convention in known.conventions:
            if convention.pattern.match(label.strip()[:LONGEST]):
                unit, source = convention.unit, convention.source
                break
    quantity = quantity_of(label, unit, known) or _symbol_before_unit(label, unit, known)
    return Heading(label, unit, quantity, source, "" if quantity else _role(label, unit, known))


def _symbol_before_unit(label: str, unit: str | None, known: Vocabulary) -> str | None:
    """The quantity of ``F_N`` and ``x_g``: a symbol, or an axis, and its unit."""
    name, _, tail = label.strip()[:LONGEST].rpartition(".")[2].partition("_")
    if not tail or unit is None or len(name) != 1 or unit not in _as_units(tail.split("_")):
        return None
    conversion = known.unit(unit)
    letter = {"m/s^2": "a", "rad/s": "w"}.get(conversion.unit) if conversion else None
    if letter and name in "xyz":
        return letter + name
    return quantity_of(name, unit, known)


def _role(label: str, unit: str | None, known: Vocabulary) -> str:
    words = words_of(label)
    for word in words:
        if known.has("ignored", (word,)):
            return "ignored"
    bare = tuple(w for w in words if not known.has("modifiers", (w,))) or words[-1:]
    if unit is None and words and (known.has("counters", words) or known.has("counters", bare)):
        return "counter"
    return ""


def split_header(header: str, vocabulary: Vocabulary | None = None) -> tuple[str, str | None]:
    """Label and unit of a header; the unit is None when none is written.

    >>> split_header("Load (N)"), split_header("Time - sec"), split_header("AngVel/rad/s")
    (('Load', 'N'), ('Time', 'sec'), ('AngVel', 'rad/s'))
    """
    known = vocabulary or shipped()
    header = header.strip().strip("\"'").strip()
    if len(header) > 4 * LONGEST:
        return header, None
    bare = header[3:] if header.startswith("in ") else header[1:-1] if _CLOSING.get(header[-1:]) == header[:1] else ""
    if bare and known.unit(bare) is not None:  # in s; [s]
        return "", bare.strip()
    bracketed = _bracketed(header)
    if bracketed is not None and known.unit(bracketed[1]) is None:  # Accel, g (S/N: 123)
        left, found, right = bracketed[0].rpartition(", ")
        if found and left.strip() and known.unit(right) is not None:
            return left.strip(), right.strip()
    if bracketed is not None:
        label, inside = bracketed
        if not inside or inside.isdigit():  # time[0], a count and no unit
            return header, None
        if label.endswith("/"):  # Acc/(m/s^2)
            label = label[:-1].rstrip()
        return label, inside
    before = _BEFORE.match(header)
    if before and known.unit(before[1]) is not None:  # [N] Force
        return before[2].strip(), before[1].strip()
    within = _WITHIN.match(header)
    if within and known.unit(within[2]) is not None:  # Force (N) Run #1
        return f"{within[1].strip()} {within[3]}", within[2].strip()
    for sign in (" - ", ", ", " in "):  # Time - sec; Force, kN; Kraft in kN
        left, found, right = header.rpartition(sign)
        if found and left.strip() and known.unit(right) is not None:
            return left.strip(), right.strip()
    if not header.startswith(("/", ".")) and known.unit(header) is None:
        for k, letter in enumerate(header):  # ISO 80000: quantity/unit, and the unit may hold a slash of its own
            right = header[k + 1 :].strip()
            if letter == "/" and k and right and known.unit(right) is not None:
                return header[:k].strip(), right
    left, _, right = header.rpartition(" ")
    if left and not right.isdigit() and _agrees(left, right, known):  # Force kN
        return left.strip(), right
    return header, None


def _bracketed(header: str) -> tuple[str, str] | None:
    """``Acc/(m/s^2)`` as ``Acc/`` and ``m/s^2``; None without brackets at the end."""
    opening = _CLOSING.get(header[-1:])
    if opening is None:
        return None
    depth = 0
    for k in range(len(header) - 1, -1, -1):
        depth += (header[k] == header[-1]) - (header[k] == opening)
        if depth == 0:
            label = header[:k].strip()
            return (label, header[k + 1 : -1].strip()) if label else None
    return None


def _agrees(name: str, unit: str, known: Vocabulary) -> bool:
    """True when a name is of a quantity that has this unit."""
    conversion = known.unit(unit)
    if conversion is None or unit in ("1", "-"):
        return False
    if re.split(r"[ .]", name)[-1] in ("x", "y", "z") and conversion.unit in ("m/s^2", "rad/s"):
        return True
    quantity = _named(name, conversion, known) or _optional(name, known)
    return (SI_UNIT.get(quantity or "") or known.optional.get(quantity or "")) == conversion.unit


def _optional(name: str, known: Vocabulary) -> str | None:
    words = [w for w in words_of(name) if not known.has("modifiers", (w,))]
    found = {known.phrases.get((w,)) for w in words}
    return next((q for q in found if q in known.optional), None)


def unit_in_name(label: str, vocabulary: Vocabulary | None = None) -> str | None:
    """The unit at the end of a name, where the rest names a quantity of that unit.

    >>> unit_in_name("force_N"), unit_in_name("accel_x_g"), unit_in_name("acc_m_s2"), unit_in_name("sensor_a")
    ('N', 'g', 'm/s^2', None)
    """
    known = vocabulary or shipped()
    label = label.strip()[:LONGEST]
    parts = re.split(r"[_ .]", label)
    if len(parts) == 1:
        hump = re.match(r"(.*[a-zà-ÿ0-9A-Z])([A-Z][a-z]{1,3}\d?)\Z", label) or re.match(
            r"(.*[a-zà-ÿ0-9])([A-Z]{1,2}[a-z]{0,2})\Z", label
        )
        return hump[2] if hump and _agrees(hump[1], hump[2], known) else None
    for count in range(min(_MOST_TOKENS, len(parts) - 1), 0, -1):
        name, tail = " ".join(parts[:-count]), parts[-count:]
        for unit in _as_units(tail):
            if _agrees(name, unit, known):
                return unit
    return None


def _as_units(tail: list[str]) -> list[str]:
    """Units that underscores may stand for: ``m_s2``, ``rad_s``, ``m_s_2``, ``mps2``, ``N_m``."""
    if len(tail) == 1:
        return [tail[0], *(["m/s^2"] if tail[0].lower() in ("ms2", "mss") else [])]
    powered = re.sub(r"([A-Za-z])-?2\Z", r"\1^2", "/".join(tail[:2]))
    if len(tail) == 2:
        return [powered, " ".join(tail)]
    return [f"{tail[0]}/{tail[1]}^2"] if tail[2] in ("2", "-2") else []


def bare_unit(cell: str, vocabulary: Vocabulary | None = None) -> str | None:
    """The unit in a cell of a units row: ``(mm)``, ``[N]`` or plain ``s``; None when the cell is no unit."""
    text = cell.strip().strip("\"'").strip()
    opening = _CLOSING.get(text[-1:])
    bracketed = opening is not None and text[:1] == opening and len(text) > 2
    inside = text[1:-1].strip() if bracketed else text
    if (vocabulary or shipped()).unit(inside) is not None:
        return inside
    return inside if bracketed else None


def is_units_row(cells: list[str], vocabulary: Vocabulary | None = None) -> bool:
    """True when every filled cell is a unit, and at least one cell is filled."""
    filled = [cell for cell in cells if cell.strip()]
    return bool(filled) and all(bare_unit(cell, vocabulary) is not None for cell in filled)


def quantity_of(label: str, unit: str | None, vocabulary: Vocabulary | None = None) -> str | None:
    """The quantity that a label names, or None.

    Parameters
    ----------
    label : str
        Header without its unit.
    unit : str or None
        Unit as written; confirms one-letter symbols (``F (N)``) and names among unknown words (``tip acceleration``).
    """
    known = vocabulary or shipped()
    return _named(label, known.unit(unit) if unit is not None else None, known)


def _named(label: str, conversion: Conversion | None, known: Vocabulary) -> str | None:
    folded = label.strip().lower()[:LONGEST]
    if re.match(r"time(\[\d*\]| - )", folded):  # LabVIEW's exports: time[0], Time - Plot 0
        return "time"
    if folded in OWN_NAMES:
        return folded
    words = words_of(label.split(" - ")[0])
    if len(words) > 12 or not words:
        return None
    if words[-1] in _AXIS_NAMES:  # imu.ax, data/wz
        return words[-1]
    for word in words:
        if word in _AXIS_NAMES and conversion is not None and SI_UNIT[word] == conversion.unit:  # ax_m_s2, imu1_ax_g
            return word
    quantity, rest = _phrase(words, conversion, known)
    if quantity is None or quantity in known.optional:
        return None
    if any(known.has("others", (w,)) for w in rest):
        return None
    rest = tuple(w for w in rest if not w.isdigit())
    axis = next((w for w in rest if w in ("x", "y", "z")), None) if quantity in AXES else None
    if quantity in AXES and axis is None and len(rest) and any(known.has("lengths", (w,)) for w in rest):
        return None
    unknown = [w for w in rest if w != axis and not known.has("modifiers", (w,)) and w not in ("x", "y", "z")]
    agrees = conversion is not None and SI_UNIT.get(quantity) == conversion.unit
    # a name among words that nobody knows is believed where the unit says the same; a time at the end always
    if unknown and not agrees and not (quantity == "time" and words[-1] in ("timestamp", "time", "stamp")):
        return None
    return AXES[quantity] + axis if axis is not None else quantity


def _phrase(
    words: tuple[str, ...], conversion: Conversion | None, known: Vocabulary
) -> tuple[str | None, tuple[str, ...]]:
    """The quantity that the words name, and the words that are left; the longest phrase, the last of equals."""
    bare = words if words[-1] not in ("x", "y", "z") or len(words) == 1 else words[:-1]
    if len(bare) == 1 and len(bare[0]) == 1 and bare[0] in known.symbols:
        named = known.symbols[bare[0]]
        for symbol in named:
            if conversion is not None and SI_UNIT.get(symbol) == conversion.unit:
                return symbol, words[len(bare) :]
        return ("time", ()) if named == ("time",) and conversion is None and bare == words else (None, words)
    if len(words[0]) == 2 and words[0][1] in "xyz" and conversion is not None:  # Fx (N), gy_dps
        for symbol in known.symbols.get(words[0][0], ()):
            if SI_UNIT.get(symbol) == conversion.unit:
                return symbol, (words[0][1],)
    for length in range(min(3, len(words)), 0, -1):
        for begin in range(len(words) - length, -1, -1):
            quantity = known.phrases.get(words[begin : begin + length])
            if quantity is not None and not (length == 1 and len(words[begin]) == 1 and words[begin].isascii()):
                if quantity == "time" and _names_another(words[:begin], known):
                    return "time", ()  # force_timestamp is a time, whatever it is the time of
                return quantity, words[:begin] + words[begin + length :]
    for k in range(len(words) - 1, -1, -1):
        for ending, quantity in known.endings.items():
            if words[k].endswith(ending) and len(words[k]) > len(ending):
                return quantity, words[:k] + words[k + 1 :]
    return None, words


def _names_another(words: tuple[str, ...], known: Vocabulary) -> bool:
    return any((w,) in known.phrases for w in words)
