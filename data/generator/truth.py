"""The robots that the recordings are made with, and what a lab would know of them.

Every truth lies within 1.5 of the standard deviations that the lab's robot.yaml states.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from ssmr_ident.core.parameter import Estimate, ParameterSet
from ssmr_ident.session import read_parameters

FLOORS = ("concrete", "tile", "carpet")

# What a lab would state of each floor: mu_static from pulls (thesis section 3.3: 0.86 and 0.98), troughs roughly.
# Tile is not in the thesis; its numbers are ours.
KNOWN_FRICTION = {"concrete": (0.86, 0.62), "tile": (0.80, 0.56), "carpet": (0.98, 0.70)}
KNOWN_FRICTION_STD = (0.05, 0.10)

# What the floors are. The grip's slip limit differs most: soft pile gives way early, hard floors late.
TRUE_FLOOR = {
    "concrete": {"tire.mu_static": 0.835, "tire.mu_kinetic": 0.60, "tire.lambda_max": 0.5},
    "tile": {"tire.mu_static": 0.745, "tire.mu_kinetic": 0.53, "tire.lambda_max": 0.8},
    "carpet": {"tire.mu_static": 1.015, "tire.mu_kinetic": 0.73, "tire.lambda_max": 0.1},
}

_TRUE_TIRES = {
    "tire.stiffness_x_N_m": 3300.0,
    "tire.stiffness_y_N_m": 16200.0,
    "tire.stiffness_z_N_m": 83500.0,
    "tire.damping_x_N_s_m": 48.0,
    "tire.damping_y_N_s_m": 33.0,
    "tire.damping_z_N_s_m": 86.0,
    "tire.radius_m": 0.1105,
    "accelerometer.volts_zero": 2.607,
    "accelerometer.volts_per_m_s2": 0.1518,
}

_TRUE_BODY: dict[str, dict[str, object]] = {
    "frame": {
        "mass_kg": 31.3,
        "inertia_kg_m2.xx": 1.14,
        "inertia_kg_m2.yy": 1.49,
        "inertia_kg_m2.zz": 0.83,
        "inertia_kg_m2.xy": 0.0008,
        "inertia_kg_m2.xz": -0.045,
        "inertia_kg_m2.yz": -0.0015,
        "contact_points_m": np.array(
            [[-0.144, 0.18, -0.228], [0.136, 0.18, -0.228], [0.136, -0.18, -0.228], [-0.144, -0.18, -0.228]]
        ),
        "accelerometer.position_m": np.array([-0.203, 0.003, 0.004]),
    },
    "platform": {
        "mass_kg": 22.6,
        "inertia_kg_m2.xx": 0.38,
        "inertia_kg_m2.yy": 0.52,
        "inertia_kg_m2.zz": 0.60,
        "inertia_kg_m2.xz": -0.01,
        "contact_points_m": np.array(
            [[-0.141, 0.18, -0.156], [0.139, 0.18, -0.156], [0.139, -0.18, -0.156], [-0.141, -0.18, -0.156]]
        ),
        "accelerometer.position_m": np.array([-0.203, 0.003, 0.085]),
    },
}
_BUNDLED = {"frame": "p3at-extended", "platform": "p3at-platform"}

WHITE_M_S2 = 0.02  # per sample at 1 kHz: 3 mV, between the converter's 1.2 mV and what a hand-built cube picks up
HUM_M_S2 = 0.06  # 9 mV of mains, the order that made the thesis low-pass its swivels at 50 Hz
INTEGRATION_STEP = 1e-4  # s, written down: stick-slip would not repeat with another
LOAD_N = 0.3  # a 50 kN load cell resolves better than it stays still
LOAD_QUANTUM_N = 1e-3  # thesis section 1


def lab_robot(frame: str, floor: str | None = None) -> ParameterSet:
    """What a lab knows before the campaign: the bundled robot, weighed, with its floor's friction.

    Parameters
    ----------
    frame : str
        ``frame`` or ``platform``.
    floor : str, optional
        Left out, friction is concrete's with a spread that covers all three floors.
    """
    bundled = read_parameters(_BUNDLED[frame])
    static, kinetic = KNOWN_FRICTION[floor or "concrete"]
    spread = KNOWN_FRICTION_STD if floor else (0.15, 0.15)
    source = f"lateral pulls on {floor}" if floor else "concrete; the floors differ"
    mass = Estimate(31.0, 0.4, "kg", "weighed") if frame == "frame" else bundled["mass_kg"]
    return replace(
        bundled.updated(
            {
                "mass_kg": mass,
                "tire.mu_static": Estimate(static, spread[0], "1", source),
                "tire.mu_kinetic": Estimate(kinetic, spread[1], "1", f"troughs of the saw-tooth, {source}"),
                "noise.white_m_s2": Estimate(0.02, 0.01, "m/s^2", "quiet ends of the decays"),
                "noise.hum_m_s2": Estimate(0.05, 0.03, "m/s^2", "quiet ends of the decays"),
                "noise.load_N": Estimate(0.3, 0.1, "N", "load cell at rest"),
            }
        ),
        name=f"{_BUNDLED[frame]}{f' on {floor}' if floor else ''}",
    )


def true_robot(frame: str, floor: str = "concrete") -> ParameterSet:
    """What the recordings are made with."""
    lab = lab_robot(frame, floor)
    values: dict[str, object] = {
        **_TRUE_TIRES,
        **_TRUE_BODY[frame],
        **TRUE_FLOOR[floor],
        "noise.white_m_s2": WHITE_M_S2,
        "noise.hum_m_s2": HUM_M_S2,
        "noise.load_N": LOAD_N,
    }
    exact = {
        key: Estimate(values.get(key, entry.value), None, entry.unit, "the generator's", fixed=True)  # type: ignore[arg-type]
        for key, entry in lab.items()
    }
    return ParameterSet(f"truth: {lab.name}", exact, provenance={"synthetic": True, "made_by": "data/make_raw.py"})


def on_flat_relays(parameters: ParameterSet) -> ParameterSet:
    """The same robot, whose file also names what swivels are simulated by: the relay (6.4) on a flat floor."""
    flat = {"floor.height_m": Estimate(0.0, None, "m", "the generator's", fixed=True)}
    return replace(parameters.updated(flat), choices={"tire.contact": "relay"})
