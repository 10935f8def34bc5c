"""Sine and cosine as the robot's loop asks for them: every step ten of them, of angles that hardly leave zero."""

from __future__ import annotations

import math

from ssmr_ident.core.kernel import kernel
from ssmr_ident.core.simd import anywhere, where

SMALL = 0.125
"""Angle [rad] up to which the series below end beyond the last bit; the library's functions cost several times as
much there, and more in what they put aside when they are called."""


@kernel
def sin_cos(angle):
    """Sine and cosine of an angle [rad]."""
    s = angle * angle
    q = s * s
    sine = (-1.0 / 6.0 + s * (1.0 / 120.0)) + q * ((-1.0 / 5040.0 + s * (1.0 / 362880.0)) - q * (1.0 / 39916800.0))
    cosine = (1.0 / 24.0 + s * (-1.0 / 720.0)) + q * (1.0 / 40320.0 - s * (1.0 / 3628800.0))
    sine, cosine = angle + angle * s * sine, 1.0 - 0.5 * s + q * cosine
    far = abs(angle) > SMALL
    if anywhere(far):
        return where(far, math.sin(angle), sine), where(far, math.cos(angle), cosine)
    return sine, cosine
