"""A motor with gears on a rotary rig, driven by a voltage, and the proportional controller that may give it."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from ssmr_ident.core.errors import InputError
from ssmr_ident.core.kernel import kernel
from ssmr_ident.core.parameter import ParameterSet

DRIVE = "drive"
"""Block of a parameter file that describes it."""

DRIVE_KEYS = tuple(f"{DRIVE}.{name}" for name in ("kt_N_m_A", "R_ohm", "armature_kg_m2", "gear_ratio"))
USUAL = {DRIVE_KEYS[2]: 0.0, DRIVE_KEYS[3]: 1.0}
"""What a file need not say: an armature that the rig's inertia holds already, and a motor seen at the joint."""


@dataclass(frozen=True)
class VoltageDrive:
    """A brushed motor whose inductance is too small to be seen.

    Parameters
    ----------
    constant : float [N m/A]
        Torque per ampere, and voltage per rad/s of the motor.
    resistance : float [ohm]
    armature : float [kg m^2]
    ratio : float
        Turns of the motor per turn of the joint.
    """

    constant: float
    resistance: float
    armature: float = 0.0
    ratio: float = 1.0

    @property
    def gain(self) -> float:
        """Torque at the joint per volt, at rest [N m/V]."""
        return self.ratio * self.constant / self.resistance

    @property
    def braking(self) -> float:
        """Torque at the joint that the motor's own voltage takes, per rad/s [N m s/rad]."""
        return (self.ratio * self.constant) ** 2 / self.resistance

    @property
    def inertia(self) -> float:
        """Of the armature, seen at the joint [kg m^2]."""
        return self.ratio**2 * self.armature


@dataclass(frozen=True)
class Controller:
    """u = kp (goal - angle), limited either way.

    Parameters
    ----------
    gain : float [V/rad]
    limit : float [V]
    """

    gain: float
    limit: float = math.inf


@dataclass(frozen=True, eq=False)
class Course:
    """What a drive is given, sample by sample.

    Parameters
    ----------
    signal : (n,) float [V], or [rad] of a controller's goal
    on : (n,) float
        1 where the motor is connected, 0 where it is open.
    controller : Controller or None
    """

    signal: np.ndarray
    on: np.ndarray
    controller: Controller | None = None


@kernel
def voltage(signal, x, gain, limit):
    """What the motor is given [V]: ``signal`` itself where ``gain`` is 0, else what a controller makes of it as a goal.

    signal : float [V] or [rad], x : float [rad], gain : float [V/rad], limit : float [V].
    """
    if gain == 0.0:
        return signal
    return min(max(gain * (signal - x), -limit), limit)


@kernel
def torque(volts, v, on, gain, braking):
    """Torque at the joint [N m].

    volts : float [V], v : float [rad/s], on : float, 0 of an open motor, gain : float [N m/V], braking : [N m s/rad].
    """
    return on * (gain * volts - braking * v)


def drive_from_parameters(parameters: ParameterSet) -> VoltageDrive | None:
    """The drive that a parameter file describes; None where it has none.

    Raises
    ------
    InputError
        A key is missing.
    """
    if not any(key in parameters for key in DRIVE_KEYS):
        return None
    for key in DRIVE_KEYS:
        if key not in parameters and key not in USUAL:
            where = f"{parameters.file or parameters.name}: {key}"
            raise InputError(where, "is missing", f"Write {key.partition('.')[2]}: {{value: …, std: …}} below {DRIVE}")
    return VoltageDrive(*(parameters.number(key, USUAL.get(key)) for key in DRIVE_KEYS))
