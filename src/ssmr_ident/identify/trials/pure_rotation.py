"""Pure rotations about the centre of mass (5.3), the thesis' model of a free response."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.signal import lfilter, lfilter_zi

from ssmr_ident.core.errors import InputError
from ssmr_ident.experiments.campaign import Measurement
from ssmr_ident.identify.body.output_error import START_SCALES
from ssmr_ident.physics.linear import accelerometer_rows, pure_rotations, responses
from ssmr_ident.physics.robot import GRAVITY, Robot
from ssmr_ident.physics.sensor import low_pass_coefficients

AXES = ("ax", "ay", "az")
_TURNING = np.array([0.0, 0.0, 0.0, 1.0, 1.0, 1.0] * 2)


def seen_axis(measurement: Measurement) -> str:
    """The channel that a pure rotation is read from (5.8): gravity for roll and pitch, the lever arm for yaw."""
    motion = measurement.entry.motion
    if motion is None:
        raise InputError(f"session entry {measurement.name}: motion", "is missing", "Give roll, pitch or yaw")
    return axis_of(motion)


def axis_of(motion: str) -> str:
    """The axis of the accelerometer that sees a rotation."""
    return {"roll": "ay", "pitch": "ax", "yaw": "ay"}[motion]


@dataclass(frozen=True)
class PureRotation:
    """Closed form, seen in one channel behind the accelerometer's low-pass."""

    channel: str

    def responses(self, robot: Robot, samples: int, step: float) -> np.ndarray:
        """Over the scaled starting state, (samples, 1, 12) float [m/s^2]."""
        model = pure_rotations(robot)
        rows = accelerometer_rows(model, robot.accelerometer.position, GRAVITY)[[AXES.index(self.channel)]]
        course: np.ndarray = responses(model.state_matrix, rows, step * np.arange(samples)) * (_TURNING * START_SCALES)
        c = low_pass_coefficients(robot.accelerometer.bandwidth_hz, step)
        if c[0] == 1.0:  # a sensor that passes everything
            return course
        forward, feedback = c[:3], np.array([1.0, c[3], c[4]])
        # the simulator's low-pass starts as if the first value had always been there
        settled = lfilter_zi(forward, feedback)[:, None, None] * course[:1]
        result: np.ndarray = lfilter(forward, feedback, course, axis=0, zi=settled)[0]
        return result
