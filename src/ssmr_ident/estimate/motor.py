"""A rig's motor in an inverse problem: what it is given in a recording, and the torque that it makes of that."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

import numpy as np

from ssmr_ident.core.parameter import ParameterSet
from ssmr_ident.estimate.coordinate import Coordinate
from ssmr_ident.experiments.campaign import Measurement
from ssmr_ident.physics.voltage_drive import DRIVE_KEYS, USUAL, Controller, Course, VoltageDrive, voltage

Array = np.ndarray

FIRST = 3
"""Place of the motor's constant among a rig's values, behind mass, damping and stiffness; resistance, armature and gear
ratio follow."""

VAGUE = 1.0
"""Standard deviation of the logarithm of a constant of which the file says no uncertainty."""

EXACTLY = 1e-9


@dataclass(frozen=True, eq=False)
class Given:
    """What a motor is given in a recording, on the fine grid of integration.

    Parameters
    ----------
    signal : (m,) float [V], or [rad] of a controller's goal
    on : (m,) float
        1 where the motor is connected.
    gain, limit : float [V/rad], [V]
        Of the controller; a gain of 0 where the voltage itself was logged.
    spread : float [V] or [rad]
        Standard deviation of the signal.
    """

    signal: Array
    on: Array
    gain: float
    limit: float
    spread: float

    def part(self, first: int, after: int) -> Given:
        """The same from one step to before another."""
        return replace(self, signal=self.signal[first:after], on=self.on[first:after])


def course_of(measurement: Measurement) -> Course | None:
    """What a recording says that the motor was given; None where it says nothing.

    A voltage that no entry names is the motor's where no force or torque drives.
    """
    recording, said = measurement.recording, measurement.entry.controller
    name = "voltage" if said is None else "position_reference"
    named = name in measurement.entry.channels or not {"force", "torque"} & set(recording.names)
    if name not in recording or not named:
        return None
    on = recording["enabled"] if "enabled" in recording else np.ones(len(recording.time))
    controller = None if said is None else Controller(said["kp_V_rad"], said.get("limit_V", math.inf))
    return Course(recording[name], on, controller)


def given_of(course: Course, at: Array) -> Given:
    """A course on the fine grid, whose places ``at``, (m,) float, are in samples."""
    places, held = np.arange(len(course.signal)), course.controller or Controller(0.0)
    signal, on = (np.interp(at, places, x) for x in (course.signal, course.on))
    return Given(signal, on, held.gain, held.limit, float(np.std(course.signal)))


def drive_coordinates(parameters: ParameterSet) -> tuple[Coordinate, ...]:
    """A drive's constant, resistance, armature and gear ratio with their priors; none where a file has no drive."""
    if DRIVE_KEYS[0] not in parameters:
        return ()
    found = []
    for key in DRIVE_KEYS:
        known, value = parameters.get(key), parameters.number(key, USUAL.get(key))
        if known is None or known.fixed or value == 0.0 or key == DRIVE_KEYS[3]:
            scale = value or 1.0
            found.append(
                Coordinate(key, scale, False, value, value, value / scale, EXACTLY, known.unit if known else "")
            )
        else:
            spread = known.std / value if known.std else VAGUE
            found.append(Coordinate(key, value, True, 0.01 * value, 100.0 * value, 0.0, spread, known.unit))
    return tuple(found)


def drive_of(values: Array) -> VoltageDrive | None:
    """The drive among a rig's values; None where there is none."""
    return VoltageDrive(*values[FIRST : FIRST + len(DRIVE_KEYS)].tolist()) if len(values) > FIRST else None


def armature(values: Array) -> Array:
    """What the armature adds to a rig's inertia [kg m^2], of values (…, k) float; nothing where there is no drive."""
    if values.shape[-1] <= FIRST:
        return np.zeros(values.shape[:-1])
    return np.asarray(values[..., FIRST + 3] ** 2 * values[..., FIRST + 2])


def torque_along(given: Given, every: int, path: Array, drive: VoltageDrive, zero: float = 0.0) -> Array:
    """Torque of the motor along a path [N m], (n,) float.

    Parameters
    ----------
    given : Given
    every : int
        Steps a sample.
    path : (n, ≥ 2) float
        Angle and its rate at the samples.
    drive : VoltageDrive
    zero : float [V] or [rad]
        Of the signal.
    """
    signal, on = given.signal[::every][: len(path)] + zero, given.on[::every][: len(path)]
    volts = np.array([voltage(s, x, given.gain, given.limit) for s, x in zip(signal, path[:, 0], strict=True)])
    return on * (drive.gain * volts - drive.braking * path[:, 1])
