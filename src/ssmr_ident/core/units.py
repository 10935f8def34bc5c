"""Units that logs are written in, and their way to SI. Conversion happens in the readers and nowhere else."""

from __future__ import annotations

import math
import re
from dataclasses import dataclass

from ssmr_ident.core.errors import did_you_mean


@dataclass(frozen=True)
class Conversion:
    """SI value = ``factor`` * value + ``offset``.

    Parameters
    ----------
    unit : str
        The SI unit reached; ``V`` stays ``V``: a sensor's calibration is not a change of unit.
    factor : float
    offset : float
    """

    unit: str
    factor: float = 1.0
    offset: float = 0.0

    @property
    def changes(self) -> bool:
        """False when the numbers stay as they are."""
        return self.factor != 1.0 or self.offset != 0.0


STANDARD_GRAVITY = 9.80665  # m/s^2, exact by definition (CGPM 1901)
POUND_FORCE = 4.4482216152605  # N, exact: 0.45359237 kg x 9.80665 m/s^2
INCH = 0.0254  # m, exact (1959)

# unit as written -> (SI unit, factor). Upper and lower case matter only where they tell units apart (mN, MN).
_TABLE: dict[str, tuple[str, float]] = {
    # force
    "N": ("N", 1.0), "kN": ("N", 1e3), "mN": ("N", 1e-3), "MN": ("N", 1e6), "uN": ("N", 1e-6), "daN": ("N", 10.0),
    "cN": ("N", 1e-2), "kg-f": ("N", STANDARD_GRAVITY),
    "kips": ("N", 1e3 * POUND_FORCE),
    "ton-force": ("N", 1e3 * STANDARD_GRAVITY),
    "tf": ("N", 1e3 * STANDARD_GRAVITY), "dyn": ("N", 1e-5),
    "lb": ("N", POUND_FORCE), "lbf": ("N", POUND_FORCE), "lbs": ("N", POUND_FORCE),
    "klbf": ("N", 1e3 * POUND_FORCE),
    "kip": ("N", 1e3 * POUND_FORCE), "ozf": ("N", POUND_FORCE / 16.0),
    "kgf": ("N", STANDARD_GRAVITY), "kp": ("N", STANDARD_GRAVITY), "gf": ("N", STANDARD_GRAVITY / 1e3),
    # length
    "m": ("m", 1.0), "mm": ("m", 1e-3), "cm": ("m", 1e-2), "um": ("m", 1e-6), "nm": ("m", 1e-9), "km": ("m", 1e3),
    "in": ("m", INCH), "inch": ("m", INCH), "inches": ("m", INCH), "ft": ("m", 12 * INCH),
    "mil": ("m", INCH / 1e3), "mils": ("m", INCH / 1e3), "thou": ("m", INCH / 1e3), "dm": ("m", 0.1),
    # time
    "s": ("s", 1.0), "sec": ("s", 1.0), "secs": ("s", 1.0),
    "ms": ("s", 1e-3), "msec": ("s", 1e-3), "us": ("s", 1e-6), "usec": ("s", 1e-6), "ns": ("s", 1e-9),
    "nsec": ("s", 1e-9), "sek": ("s", 1.0),
    "min": ("s", 60.0), "minutes": ("s", 60.0), "h": ("s", 3600.0), "hour": ("s", 3600.0), "hours": ("s", 3600.0),
    "hr": ("s", 3600.0), "hrs": ("s", 3600.0),
    # speed
    "m/s": ("m/s", 1.0), "mm/s": ("m/s", 1e-3), "cm/s": ("m/s", 1e-2), "um/s": ("m/s", 1e-6),
    "mm/min": ("m/s", 1e-3 / 60), "m/min": ("m/s", 1 / 60), "km/h": ("m/s", 1 / 3.6),
    "in/s": ("m/s", INCH), "ips": ("m/s", INCH), "mph": ("m/s", 63360 * INCH / 3600), "knots": ("m/s", 1852 / 3600),
    "in/min": ("m/s", INCH / 60),
    # acceleration; "g" alone is the unit of acceleration, a mass or a force in grams is written out
    "m/s^2": ("m/s^2", 1.0), "mm/s^2": ("m/s^2", 1e-3), "cm/s^2": ("m/s^2", 1e-2), "in/s^2": ("m/s^2", INCH),
    "g": ("m/s^2", STANDARD_GRAVITY), "mg": ("m/s^2", STANDARD_GRAVITY / 1e3), "g0": ("m/s^2", STANDARD_GRAVITY),
    "g_n": ("m/s^2", STANDARD_GRAVITY), "gn": ("m/s^2", STANDARD_GRAVITY), "ug": ("m/s^2", STANDARD_GRAVITY / 1e6),
    "milli-g": ("m/s^2", STANDARD_GRAVITY / 1e3), "mps2": ("m/s^2", 1.0), "gal": ("m/s^2", 1e-2),
    "mGal": ("m/s^2", 1e-5),
    # angle and its rate
    "rad": ("rad", 1.0), "mrad": ("rad", 1e-3), "urad": ("rad", 1e-6), "gon": ("rad", math.pi / 200),
    "deg": ("rad", math.pi / 180), "rad/s": ("rad/s", 1.0),
    "mrad/s": ("rad/s", 1e-3), "deg/s": ("rad/s", math.pi / 180), "dps": ("rad/s", math.pi / 180),
    "rpm": ("rad/s", 2 * math.pi / 60), "U/min": ("rad/s", 2 * math.pi / 60), "rev": ("rad", 2 * math.pi),
    "mdps": ("rad/s", 1e-3 * math.pi / 180), "mps": ("m/s", 1.0), "kph": ("m/s", 1 / 3.6),
    "1/min": ("rad/s", 2 * math.pi / 60), "min^-1": ("rad/s", 2 * math.pi / 60), "min-1": ("rad/s", 2 * math.pi / 60),
    "r/min": ("rad/s", 2 * math.pi / 60), "tr/min": ("rad/s", 2 * math.pi / 60), "rps": ("rad/s", 2 * math.pi),
    "krpm": ("rad/s", 2e3 * math.pi / 60),
    "rad/s^2": ("rad/s^2", 1.0), "deg/s^2": ("rad/s^2", math.pi / 180),
    # stress, strain, moment
    "Pa": ("Pa", 1.0), "kPa": ("Pa", 1e3), "MPa": ("Pa", 1e6), "GPa": ("Pa", 1e9), "N/mm^2": ("Pa", 1e6),
    "bar": ("Pa", 1e5), "mbar": ("Pa", 100.0), "hPa": ("Pa", 100.0), "atm": ("Pa", 101325.0),
    "psi": ("Pa", POUND_FORCE / INCH**2), "ksi": ("Pa", 1e3 * POUND_FORCE / INCH**2),
    "1": ("1", 1.0), "-": ("1", 1.0), "%": ("1", 1e-2), "mm/mm": ("1", 1.0), "m/m": ("1", 1.0),
    "in/in": ("1", 1.0),
    "ustrain": ("1", 1e-6), "microstrain": ("1", 1e-6), "uε": ("1", 1e-6), "ue": ("1", 1e-6), "mε": ("1", 1e-3),
    "um/m": ("1", 1e-6),
    "N m": ("N m", 1.0), "Nm": ("N m", 1.0), "N*m": ("N m", 1.0), "N-m": ("N m", 1.0), "kNm": ("N m", 1e3),
    "Nmm": ("N m", 1e-3),
    "mNm": ("N m", 1e-3), "Ncm": ("N m", 1e-2), "kgf-m": ("N m", STANDARD_GRAVITY),
    "kgf-cm": ("N m", STANDARD_GRAVITY / 100), "in-lb": ("N m", INCH * POUND_FORCE),
    "in lbf": ("N m", INCH * POUND_FORCE),
    "lbf in": ("N m", INCH * POUND_FORCE), "ft-lb": ("N m", 12 * INCH * POUND_FORCE),
    "in-lbf": ("N m", INCH * POUND_FORCE), "lbf-in": ("N m", INCH * POUND_FORCE), "lb-in": ("N m", INCH * POUND_FORCE),
    "ft-lbf": ("N m", 12 * INCH * POUND_FORCE), "lbf-ft": ("N m", 12 * INCH * POUND_FORCE),
    "lb-ft": ("N m", 12 * INCH * POUND_FORCE), "oz-in": ("N m", INCH * POUND_FORCE / 16),
    "ozf-in": ("N m", INCH * POUND_FORCE / 16), "kgf m": ("N m", STANDARD_GRAVITY),
    "ft lbf": ("N m", 12 * INCH * POUND_FORCE), "lbf ft": ("N m", 12 * INCH * POUND_FORCE),
    # electrical and others that pass through
    "VDC": ("V", 1.0), "mVDC": ("V", 1e-3), "V": ("V", 1.0), "mV": ("V", 1e-3), "uV": ("V", 1e-6), "kV": ("V", 1e3),
    "A": ("A", 1.0), "mA": ("A", 1e-3), "Hz": ("Hz", 1.0), "kHz": ("Hz", 1e3),
    "S/s": ("Hz", 1.0), "Sa/s": ("Hz", 1.0), "sps": ("Hz", 1.0), "kS/s": ("Hz", 1e3), "ksps": ("Hz", 1e3),
    "kSa/s": ("Hz", 1e3), "MS/s": ("Hz", 1e6),
    "kg": ("kg", 1.0),
    "K": ("K", 1.0), "W": ("W", 1.0),
}  # fmt: skip
_OFFSETS = {"degC": Conversion("K", 1.0, 273.15), "C": Conversion("K", 1.0, 273.15),
            "degF": Conversion("K", 5 / 9, 273.15 - 32 * 5 / 9)}  # fmt: skip

_EXACT = {name: Conversion(unit, factor) for name, (unit, factor) in _TABLE.items()} | _OFFSETS
_FOLDED: dict[str, Conversion | None] = {}
for _name, _conversion in _EXACT.items():
    _key = _name.lower()
    # two units that differ by case only (mN, MN) are never guessed from a misspelt one
    _FOLDED[_key] = _conversion if _FOLDED.get(_key, _conversion) == _conversion else None

QUANTITY_OF_UNIT = {
    "N": "force", "m": "position", "s": "time", "m/s": "velocity", "m/s^2": "acceleration", "rad": "angle",
    "rad/s": "angular_rate", "Pa": "stress", "1": "strain", "N m": "torque", "V": "voltage",
}  # fmt: skip


OF_A_GOAL = ("m", "rad")
"""Units that a position_reference may have: that of the motion that follows it."""

LONGEST = 28  # characters; no unit is longer, and nothing longer is looked at

_SIGNS = str.maketrans({"µ": "u", "μ": "u", "·": "*", "⋅": "*", "×": "*", "−": "-", "–": "-", "⁻": "-", "¹": "1",
                        "²": "2", "³": "3", "⁴": "4", "º": "°", "″": '"', "\u00a0": " ", "\u202f": " "})  # fmt: skip
_POWER = re.compile(r"(?P<name>[A-Za-z%][A-Za-z0%]*)\^?(?P<power>[+-]?[1-4])?\Z", re.ASCII)
_NAMES = {"meter": "m", "metre": "m", "mètre": "m", "metro": "m", "second": "s", "sec": "s", "sek": "s", "sekunde": "s",
          "sekunden": "s", "seconde": "s", "segundo": "s", "newton": "N", "volt": "V", "ampere": "A", "amp": "A",
          "hertz": "Hz", "pascal": "Pa", "radian": "rad"}  # fmt: skip
_PREFIXES = {"": "", "kilo": "k", "centi": "c", "milli": "m", "mili": "m", "micro": "u", "mikro": "u", "nano": "n",
             "mega": "M", "giga": "G"}  # fmt: skip
_WORDS = {"degrees": "deg", "degree": "deg", "grad": "deg", "millis": "ms", "micros": "us", "nanos": "ns",
          "micron": "um", "microns": "um", "feet": "ft", "pound": "lbf", "pounds": "lbf", "pounds-force": "lbf",
          "pound-force": "lbf", "newton-meter": "N m", "newton-metre": "N m",
          "с": "s", "сек": "s", "мс": "ms", "мкс": "us", "н": "N", "кн": "kN", "м": "m", "мм": "mm", "м/с2": "m/s^2",
          "м/с^2": "m/s^2", "м/с": "m/s", "мм/с": "mm/s", "н*м": "N m", "град": "deg", "рад": "rad",
          "秒": "s", "毫秒": "ms",
          "milli g": "mg", "g's": "g", "gees": "g", "percent": "%"}  # fmt: skip
_WORDS |= {
    prefix + name + plural: sign + symbol
    for prefix, sign in _PREFIXES.items()
    for name, symbol in _NAMES.items()
    for plural in ("", "s")
    if sign + symbol in _TABLE
}

# What composed units are made of: exponents of (kg, m, s, rad, V, A, K) and the factor to them
_DIMENSIONS: dict[str, tuple[tuple[int, ...], float]] = {
    "kg": ((1, 0, 0, 0, 0, 0, 0), 1.0), "m": ((0, 1, 0, 0, 0, 0, 0), 1.0), "s": ((0, 0, 1, 0, 0, 0, 0), 1.0),
    "rad": ((0, 0, 0, 1, 0, 0, 0), 1.0), "V": ((0, 0, 0, 0, 1, 0, 0), 1.0), "A": ((0, 0, 0, 0, 0, 1, 0), 1.0),
    "K": ((0, 0, 0, 0, 0, 0, 1), 1.0), "N": ((1, 1, -2, 0, 0, 0, 0), 1.0), "Pa": ((1, -1, -2, 0, 0, 0, 0), 1.0),
    "W": ((1, 2, -3, 0, 0, 0, 0), 1.0), "Hz": ((0, 0, -1, 0, 0, 0, 0), 1.0), "1": ((0,) * 7, 1.0),
    "m/s": ((0, 1, -1, 0, 0, 0, 0), 1.0), "m/s^2": ((0, 1, -2, 0, 0, 0, 0), 1.0),
    "rad/s": ((0, 0, -1, 1, 0, 0, 0), 1.0), "rad/s^2": ((0, 0, -2, 1, 0, 0, 0), 1.0),
    "N m": ((1, 2, -2, 0, 0, 0, 0), 1.0),
}  # fmt: skip
_BY_DIMENSION = {dimension: unit for unit, (dimension, _) in _DIMENSIONS.items()}


def _plain(text: str) -> str:
    """The unit in plain letters: µ, ², ·, ** and the signs for degrees and seconds are written many ways."""
    text = text.strip().strip("\"'").strip().translate(_SIGNS).replace("**", "^")
    while text[:1] == "(" and text[-1:] == ")":
        text = text[1:-1].strip()
    text = re.sub(r"° ?([CF])\b", r"deg\1", text).replace("°", "deg")
    text = text.replace(" per ", "/").replace(" squared", "^2")
    return " ".join(text.split())


def _composed(text: str) -> Conversion | None:
    """A product of known units with powers: ``m s^-2``, ``in/s2``, ``m/s/s``, ``kg*m/s^2``, ``rad s-1``."""
    factor, total, sign = 1.0, [0] * 7, 1
    text = re.sub(r"(?<=[a-zA-Z])\.(?=[a-zA-Z])", "*", text)  # N.m, as much of Europe writes products
    parts = re.split(r"([*/ ])", text.replace("(", "").replace(")", "").replace(" / ", "/").replace(" * ", "*"))
    for part in parts:
        if part in ("*", " ", ""):
            continue
        if part == "/":
            sign = -1  # what stands behind a slash is below it: m/s/s, N/mm^2
            continue
        match = _POWER.match(part)
        known = _EXACT.get(_WORDS.get(match["name"].lower(), match["name"])) if match else None
        if match is None or known is None or known.offset or known.unit not in _DIMENSIONS:
            return None
        power = sign * int(match["power"] or 1)
        factor *= known.factor**power
        total = [t + power * d for t, d in zip(total, _DIMENSIONS[known.unit][0], strict=True)]
    unit = _BY_DIMENSION.get(tuple(total))
    return Conversion(unit, factor) if unit and unit != "1" else None


def find_unit(unit: str) -> Conversion | None:
    """The way to SI of a unit as a log writes it, or None when it is not known.

    >>> find_unit("kN")
    Conversion(unit='N', factor=1000.0, offset=0.0)
    >>> find_unit("furlong") is None
    True
    """
    if len(unit) > LONGEST + 4:
        return None
    plain = _plain(unit)
    for name in (plain, _WORDS.get(plain.lower(), plain), plain.replace("*", " ")):
        if name in _EXACT:
            return _EXACT[name]
    loud = _composed(plain.lower()) if plain.isupper() and "S" in plain else None  # M/S2, MM/S; never MN or PA
    return _composed(plain) or _FOLDED.get(plain.lower()) or loud


def to_si(unit: str) -> Conversion:
    """The way to SI of a unit.

    Parameters
    ----------
    unit : str
        As a log or a user writes it: ``lbf``, ``mm``, ``(sec)`` without its brackets, ``m/s²``.

    Raises
    ------
    ValueError
        For a unit that is not in the table, with the nearest known one.

    >>> to_si("lbf").factor
    4.4482216152605
    """
    found = find_unit(unit)
    if found is None:
        raise ValueError(f"unit {unit!r} is not known. {did_you_mean(unit, _EXACT)}")
    return found
