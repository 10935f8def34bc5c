"""An exponential function that goes in lanes: library functions take one number at a time."""

from __future__ import annotations

import math
from typing import Any

from ssmr_ident.core.kernel import kernel
from ssmr_ident.core.simd import floor, power_of_two, where

_PER_TURN, _TURN_HIGH, _TURN_LOW = 1.4426950408889634, 6.93147180369123816490e-01, 1.90821492927058770002e-10
"""1/ln 2, and ln 2 in two parts of which the first has zeros at its end (Cody and Waite, Software Manual, 1980)."""

_LARGEST = 708.0
"""Beyond it powers of two are not normal numbers any more."""


@kernel
def exp(x: Any) -> Any:
    """e to the power of x, within 1.5 units in the last place; 0 below -708, infinity above 708.

    2ⁿ eʳ with |r| ≤ ½ ln 2, and Taylor's series of eʳ as far as it counts.

    Parameters
    ----------
    x : float
        Or ``Lanes``.
    """
    inside = abs(x) <= _LARGEST
    n = where(inside, floor(x * _PER_TURN + 0.5), 0.0)
    r = (x - n * _TURN_HIGH) - n * _TURN_LOW
    s = r * r
    q = s * s
    low = (1.0 / 2.0 + r * (1.0 / 6.0)) + s * (1.0 / 24.0 + r * (1.0 / 120.0))
    middle = (1.0 / 720.0 + r * (1.0 / 5040.0)) + s * (1.0 / 40320.0 + r * (1.0 / 362880.0))
    high = (1.0 / 3628800.0 + r * (1.0 / 39916800.0)) + s * (1.0 / 479001600.0 + r * (1.0 / 6227020800.0))
    series = 1.0 + (r + s * (low + q * (middle + q * high)))
    return where(inside, series * power_of_two(n), where(x > 0.0, math.inf, where(x < 0.0, 0.0, x)))
