"""Numbers as printed: significant digits, true minus signs, powers of ten, units with exponents."""

from __future__ import annotations

import math
import re
from collections.abc import Sequence

from ssmr_ident.report.style import unit_text

NONE = "–"
_RAISED = str.maketrans("-0123456789", "⁻⁰¹²³⁴⁵⁶⁷⁸⁹")


def unit(text: str) -> str:
    """Unit with raised exponents; nothing for a pure number.

    >>> unit("N/m^3"), unit("m/s^2"), unit("1")
    ('N/m³', 'm/s²', '')
    """
    printed = re.sub(r"\^(-?\d+)", lambda found: found[1].translate(_RAISED), unit_text(text).replace("_", " "))
    return "" if printed == NONE else printed


def number(value: float, digits: int = 3) -> str:
    """A value to some significant digits.

    >>> number(18.04), number(-0.5), number(3.104e8), number(98765.0), number(float("nan"))
    ('18', '−0.5', '3.1·10⁸', '98800', '–')
    """
    if not math.isfinite(value):
        return NONE if math.isnan(value) else ("∞" if value > 0 else "−∞")
    power = _power(value)
    rounded = float(f"{value / 10.0**power:.{digits}g}")
    return _join(f"{rounded:.12g}", power)


def measured(value: float, std: float | None, of: str = "1") -> str:
    """A value with its standard deviation, which keeps two digits, and its unit.

    >>> measured(3.104e8, 2.3e7, "N/m^3"), measured(24.41, 0.137, "N s/m"), measured(0.5, None)
    ('(3.10 ± 0.23)·10⁸ N/m³', '24.41 ± 0.14 N s/m', '0.5')
    """
    if std is None or not math.isfinite(std) or not math.isfinite(value):
        return f"{number(value)} {unit(of)}".rstrip()
    pair, power = _aligned((value, std), std)
    text = f"{pair[0]} ± {pair[1]}"
    text = _join(f"({text})", power) if power else text
    return f"{text} {unit(of)}".rstrip()


def interval(low: float, high: float, of: str = "1") -> str:
    """Both ends of an interval, to two digits of its width, with the unit.

    >>> interval(17.123, 20.5, "%"), interval(-3.1e-7, 2e-8, "m")
    ('17.1 … 20.5 %', '(−3.1 … 0.2)·10⁻⁷ m')
    """
    if not (math.isfinite(low) and math.isfinite(high)):
        return f"{number(low)} … {number(high)} {unit(of)}".rstrip()
    pair, power = _aligned((low, high), high - low)
    text = f"{pair[0]} … {pair[1]}"
    text = _join(f"({text})", power) if power else text
    return f"{text} {unit(of)}".rstrip()


def share(value: float) -> str:
    """A share in per cent; never all, for only what was tried was weighed.

    >>> share(0.52), share(0.99999), share(0.0)
    ('52 %', 'above 99.9 %', 'below 0.1 %')
    """
    if value > 0.999:
        return "above 99.9 %"
    return "below 0.1 %" if value < 0.001 else f"{number(100 * value)} %"


def alike(values: Sequence[float]) -> list[str]:
    """Values to read against each other: decimals for two digits of the smallest, for three where all are close.

    >>> alike([22.0, 3.41, 2.93]), alike([0.5, 0.0123]), alike([2.95, 2.91]), alike([5.0, 1e-4])
    (['22.0', '3.4', '2.9'], ['0.500', '0.012'], ['2.95', '2.91'], ['5', '1·10⁻⁴'])
    """
    sizes = [abs(v) for v in values if math.isfinite(v) and v != 0]
    if not sizes:
        return [number(v) for v in values]
    digits = 3 if max(sizes) < 2 * min(sizes) else 2
    decimals = max(digits - 1 - math.floor(math.log10(min(sizes))), 0)
    if decimals > 3:
        return [number(v) for v in values]
    return [_minus(f"{v:.{decimals}f}") if math.isfinite(v) else number(v) for v in values]


def _aligned(values: tuple[float, float], width: float) -> tuple[tuple[str, str], int]:
    """Two values to the same decimal, where ``width`` has two digits."""
    power = _power(max(values, key=abs))
    scaled = float(f"{width / 10.0**power:.1e}")  # 0.0999… is 0.10
    decimals = max(0, 1 - math.floor(math.log10(scaled))) if scaled > 0 else 2
    first, second = (_minus(f"{value / 10.0**power:.{min(decimals, 8)}f}") for value in values)
    return (first, second), power


def _power(value: float) -> int:
    """Power of ten to take out: none for what reads well without."""
    return 0 if value == 0 or 1e-2 <= abs(value) < 1e5 else math.floor(math.log10(abs(value)))


def _join(text: str, power: int) -> str:
    return _minus(text) + (f"·10{str(power).translate(_RAISED)}" if power else "")


def _minus(text: str) -> str:
    return text.replace("-", "−")
