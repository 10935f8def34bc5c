"""Coulomb friction beside the spring, with the small elastic travel that real contacts have."""

from __future__ import annotations

import math

from ssmr_ident.core.exponential import exp
from ssmr_ident.core.kernel import kernel
from ssmr_ident.core.parameter import Parameter
from ssmr_ident.core.simd import first, where
from ssmr_ident.physics.effect import Effect, Site, Sized


@kernel
def force(z, v, friction, stiffness, rounding):
    """k·z [N] of the elastic-plastic element, or F_c tanh(v/v_r) of one without travel where v_r is not 0.

    z : float [m], v : float [m/s], friction : float [N], stiffness : float [N/m], rounding : float [m/s].
    """
    if first(rounding) != 0.0:
        return friction * math.tanh(v / rounding)
    return stiffness * z


@kernel
def advance(z, v, step, friction, stiffness, slider):
    """Dahl's law dz/dt = v - |v| k z/F_c, or a spring in series with a slider, over one step at constant v, exactly.

    z : float [m], v : float [m/s], friction : float [N], stiffness : float [N/m], slider : float, 0 for Dahl's law.
    """
    speed, reach = abs(v), friction / stiffness
    if first(slider) != 0.0:
        return min(max(z + v * step, -reach), reach)
    end = where(v > 0.0, reach, -reach)
    return where(speed == 0.0, z, end + (z - end) * exp(-speed * step * stiffness / friction))


EFFECT = Effect(
    id="dry_friction",
    sentence="Dry friction opposes every motion with the same force, however slow it is.",
    equation=r"F = k z,\quad \dot z = v - |v|\,k z/F_c \quad\text{or}\quad F = F_c\tanh(v/v_r)",
    source="P. R. Dahl, A solid friction model, Aerospace Corp. TOR-0158, 1968; "
    "Armstrong-Helouvry, Dupont, Canudas de Wit, Automatica 30(7), 1994",
    signature="a decay falls along a straight line and stops dead; damping ratio grows as the amplitude falls",
    parameters=(
        Parameter("F_c_N", "N", 1.0, 0.0, 1e6, "friction of one tire and axis, or of the rig", off=0.0),
        Parameter("element_stiffness_N_m", "N/m", 3e5, 1e-3, 1e13, "elastic travel before it slides"),
        Parameter("slider", "1", 0.0, 0.0, 1.0, "1: a spring in series with a slider, 0: Dahl's law"),
        Parameter(
            "rounding_m_s", "m/s", 0.0, 0.0, 10.0, "v_r: speed by which it has its full size; 0 with an elastic travel"
        ),
    ),
    experiments=("free_response", "forced"),
    acts={Site.ELEMENT: force, Site.STATE: advance},
    rig=True,
    forms=(
        {"element_stiffness_N_m": Sized(10.0, "stiffness"), "slider": 0.0},
        {"element_stiffness_N_m": Sized(10.0, "stiffness"), "slider": 1.0},
        {"rounding_m_s": Sized(0.1, "speed")},
    ),
    probes=(
        {"F_c_N": Sized(0.005, "force"), "element_stiffness_N_m": Sized(10.0, "stiffness")},
        {"F_c_N": Sized(0.03, "force"), "element_stiffness_N_m": Sized(10.0, "stiffness")},
        {"F_c_N": Sized(0.15, "force"), "element_stiffness_N_m": Sized(10.0, "stiffness")},
        {"F_c_N": Sized(0.03, "force"), "rounding_m_s": Sized(0.1, "speed")},
    ),
)
