"""What a robot's accelerometers show of a small free motion, as a sum of exponentials with explicit gains."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from ssmr_ident.physics.linear import accelerometer_rows, linear_robot
from ssmr_ident.physics.robot import GRAVITY, Robot
from ssmr_ident.physics.sensor import low_pass_coefficients

Array = np.ndarray


@dataclass(frozen=True, eq=False)
class BodyResponse:
    """Free response of the body on sticking tires, y(t) = Σ_k Re(shape_k e^(s_k t) left_k · x_0).

    Parameters
    ----------
    poles : (k,) complex [1/s]
        With imaginary part ≥ 0; of conjugate pairs only one.
    shapes : (3, k) complex
        Output in ax, ay, az of each eigenvector, twice that of a pair.
    left : (k, 12) complex
        Rows that take the starting state (q, q') apart.
    """

    poles: Array
    shapes: Array
    left: Array

    def waves(self, times: Array) -> Array:
        """(n, 2k) float: real and imaginary parts of e^(st) on an even grid.

        A geometric sequence, made as an outer product of two short ones.
        """
        count = len(times)
        fine = math.isqrt(count) + 1
        coarse = -(-count // fine)
        step = float(times[1] - times[0])
        inner = np.exp(np.outer(np.arange(fine) * step, self.poles))
        outer = np.exp(np.outer(times[0] + np.arange(coarse) * (fine * step), self.poles))
        complex_waves = (outer[:, None, :] * inner[None, :, :]).reshape(-1, len(self.poles))[:count]
        return np.hstack([complex_waves.real, complex_waves.imag])

    def weights(self, gains: Array, axes: tuple[int, ...]) -> Array:
        """(c, 2k, 12) float: ``waves @ weights[c]`` are the channel's columns over the starting state.

        Parameters
        ----------
        gains : (c, k) complex
            What sensor, averaging and whitening make of each exponential.
        axes : tuple of int
        """
        complex_weights = (self.shapes[list(axes)] * gains)[:, :, None] * self.left[None, :, :]
        return np.concatenate([complex_weights.real, -complex_weights.imag], axis=1)

    def weights_of(self, gains: Array, axes: tuple[int, ...], start: Array) -> Array:
        """(2k, c) float: ``weights @ start`` of all channels."""
        complex_weights = self.shapes[list(axes)] * gains * (self.left @ start)
        return np.concatenate([complex_weights.real, -complex_weights.imag], axis=1).T


def body_response(robot: Robot) -> BodyResponse:
    """Linearise a robot and take its motion apart.

    Parameters
    ----------
    robot : Robot
    """
    linear = linear_robot(robot)
    poles, vectors = np.linalg.eig(linear.state_matrix)
    left = np.linalg.inv(vectors)
    keep = poles.imag >= 0
    rows = accelerometer_rows(linear, robot.accelerometer.position, GRAVITY)
    shapes = rows @ vectors[:, keep] * np.where(poles[keep].imag > 0, 2.0, 1.0)
    return BodyResponse(poles[keep], shapes, left[keep])


def sensor_gains(poles: Array, bandwidth_hz: float, step: float) -> Array:
    """What the accelerometer's low-pass makes of e^(st) once its own transient is over, (k,) complex."""
    b0, b1, b2, a1, a2 = low_pass_coefficients(bandwidth_hz, step)
    delay = np.exp(-np.asarray(poles) * step)
    result: Array = (b0 + b1 * delay + b2 * delay**2) / (1 + a1 * delay + a2 * delay**2)
    return result
