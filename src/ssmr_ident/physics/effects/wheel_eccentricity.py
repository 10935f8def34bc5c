"""A wheel out of round."""

from __future__ import annotations

import math

from ssmr_ident.core.kernel import kernel
from ssmr_ident.core.parameter import Parameter
from ssmr_ident.physics.effect import Effect, Site


@kernel
def height(angle, eccentricity, wheel):
    """How much the tire reaches further down [m] at a wheel angle [rad]; each wheel starts a quarter turn on."""
    return eccentricity * math.sin(angle + 0.5 * math.pi * wheel)


@kernel
def slope(angle, eccentricity, wheel):
    """d(height)/d(angle) [m/rad]."""
    return eccentricity * math.cos(angle + 0.5 * math.pi * wheel)


EFFECT = Effect(
    id="wheel_eccentricity",
    sentence="The wheels are out of round and lift the robot once per turn.",
    equation=r"h_i = e \sin(\vartheta_i + i\pi/2)",
    source="Own formula: first harmonic of a run-out",
    signature="a line in the spectrum at the wheels' turning rate, proportional to wheel speed",
    parameters=(Parameter("eccentricity_m", "m", 3e-4, 0.0, 0.02, "half the run-out", off=0.0),),
    experiments=("swivel", "straight"),
    acts={Site.GROUND: height},
)
