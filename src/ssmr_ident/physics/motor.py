"""Wheel speeds asked for, from the motion wanted."""

from __future__ import annotations

import numpy as np

from ssmr_ident.physics.robot import Robot


def wheel_rates(robot: Robot, speed: float, yaw_rate: float) -> np.ndarray:
    """Invert (2.11) without slip: rates of the left and right wheels for a wanted motion.

    Parameters
    ----------
    speed : float [m/s]
        Forward.
    yaw_rate : float [rad/s]
        Positive to the left.

    Returns
    -------
    (2,) float [rad/s]
        Left, right.
    """
    return np.array([speed - robot.half_track * yaw_rate, speed + robot.half_track * yaw_rate]) / robot.radius
