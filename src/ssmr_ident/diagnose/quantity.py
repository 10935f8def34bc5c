"""Quantities as they are said."""

from __future__ import annotations

import math

_SMALL = ((1e-3, "m"), (1e-6, "µ"), (1e-9, "n"))
_SCALED = ("m", "m/s", "rad", "rad/s", "m/s^2", "N", "N m", "s")


def prefixed(value: float, unit: str, digits: int = 2) -> str:
    """A value with its unit, in thousandths or millionths where that reads better.

    >>> prefixed(0.00123, "m"), prefixed(-0.5, "rad"), prefixed(18240.0, "N/m"), prefixed(0.0, "s")
    ('1.2 mm', '-0.5 rad', '18000 N/m', '0 s')
    """
    printed = unit.replace("^2", "²").replace("^3", "³")
    if value != 0.0 and math.isfinite(value) and unit in _SCALED and abs(value) < 0.1:
        for size, prefix in _SMALL:
            if abs(value) >= size:
                return f"{_plain(value / size, digits)} {prefix}{printed}"
    return f"{_plain(value, digits)} {printed}"


def _plain(value: float, digits: int) -> str:
    text = f"{value:.{digits}g}"
    return text if "e" not in text or abs(value) >= 1e6 or abs(value) < 1e-4 else f"{float(text):.0f}"
