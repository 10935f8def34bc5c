"""The keys of a parameter file: unit, meaning, and what values make sense. The only place that lists them."""

from __future__ import annotations

import math
from dataclasses import dataclass


@dataclass(frozen=True)
class Key:
    """One key of robot.yaml: its unit, what it means, its least value, and its shape (``()`` for a number)."""

    unit: str
    meaning: str
    lower: float = -math.inf
    shape: tuple[int, ...] = ()


def _inertia() -> dict[str, Key]:
    kinds = {
        axis: Key("kg m^2", f"moment of inertia about {axis[0]} through the CoM", 0.0) for axis in ("xx", "yy", "zz")
    }
    kinds |= {axis: Key("kg m^2", f"product of inertia {axis} (tensor element)") for axis in ("xy", "xz", "yz")}
    return {f"inertia_kg_m2.{axis}": key for axis, key in kinds.items()}


KEYS: dict[str, Key] = {
    "mass_kg": Key("kg", "mass of the whole robot, or of the rig's moving part", 0.0),
    **_inertia(),
    "inertia_kg_m2": Key("kg m^2", "moment of inertia of a rotary rig", 0.0),
    "stiffness_N_m": Key("N/m", "spring of a rig", 0.0),
    "damping_N_s_m": Key("N s/m", "viscous damper of a rig"),
    "stiffness_N_m_rad": Key("N m/rad", "spring of a rotary rig", 0.0),
    "damping_N_m_s_rad": Key("N m s/rad", "viscous damper of a rotary rig"),
    "mu_static": Key("1", "static friction of a dragged block", 0.0),
    "mu_kinetic": Key("1", "kinetic friction of a dragged block", 0.0),
    "contact_points_m": Key(
        "m",
        "wheel contacts from the CoM, x forward, y left, z up; rear left, front left, front right, rear right",
        shape=(4, 3),
    ),
    "tire.stiffness_x_N_m": Key("N/m", "per wheel, along the rolling direction, tire and belt in series", 0.0),
    "tire.stiffness_y_N_m": Key("N/m", "per wheel, lateral", 0.0),
    "tire.stiffness_z_N_m": Key("N/m", "per wheel, vertical", 0.0),
    "tire.damping_x_N_s_m": Key("N s/m", "per wheel, along the rolling direction"),
    "tire.damping_y_N_s_m": Key("N s/m", "per wheel, lateral"),
    "tire.damping_z_N_s_m": Key("N s/m", "per wheel, vertical"),
    "tire.effective_mass_kg": Key("kg", "mass that moves with the contact patch", 0.0),
    "tire.radius_m": Key("m", "wheel radius", 0.0),
    "tire.mu_static": Key("1", "friction at which a sticking contact lets go", 0.0),
    "tire.mu_kinetic": Key("1", "friction at which a sliding contact sticks again", 0.0),
    "tire.sliding_speed_m_s": Key(
        "m/s", "sliding speed over which friction falls from mu_static to mu_kinetic, both axes together; 0: relay", 0.0
    ),
    "tire.lambda_max": Key("1", "longitudinal slip at which the grip is used up (eq 4.10-4.12)", 0.0),
    "motor.gain_1_s": Key("1/s", "velocity controller: d(omega)/dt = gain (omega_ref - omega), eq 6.1", 0.0),
    "belt.stiffness_N_m": Key("N/m", "one drive belt, seen at the wheel's rim", 0.0),
    "belt.damping_N_s_m": Key("N s/m", "one drive belt", 0.0),
    "cable.stiffness_N_m": Key("N/m", "pulling cable", 0.0),
    "cable.damping_N_s_m": Key("N s/m", "pulling cable", 0.0),
    "accelerometer.position_m": Key("m", "from the CoM, body axes", shape=(3,)),
    "accelerometer.volts_zero": Key("V", "reading without acceleration"),
    "accelerometer.volts_per_m_s2": Key("V s^2/m", "sensitivity"),
    "accelerometer.range_m_s2": Key("m/s^2", "clips beyond plus or minus this", 0.0),
    "accelerometer.bandwidth_hz": Key("Hz", "-3 dB point of the second-order low-pass", 0.0),
    "accelerometer.polarity.x": Key("1", "+1 or -1"),
    "accelerometer.polarity.y": Key("1", "+1 or -1"),
    "accelerometer.polarity.z": Key("1", "+1 or -1: at rest a z-up accelerometer reads +g"),
    "accelerometer.gain.x": Key("1", "reading over what volts_per_m_s2 makes of it, 1 unless fitted", 0.1),
    "accelerometer.gain.y": Key("1", "the same along y", 0.1),
    "accelerometer.gain.z": Key("1", "the same along z", 0.1),
    "floor.height_m": Key("m", "rms height of the floor's fine unevenness, the calibration floor included", 0.0),
    "floor.length_m": Key("m", "correlation length of the floor's fine unevenness", 0.0),
    "noise.white_m_s2": Key("m/s^2", "standard deviation per sample of the accelerometers", 0.0),
    "noise.hum_m_s2": Key("m/s^2", "amplitude of the mains line on the accelerometers", 0.0),
    "noise.load_N": Key("N", "standard deviation per sample of the load cell", 0.0),
    "noise.force_N": Key("N", "standard deviation per sample of a measured force", 0.0),
}

BLOCKS: frozenset[str] = frozenset(path.rsplit(".", 1)[0] for path in KEYS if "." in path) | {"accelerometer"}

_SPELLINGS = {
    "": "1", "-": "1", "none": "1", "kg*m^2": "kg m^2", "kg·m²": "kg m^2", "kg m²": "kg m^2",
    "kgm2": "kg m^2",
    "kg.m^2": "kg m^2", "N*s/m": "N s/m", "N·s/m": "N s/m", "Ns/m": "N s/m", "s^-1": "1/s", "m/s²": "m/s^2",
    "m/s2": "m/s^2", "N*m/rad": "N m/rad", "N·m/rad": "N m/rad", "Nm/rad": "N m/rad", "V s²/m": "V s^2/m",
    "V/(m/s^2)": "V s^2/m", "N*m*s/rad": "N m s/rad", "Nms/rad": "N m s/rad", "hz": "Hz", "N/m³": "N/m^3",
}  # fmt: skip


def canonical_unit(unit: str) -> str:
    """One spelling for a unit.

    >>> canonical_unit("kg·m²"), canonical_unit("")
    ('kg m^2', '1')
    """
    unit = str(unit).strip()
    return _SPELLINGS.get(unit, unit)
