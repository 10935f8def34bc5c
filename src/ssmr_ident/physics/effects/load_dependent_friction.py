"""Friction of gears, which grows with the torque that they carry.

Gears are loaded by the drive on one side and by the load on the other. Both count: a weight that is held loads them by
what the weight pulls and by what the drive holds against it.
"""

from __future__ import annotations

import math

from ssmr_ident.core.kernel import kernel
from ssmr_ident.core.parameter import Parameter
from ssmr_ident.physics.effect import Effect, Site


@kernel
def force(v, carried, friction, share, rounding):
    """(F_c + c |carried|) tanh(v/v_r) [N].

    v, rounding : float [m/s]; carried : float [N], force of the drive less that of the load; friction : float [N],
    share : float.
    """
    return (friction + share * abs(carried)) * math.tanh(v / rounding)


EFFECT = Effect(
    id="load_dependent_friction",
    sentence="The friction of the gears grows with the torque that they carry.",
    equation=r"F = \left(F_c + c\,|\tau_{drive} - \tau_{load}|\right)\tanh(v/v_r)",
    source="M. Duclusaud, G. Passault, V. Padois, O. Ly, Extended Friction Models for the Physics Simulation of Servo "
    "Actuators, ICRA 2025",
    signature="a loaded joint sticks harder than a free one: lifting asks for more than a weight, and letting down for "
    "less, by a share of the weight",
    parameters=(
        Parameter("F_c_N", "N", 1.0, 0.0, 1e6, "friction without load", off=0.0),
        Parameter("c", "1", 0.2, 0.0, 0.95, "share of the torque between drive and load", off=0.0),
        Parameter("rounding_m_s", "m/s", 0.01, 1e-9, 1e3, "v_r: speed by which it has its full size"),
    ),
    experiments=("forced",),
    acts={Site.DRIVE: force},
    rig=True,
)
