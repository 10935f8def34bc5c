"""What may be left out of a robot, and how large: from the limit of what a session shows (0) to plain sight (1)."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from bank.laws import law
from bank.rig_physics import between

Values = dict[str, float]
Maker = Callable[[float, np.random.Generator], Values]


def _k3(size: float, random: np.random.Generator) -> Values:
    if random.random() < 0.25:
        return {"k3_N_m3": -between(size, 3e7, 3e8)}
    return {"k3_N_m3": between(size, 5e7, 2e9)}


def _turned(size: float, random: np.random.Generator) -> Values:
    axis = random.standard_normal(3)
    angles = between(size, 0.02, 0.2) * axis / np.linalg.norm(axis)
    return dict(zip(("angle_x_rad", "angle_y_rad", "angle_z_rad"), map(float, angles), strict=True))


def _offset(size: float, random: np.random.Generator) -> Values:
    # the file's own standard deviation is 5 mm: less than three of them is no contradiction
    length, angle = between(size, 0.018, 0.06), random.uniform(0.0, 2.0 * np.pi)
    return {"offset_x_m": float(length * np.cos(angle)), "offset_y_m": float(length * np.sin(angle))}


DECAYS: dict[str, Maker] = {
    "nonlinear_stiffness": _k3,
    "dry_friction": lambda size, random: {
        "F_c_N": between(size, 0.03, 1.2),
        "element_stiffness_N_m": random.uniform(1e5, 5e5),
    },
    "hysteresis": lambda size, random: {
        "alpha": 1.0 - between(size, 0.02, 0.3),
        "yield_m": random.uniform(2e-4, 8e-4),
    },
    "quadratic_damping": lambda size, random: {"d2_N_s2_m2": between(size, 15.0, 600.0)},
    "viscoelastic_relaxation": lambda size, random: {
        "K_m_N_m": between(size, 400.0, 7000.0),
        "tau_s": between(random.random(), 0.006, 0.1),
    },
    "flexible_mast": lambda size, random: {
        "f_mast_Hz": random.uniform(7.0, 14.0),
        "mass_kg": between(size, 0.2, 3.0),
        "height_above_com_m": random.uniform(0.25, 0.4),
        "damping_ratio": random.uniform(0.02, 0.05),
    },
    "free_play": lambda size, random: {
        "gap_m": between(size, 8e-6, 4e-4),
        "rounding": random.uniform(0.05, 0.3),
        "share_x": float(random.choice([0.0, 1.0])),
    },
    "com_offset": _offset,
    "wheel_lift": lambda size, random: {"active": 1.0},  # the releases are made large enough instead
    "motor_belt": lambda size, random: {
        "K_b_N_m": between(size, 1e5, 4e3),
        "D_b_N_s_m": random.uniform(20.0, 80.0),
        "rim_mass_kg": random.uniform(0.5, 1.5),
    },
    "sensor_saturation": lambda size, random: {"share_of_peak": between(size, 0.9, 0.4)},
    "sensor_bandwidth": lambda size, random: {"bandwidth_hz": between(size, 45.0, 12.0)},
    "sensor_misalignment": _turned,
}
PAIRS = (
    ("flexible_mast", "dry_friction"), ("nonlinear_stiffness", "dry_friction"), ("free_play", "quadratic_damping"),
    ("sensor_misalignment", "nonlinear_stiffness"), ("flexible_mast", "sensor_misalignment"),
    ("viscoelastic_relaxation", "dry_friction"), ("hysteresis", "flexible_mast"),
)  # fmt: skip

PULLS: dict[str, Maker] = {
    "cable_compliance": lambda size, random: {"K_cable_N_m": between(size, 3e6, 3e4)},
    "load_cell_drift": lambda size, random: {
        "zero_drift_N_s": between(size, 0.05, 3.0) * float(random.choice([-1.0, 1.0])),
        "gain_drift_1_s": 0.0,
    },
    "stribeck": lambda size, random: {
        "kinetic_share": 1.0 - between(size, 0.02, 0.35),
        "stribeck_velocity_m_s": random.uniform(1e-3, 6e-3),
    },
    "load_sensitive_friction": lambda size, random: {"exponent": between(size, 0.03, 0.35)},
    "nonlinear_stiffness": lambda size, random: {"k3_N_m3": between(size, 1e7, 8e8)},
    "hysteresis": lambda size, random: {
        "alpha": 1.0 - between(size, 0.05, 0.4),
        "yield_m": random.uniform(3e-4, 1.5e-3),
    },
    "viscoelastic_relaxation": lambda size, random: {
        "K_m_N_m": between(size, 500.0, 8000.0),
        "tau_s": between(random.random(), 0.5, 5.0),
    },
    "free_play": lambda size, random: {
        "gap_m": between(size, 5e-5, 1e-3),
        "rounding": random.uniform(0.05, 0.3),
        "share_x": 1.0,
    },
    "com_offset": _offset,
    "motor_belt": lambda size, random: {
        "K_b_N_m": between(size, 1e5, 3e3),
        "D_b_N_s_m": 50.0,
        "rim_mass_kg": 1.0,
    },
    "slip_coupling": lambda size, random: {"weight": between(size, 0.1, 1.0), "lambda_max": random.uniform(0.05, 0.3)},
    "sensor_saturation": lambda size, random: {"share_of_peak": between(size, 0.97, 0.6)},
}
SPINNING = ("slip_coupling",)
"""Seen only while the wheels turn. (So is rolling resistance, but along the robot, where the fixture holds it.)"""

BENCH = tuple(
    name
    for name in PULLS
    if name not in (*SPINNING, "load_sensitive_friction", "com_offset", "motor_belt", "free_play")
)

OTHER: dict[str, tuple[str, Callable[[float, float, np.random.Generator], np.ndarray]]] = {
    # formula: (id, law of one tire axis with stiffness k); an axis of another stiffness takes its own
    "hardening as two slopes": (
        "nonlinear_stiffness",
        lambda size, k, random: law("two_slopes", between(size, 0.05, 1.0) * k, random.uniform(3e-4, 8e-4)),
    ),
    "hardening as a sinh": (
        "nonlinear_stiffness",
        lambda size, k, random: law("sinh", between(size, 0.02, 0.6) * k, random.uniform(4e-4, 8e-4)),
    ),
    "softening as a tanh": (
        "nonlinear_stiffness",
        lambda size, k, random: law("tanh_spring", between(size, 0.03, 0.4) * k, random.uniform(6e-4, 1.5e-3)),
    ),
    "friction as the tanh of the velocity": (
        "dry_friction",
        lambda size, k, random: law("tanh_friction", between(size, 0.03, 1.0), random.uniform(5e-4, 3e-3)),
    ),
    "friction as a spring in series with a slider": (
        "dry_friction",
        lambda size, k, random: law("jenkins", between(size, 0.03, 1.0), random.uniform(5e4, 3e5)),
    ),
    "friction that is larger near rest": (
        "dry_friction",
        lambda size, k, random: law(
            "stribeck_friction", between(size, 0.03, 1.0), 1e-3, random.uniform(0.1, 0.5), 8e-3
        ),
    ),
    "play with sharp corners": (
        "free_play",
        lambda size, k, random: law("play", k, 0.5 * between(size, 8e-6, 4e-4)),
    ),
    "three sliders in parallel (Iwan)": (
        "hysteresis",
        lambda size, k, random: law("iwan", between(size, 0.02, 0.3) * k, random.uniform(2e-4, 8e-4)),
    ),
    "Bouc-Wen with exponent 1 and another beta": (
        "hysteresis",
        lambda size, k, random: law(
            "bouc_wen", between(size, 0.02, 0.3) * k, random.uniform(2e-4, 8e-4), 1.0, random.uniform(0.4, 0.9)
        ),
    ),
    "damping with |v|^1.8": (
        "quadratic_damping",
        lambda size, k, random: law("power_damping", between(size, 10.0, 350.0), 1.8),
    ),
    "relaxation with two branches": (
        "viscoelastic_relaxation",
        lambda size, k, random: law(
            "two_maxwells", between(size, 0.02, 0.2) * k, 8e-3, between(size, 0.02, 0.2) * k, 5e-2
        ),
    ),
}
UNLISTED: dict[str, tuple[str, Callable[[float, float, np.random.Generator], np.ndarray]]] = {
    "a damper that resists one way more than the other": (
        "unlisted",
        lambda size, k, random: law("one_sided_damper", between(size, 4.0, 40.0)),
    ),
    "a spring that touches on one side": (
        "unlisted",
        lambda size, k, random: law("one_sided_spring", between(size, 0.04, 0.5) * k, random.uniform(0.0, 2e-4)),
    ),
    "a stiffness that changes over each recording": (
        "unlisted",
        lambda size, k, random: law("creeping_spring", between(size, 0.01, 0.25) * k, 1.0),
    ),
    "dry friction on one side of the travel only": (
        "unlisted",
        lambda size, k, random: law("friction_by_place", between(size, 0.1, 2.0), 1e-3, 5e-5),
    ),
}


@dataclass(frozen=True)
class Left:
    """What a robot session leaves out: catalogue effects, or laws for the bank's own plant."""

    effects: dict[str, Values]
    rows: tuple[np.ndarray, np.ndarray, np.ndarray] | None = None
    formula: str = ""

    @property
    def ids(self) -> tuple[str, ...]:
        return tuple(self.effects)
