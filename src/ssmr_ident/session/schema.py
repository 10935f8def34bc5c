"""The keys of a parameter file: unit, meaning, and what values make sense. The only place that lists them."""

from __future__ import annotations

from dataclasses import dataclass, replace

from ssmr_ident.core.domain import Choice, Domain, Number
from ssmr_ident.core.nested_domain import Listed


@dataclass(frozen=True)
class Key:
    """One key of robot.yaml: its unit, what it means, which values it may have, and its shape (``()`` for a number).

    ``zero_is_none`` marks what is absent at 0, which a file then says by ``fixed: true``: a fit would begin at it.
    """

    unit: str
    meaning: str
    each: Number | Choice
    shape: tuple[int, ...] = ()
    zero_is_none: bool = False

    @property
    def domain(self) -> Domain:
        """Of the value as a whole."""
        whole: Domain = replace(self.each, unit=self.unit) if isinstance(self.each, Number) else self.each
        for size in reversed(self.shape):
            whole = Listed(whole, size, size)
        return whole


# Beyond these a number is a slip: a factor of a thousand over the largest and under the smallest that is built.
_MASS = Number(least=1e-15, most=1e9)
_INERTIA = Number(least=1e-24, most=1e12)
_PRODUCT = Number(least=-1e12, most=1e12)
_STIFFNESS = Number(least=1e-12, most=1e13)
_SPRING = Number(least=0.0, most=1e13)
_STIFF_OR_RIGID = Number(least=1e-12, infinite=True)
_DAMPING = Number(least=0.0, most=1e12)
_LENGTH = Number(least=-1e4, most=1e4)
_FRICTION = Number(least=0.0, most=100.0)
_NOISE = Number(least=0.0, most=1e9)
_RATIO = Number(above=0.0, most=1e6)
_SIGN = Choice((1, -1))
_GAIN = Number(least=0.1, most=10.0)


def _inertia() -> dict[str, Key]:
    kinds = {
        axis: Key("kg m^2", f"moment of inertia about {axis[0]} through the CoM", _INERTIA)
        for axis in ("xx", "yy", "zz")
    }
    kinds |= {
        axis: Key("kg m^2", f"product of inertia {axis} (tensor element)", _PRODUCT) for axis in ("xy", "xz", "yz")
    }
    return {f"inertia_kg_m2.{axis}": key for axis, key in kinds.items()}


KEYS: dict[str, Key] = {
    "mass_kg": Key("kg", "mass of the whole robot, or of the rig's moving part", _MASS),
    **_inertia(),
    "inertia_kg_m2": Key("kg m^2", "moment of inertia of a rotary rig", _INERTIA),
    "stiffness_N_m": Key("N/m", "spring of a rig", _SPRING, zero_is_none=True),
    "damping_N_s_m": Key("N s/m", "viscous damper of a rig", _DAMPING),
    "stiffness_N_m_rad": Key("N m/rad", "spring of a rotary rig", _SPRING, zero_is_none=True),
    "damping_N_m_s_rad": Key("N m s/rad", "viscous damper of a rotary rig", _DAMPING),
    "drive.kt_N_m_A": Key(
        "N m/A", "torque of a rotary rig's motor per ampere, and its voltage per rad/s", Number(above=0.0, most=1e6)
    ),
    "drive.R_ohm": Key("ohm", "resistance of the motor's winding", Number(above=0.0, most=1e9)),
    "drive.armature_kg_m2": Key("kg m^2", "inertia of the motor itself, before its gears", Number(least=0.0, most=1e6)),
    "drive.gear_ratio": Key("1", "turns of the motor per turn of the joint; known exactly", _RATIO),
    "mu_static": Key("1", "static friction of a dragged block", _FRICTION),
    "mu_kinetic": Key("1", "kinetic friction of a dragged block", _FRICTION),
    "contact_points_m": Key(
        "m",
        "wheel contacts from the CoM, x forward, y left, z up; rear left, front left, front right, rear right",
        _LENGTH,
        (4, 3),
    ),
    "tire.stiffness_x_N_m": Key("N/m", "per wheel, along the rolling direction, tire and belt in series", _STIFFNESS),
    "tire.stiffness_y_N_m": Key("N/m", "per wheel, lateral", _STIFFNESS),
    "tire.stiffness_z_N_m": Key("N/m", "per wheel, vertical", _STIFFNESS),
    "tire.damping_x_N_s_m": Key("N s/m", "per wheel, along the rolling direction", _DAMPING),
    "tire.damping_y_N_s_m": Key("N s/m", "per wheel, lateral", _DAMPING),
    "tire.damping_z_N_s_m": Key("N s/m", "per wheel, vertical", _DAMPING),
    "tire.effective_mass_kg": Key("kg", "mass that moves with the contact patch", Number(least=0.0, most=1e9)),
    "tire.radius_m": Key("m", "wheel radius", Number(above=0.0, most=1e3)),
    "tire.mu_static": Key("1", "friction at which a sticking contact lets go", _FRICTION),
    "tire.mu_kinetic": Key("1", "friction at which a sliding contact sticks again", _FRICTION),
    "tire.sliding_speed_m_s": Key(
        "m/s",
        "sliding speed over which friction falls from mu_static to mu_kinetic, both axes together; 0: relay",
        Number(least=0.0, most=1e3),
    ),
    "tire.lambda_max": Key(
        "1", "longitudinal slip at which the grip is used up (eq 4.10-4.12)", Number(above=0.0, most=100.0)
    ),
    "motor.gain_1_s": Key(
        "1/s", "velocity controller: d(omega)/dt = gain (omega_ref - omega), eq 6.1", Number(above=0.0, most=1e6)
    ),
    "belt.stiffness_N_m": Key("N/m", "one drive belt, seen at the wheel's rim", _STIFF_OR_RIGID),
    "belt.damping_N_s_m": Key("N s/m", "one drive belt", _DAMPING),
    "cable.stiffness_N_m": Key("N/m", "pulling cable", _STIFF_OR_RIGID),
    "cable.damping_N_s_m": Key("N s/m", "pulling cable", _DAMPING),
    "accelerometer.position_m": Key("m", "from the CoM, body axes", _LENGTH, (3,)),
    "accelerometer.volts_zero": Key("V", "reading without acceleration", Number(least=-1e6, most=1e6)),
    "accelerometer.volts_per_m_s2": Key("V s^2/m", "sensitivity", Number(least=-1e9, most=1e9, nonzero=True)),
    "accelerometer.range_m_s2": Key("m/s^2", "clips beyond plus or minus this", Number(least=1e-9, infinite=True)),
    "accelerometer.bandwidth_hz": Key(
        "Hz", "-3 dB point of the second-order low-pass", Number(least=1e-9, infinite=True)
    ),
    "accelerometer.polarity.x": Key("1", "+1 or -1", _SIGN),
    "accelerometer.polarity.y": Key("1", "+1 or -1", _SIGN),
    "accelerometer.polarity.z": Key("1", "+1 or -1: at rest a z-up accelerometer reads +g", _SIGN),
    "accelerometer.gain.x": Key("1", "reading over what volts_per_m_s2 makes of it, 1 unless fitted", _GAIN),
    "accelerometer.gain.y": Key("1", "the same along y", _GAIN),
    "accelerometer.gain.z": Key("1", "the same along z", _GAIN),
    "floor.height_m": Key(
        "m", "rms height of the floor's fine unevenness, the calibration floor included", Number(least=0.0, most=1e3)
    ),
    "floor.length_m": Key("m", "correlation length of the floor's fine unevenness", Number(above=0.0, most=1e3)),
    "noise.white_m_s2": Key("m/s^2", "standard deviation per sample of the accelerometers", _NOISE),
    "noise.hum_m_s2": Key("m/s^2", "amplitude of the mains line on the accelerometers", _NOISE),
    "noise.load_N": Key("N", "standard deviation per sample of the load cell", _NOISE),
    "noise.force_N": Key("N", "standard deviation per sample of a measured force", _NOISE),
}

CHOICES: dict[str, tuple[Choice, str]] = {
    "tire.contact": (Choice(("printed_6_4", "relay", "cone")), "law under which a contact slides, in every experiment")
}
"""Keys whose value is a word, and what they mean. ``tire.contact``: (6.4) and N >= 0 (4.15) to the letter, a relay per
axis that lands on mu_k N, or Coulomb's cone; left out, each experiment takes its usual one."""

BLOCKS: frozenset[str] = frozenset(path.rsplit(".", 1)[0] for path in KEYS if "." in path) | {"accelerometer"}

_SPELLINGS = {
    "": "1", "-": "1", "none": "1", "kg*m^2": "kg m^2", "kg·m²": "kg m^2", "kg m²": "kg m^2",
    "kgm2": "kg m^2",
    "kg.m^2": "kg m^2", "N*s/m": "N s/m", "N·s/m": "N s/m", "Ns/m": "N s/m", "s^-1": "1/s", "m/s²": "m/s^2",
    "m/s2": "m/s^2", "N*m/rad": "N m/rad", "N·m/rad": "N m/rad", "Nm/rad": "N m/rad", "V s²/m": "V s^2/m",
    "V/(m/s^2)": "V s^2/m", "N*m*s/rad": "N m s/rad", "Nms/rad": "N m s/rad", "hz": "Hz", "N/m³": "N/m^3",
    "N*m/A": "N m/A", "N·m/A": "N m/A", "Nm/A": "N m/A", "Ω": "ohm", "Ohm": "ohm",
}  # fmt: skip


def canonical_unit(unit: object) -> str:
    """One spelling for a unit.

    >>> canonical_unit("kg·m²"), canonical_unit("")
    ('kg m^2', '1')
    """
    unit = str(unit).strip()
    return _SPELLINGS.get(unit, unit)
