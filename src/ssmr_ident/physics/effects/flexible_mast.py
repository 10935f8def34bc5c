"""A frame that sways on the platform."""

from __future__ import annotations

import math

from ssmr_ident.core.kernel import kernel
from ssmr_ident.core.parameter import Parameter
from ssmr_ident.physics.effect import Effect, Site


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
        Parameter("f_mast_Hz", "Hz", 9.0, 1.0, math.inf, "with the platform held", off=math.inf),
        Parameter("mass_kg", "kg", 2.5, 0.05, 15.0, "that sways"),
        Parameter("height_above_com_m", "m", 0.33, -0.2, 1.5, "of the swaying mass"),
        Parameter("damping_ratio", "1", 0.03, 0.0, 0.5, "of the sway"),
    ),
    experiments=("free_response", "swivel"),
    acts={Site.BODY: force},
    grows=("mass_kg",),
    apart=True,
    probes=(
        {"f_mast_Hz": 5.0, "mass_kg": 1.0, "height_above_com_m": 0.3, "damping_ratio": 0.03},
        {"f_mast_Hz": 7.0, "mass_kg": 1.0, "height_above_com_m": 0.3, "damping_ratio": 0.03},
        {"f_mast_Hz": 9.0, "mass_kg": 1.0, "height_above_com_m": 0.3, "damping_ratio": 0.03},
        {"f_mast_Hz": 12.0, "mass_kg": 1.0, "height_above_com_m": 0.3, "damping_ratio": 0.03},
        {"f_mast_Hz": 16.0, "mass_kg": 1.0, "height_above_com_m": 0.3, "damping_ratio": 0.03},
    ),
)
