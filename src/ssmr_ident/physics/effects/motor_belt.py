"""Drive belts that stretch."""

from __future__ import annotations

import math

from ssmr_ident.core.kernel import kernel
from ssmr_ident.core.parameter import Parameter
from ssmr_ident.physics.effect import Effect, Site, Sized


@kernel
def force(stretch, rate, stiffness, damping):
    """-K_b·b - D_b·b' [N] at the rim of one side's wheels; stretch b : float [m], rate : float [m/s]."""
    return -stiffness * stretch - damping * rate


EFFECT = Effect(
    id="motor_belt",
    sentence="The belt between motor and wheels stretches, on each side of the robot.",
    equation=r"m_b\ddot b = -K_b b - D_b\dot b + \sum_{side} F_x",
    source="Thesis eq (3.8), (4.14): tire and belt in series",
    signature="softer along x, in pitch and in longitudinal pulls, with a resonance of the wheels on the belt",
    parameters=(
        Parameter("K_b_N_m", "N/m", 2e4, 1.0, math.inf, "of one side, seen at the rim", off=math.inf),
        Parameter("D_b_N_s_m", "N s/m", 50.0, 0.0, 1e7, "of one side"),
        Parameter("rim_mass_kg", "kg", 1.0, 1e-4, 1e4, "inertia of one side's wheels over radius squared"),
    ),
    experiments=("free_response", "pull", "swivel"),
    acts={Site.BODY: force},
    sudden=True,
    # on the thesis' robot 500 N/m at least, 10 kN s/m at most and 0.05 to 20 kg, from 50 N s/m and 1 kg
    limits={
        "K_b_N_m": (Sized(0.027, "stiffness"), Sized(math.inf, "stiffness")),
        "D_b_N_s_m": (Sized(0.0, "stiffness*swing"), Sized(27.0, "stiffness*swing")),
        "rim_mass_kg": (Sized(1.0 / 600.0, "mass"), Sized(0.67, "mass")),
    },
    # stiffness and rim mass share a flat valley, along which a descent crawls: 18 kN/m is in the middle of most belts
    probes=tuple(
        {
            "K_b_N_m": Sized(share, "stiffness"),
            "D_b_N_s_m": Sized(0.134, "stiffness*swing"),
            "rim_mass_kg": Sized(0.033, "mass"),
        }
        for share in (0.5, 1.0, 2.0)
    ),
)
