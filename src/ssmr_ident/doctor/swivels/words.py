"""The laws of swivels' effects in plain text, for reports that cannot set formulas."""

from __future__ import annotations

from collections.abc import Iterable

EQUATIONS = {
    "ground_roughness": "<h(r) h(r + d)> = height^2 exp(-(d/length)^2)",
    "ground_joints": "h(path) = -depth sum_j exp(-(path - (j + 1/2) pitch)^2/(2 sigma^2)), sigma = width/4",
    "wheel_eccentricity": "h_i = e sin(wheel angle_i + i pi/2)",
    "flexible_mast": "m q'' = -m w^2 q - 2 zeta m w q' - m x_P'', w = 2 pi f_mast",
    "com_offset": "p_i -> p_i - (offset_x, offset_y, 0)",
    "wheel_lift": "N = max(0, K_z s_z + D_z s_z')",
    "motor_belt": "m_rim b'' = -K_b b - D_b b' + sum of F_x over the side",
    "stribeck": "mu(u) -> mu(u) (r + (1 - r) exp(-(u/v_s)^2)), r = kinetic_share",
    "load_sensitive_friction": "mu(N) = mu (N/N_0)^(-exponent), N_0 = m g/4",
    "slip_coupling": "mu -> mu min(|slip|/(lambda_max |r omega|), 1)",
    "rolling_resistance": "F_x = -c_rr N sign(v_x)",
    "coriolis": "M V' + M V^ V = F",
    "sensor_saturation": "y = max(-range, min(range, a))",
    "sensor_bandwidth": "H(s) = 1/(1 + sqrt(2) s/w + (s/w)^2), w = 2 pi bandwidth",
    "sensor_misalignment": "a_log = (R_z R_y R_x)^T a",
}

UNLISTED_WORDS = {"smooth force": "a smooth force of the tires", "loops": "a force of the tires with loops"}
UNLISTED_EQUATIONS = {
    "smooth force": "F = K·s + D·v + {k3_N_m3:.3g}·s³ + {d2_N_s2_m2:.3g}·v·|v|   (each tire; N, m, s)",
    "loops": "F = {alpha:.3g}·K·s + (1 - {alpha:.3g})·K·z + D·v, |z| < {yield_m:.3g}   (each tire; N, m, s)",
}


def unlisted_form(parameters: Iterable[str]) -> str:
    """Which of the unlisted laws has these parameters.

    >>> unlisted_form({"alpha": 0.5, "yield_m": 4e-4}), unlisted_form({"k3_N_m3": 1e9, "d2_N_s2_m2": 10.0})
    ('loops', 'smooth force')
    """
    return "loops" if "alpha" in parameters else "smooth force"
