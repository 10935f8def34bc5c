"""Rate-independent loops: Bouc-Wen."""

from __future__ import annotations

import math

from ssmr_ident.core.kernel import kernel
from ssmr_ident.core.parameter import Parameter
from ssmr_ident.physics.effect import Effect, Site, Sized


@kernel
def force(s, z, stiffness, alpha):
    """(1 - alpha)·K·(z - s) [N]: what the loop adds to the elastic K·s; s, z : float [m], stiffness : float [N/m]."""
    return (1.0 - alpha) * stiffness * (z - s)


@kernel
def advance(z, v, step, yield_m):
    """dz/dt = v (1 - (z/y)²) while |z| grows, dz/dt = v while it shrinks, over one step at constant v, exactly.

    z, yield_m : float [m], v : float [m/s].
    """
    travel = v * step
    if z * travel < 0.0:  # on the way back to zero the element is elastic
        if abs(travel) <= abs(z):
            return z + travel
        travel += z
        z = 0.0
    ratio = min(max(z / yield_m, -1.0), 1.0)
    grown = math.tanh(travel / yield_m)
    return yield_m * (ratio + grown) / (1.0 + ratio * grown)


EFFECT = Effect(
    id="hysteresis",
    sentence="The force depends on the path: energy is lost in every cycle, however slow it is.",
    equation=r"F = \alpha K s + (1-\alpha) K z,\quad "
    r"\dot z = v\,(1-(z/y)^2)\ \text{loading},\ \dot z = v\ \text{unloading}",
    source="Y. K. Wen, Method for random vibration of hysteretic systems, J. Eng. Mech. Div. ASCE 102(2), 1976",
    signature="force-deflection loops whose area does not depend on speed; softening and damping up with amplitude",
    parameters=(
        Parameter("alpha", "1", 0.85, 0.0, 1.0, "share of the stiffness that is elastic", off=1.0),
        Parameter("yield_m", "m", 4e-4, 1e-7, 0.1, "deflection at which the loop saturates"),
    ),
    experiments=("free_response", "forced", "pull"),
    acts={Site.ELEMENT: force, Site.STATE: advance},
    rig=True,
    probes=(
        {"alpha": 0.85, "yield_m": Sized(0.1, "deflection")},
        {"alpha": 0.85, "yield_m": Sized(0.5, "deflection")},
        {"alpha": 0.5, "yield_m": Sized(0.5, "deflection")},
    ),
)
