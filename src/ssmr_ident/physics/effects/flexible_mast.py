"""A frame that sways on the platform."""

from __future__ import annotations

import math

from ssmr_ident.core.kernel import kernel
from ssmr_ident.core.parameter import Parameter
from ssmr_ident.physics.effect import Effect, Site, Sized


@kernel
def force(q, rate, mass, frequency, ratio):
    """Spring and damper between mast and platform [N]: -m·(w²·q + 2·zeta·w·q'); q [m], frequency [Hz]."""
    omega = 2.0 * math.pi * frequency
    return -mass * (omega * omega * q + 2.0 * ratio * omega * rate)


EFFECT = Effect(
    id="flexible_mast",
    sentence="Part of the robot's mass, the frame with the laptop, sways on the platform.",
    equation=r"m_m(\ddot q + \ddot x_P) = -m_m\omega_m^2 q - 2\zeta m_m\omega_m \dot q",
    source="Own formula: point mass on horizontal springs; total mass and inertia hold with it locked",
    signature="a second line beside each horizontal mode, split peaks, beating decays",
    parameters=(
        Parameter("f_mast_Hz", "Hz", 9.0, 0.05, math.inf, "with the platform held", off=math.inf),
        Parameter("mass_kg", "kg", 2.5, 1e-3, 1e4, "that sways"),
        Parameter("height_above_com_m", "m", 0.33, -2.0, 20.0, "of the swaying mass"),
        Parameter("damping_ratio", "1", 0.03, 0.0, 0.5, "of the sway"),
    ),
    experiments=("free_response", "swivel"),
    acts={Site.BODY: force},
    grows=("mass_kg",),
    apart=True,
    # on the thesis' robot 1 Hz at least, 0.05 to 15 kg and -0.2 to 1.5 m, from 5 to 16 Hz, 1 kg and 0.3 m
    limits={
        "f_mast_Hz": (Sized(0.02, "/swing"), Sized(math.inf, "/swing")),
        "mass_kg": (Sized(1.0 / 600.0, "mass"), Sized(0.5, "mass")),
        "height_above_com_m": (Sized(-0.86, "height"), Sized(6.5, "height")),
    },
    probes=tuple(
        {
            "f_mast_Hz": Sized(turns, "/swing"),
            "mass_kg": Sized(0.033, "mass"),
            "height_above_com_m": Sized(1.3, "height"),
            "damping_ratio": 0.03,
        }
        for turns in (0.1, 0.14, 0.18, 0.24, 0.32)
    ),
)
