"""Rate-independent loops: Bouc-Wen."""

from __future__ import annotations

import math

from ssmr_ident.core.kernel import kernel
from ssmr_ident.core.parameter import Parameter
from ssmr_ident.physics.effect import Effect, Site, Sized

MOST_PARTS = 100
"""Of a step; a loop that yields within a hundredth of ten parts is dry friction."""


@kernel
def force(s, z, stiffness, alpha):
    """(1 - alpha)·K·(z - s) [N]: what the loop adds to the elastic K·s; s, z : float [m], stiffness : float [N/m]."""
    return (1.0 - alpha) * stiffness * (z - s)


@kernel
def advance(z, v, step, yield_m, exponent, shape):
    """dz/dt = v (1 - |z/y|ⁿ (γ + ½ sign(v z))) over one step at constant v.

    Exactly for n = 1, and for n = 2, γ = ½ (dz/dt = v (1 - (z/y)²) while |z| grows, dz/dt = v while it shrinks), else
    by the midpoint rule over a tenth of the yield deflection at a time.

    Parameters
    ----------
    z, yield_m : float [m]
    v : float [m/s]
    step : float [s]
    exponent, shape : float
        n and γ.
    """
    travel = v * step
    if exponent == 2.0 and shape == 0.5:
        if z * travel < 0.0:  # on the way back to zero the element is elastic
            if abs(travel) <= abs(z):
                return z + travel
            travel += z
            z = 0.0
        ratio = min(max(z / yield_m, -1.0), 1.0)
        grown = math.tanh(travel / yield_m)
        return yield_m * (ratio + grown) / (1.0 + ratio * grown)
    if exponent == 1.0:
        way = 1.0 if travel > 0.0 else -1.0
        return way * yield_m * _of_exponent_one(way * z / yield_m, abs(travel) / yield_m, shape)
    count = min(1 + int(10.0 * abs(travel) / yield_m), MOST_PARTS)
    part, u = travel / yield_m / count, z / yield_m
    growing = shape + 0.5
    most = growing ** (-1.0 / exponent) if growing > 0.0 else math.inf
    for _ in range(count):
        middle = u + 0.5 * part * _slope(u, part, exponent, shape)
        u += part * _slope(middle, part, exponent, shape)
        u = min(max(u, -most), most)
    return yield_m * u


@kernel
def _of_exponent_one(u, travel, shape):
    """u = z/y after a travel onward, in yield deflections, for n = 1: du/ds is linear in u on either side of nought."""
    back, on = shape - 0.5, -(shape + 0.5)
    if u < 0.0:
        slope = 1.0 + back * u
        whole = -u if back == 0.0 else -math.log(slope) / back if slope > 0.0 else math.inf
        if travel < whole:
            u += travel if back == 0.0 else slope * math.expm1(back * travel) / back
            return max(u, 1.0 / on) if on < 0.0 else u
        u, travel = 0.0, travel - whole
    u += travel if on == 0.0 else (1.0 + on * u) * math.expm1(on * travel) / on
    return min(u, -1.0 / on) if on < 0.0 else u


@kernel
def _slope(u, direction, exponent, shape):
    """dz/ds at u = z/y."""
    turned = 0.5 if u * direction >= 0.0 else -0.5
    size = abs(u)
    power = size * size if exponent == 2.0 else size**exponent
    return 1.0 - power * (shape + turned)


EFFECT = Effect(
    id="hysteresis",
    sentence="The force depends on the path: energy is lost in every cycle, however slow it is.",
    equation=r"F = \alpha K s + (1-\alpha) K z,\quad "
    r"\dot z = v\,(1-|z/y|^n (\gamma + \tfrac12\,\mathrm{sign}(v z)))",
    source="Y. K. Wen, Method for random vibration of hysteretic systems, J. Eng. Mech. Div. ASCE 102(2), 1976; "
    "M. Ismail, F. Ikhouane and J. Rodellar, Arch. Comput. Methods Eng. 16, 2009 (what n, beta and gamma do)",
    signature="force-deflection loops whose area does not depend on speed; softening and damping up with amplitude",
    parameters=(
        Parameter("alpha", "1", 0.85, 0.0, 1.0, "share of the stiffness that is elastic", off=1.0),
        Parameter("yield_m", "m", 4e-4, 1e-10, 10.0, "deflection at which the loop saturates"),
        Parameter("exponent", "1", 2.0, 1.0, 8.0, "n: how sharply the loop yields"),
        Parameter("shape", "1", 0.5, -1.0, 1.0, "gamma: 1/2 unloads elastically, less stiffer; below -1/2 hardens"),
    ),
    experiments=("free_response", "forced", "pull"),
    acts={Site.ELEMENT: force, Site.STATE: advance},
    rig=True,
    probes=(
        {"alpha": 0.85, "yield_m": Sized(0.1, "deflection")},
        {"alpha": 0.85, "yield_m": Sized(0.5, "deflection")},
        {"alpha": 0.5, "yield_m": Sized(0.5, "deflection")},
        {"alpha": 0.5, "yield_m": Sized(0.5, "deflection"), "exponent": 1.0, "shape": 0.0},
    ),
)
