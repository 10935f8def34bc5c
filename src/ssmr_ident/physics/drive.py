"""Torques of the motors and forces at the wheels, one from the other (6.2)-(6.3), and T_f of (2.65).

The source's digest names (6.2)-(6.3) without printing them. Wheels without inertia carry τ = r·f, and both wheels of a
side sit on one motor.
"""

from __future__ import annotations

import numpy as np


def motor_torques(forces_x: np.ndarray, left: np.ndarray, radius: float) -> np.ndarray:
    """Torque of the left and the right motor [N m] for forces of the floor on the wheels along x (6.2).

    Parameters
    ----------
    forces_x : (..., 4) float [N]
    left : (4,) bool
        Wheels of the left motor.
    radius : float [m]

    Returns
    -------
    (..., 2) float [N m]
    """
    forces, left = np.asarray(forces_x, dtype=float), np.asarray(left, dtype=bool)
    return radius * np.stack([forces[..., left].sum(axis=-1), forces[..., ~left].sum(axis=-1)], axis=-1)


def drive_matrix(radius: float, half_track: float) -> np.ndarray:
    """T_f of (2.65): wrench (F_x, F_y, F_z, M_x, M_y, M_z) of the motors' torques (left, right), (6, 2) float.

    M_y is that about the contact's height and comes with the reaction wrench (2.53), which knows where wheels stand.
    """
    matrix = np.zeros((6, 2))
    matrix[0] = 1.0 / radius
    matrix[5] = -half_track / radius, half_track / radius
    return matrix


def torques_for(force_x: float, yaw_moment: float, radius: float, half_track: float) -> np.ndarray:
    """Torques (left, right) that push with F_x and turn with M_z: T_f the other way round (6.3), (2,) float [N m].

    >>> torques_for(10.0, 0.0, 0.1, 0.2)
    array([0.5, 0.5])
    """
    turning = yaw_moment / half_track
    return 0.5 * radius * np.array([force_x - turning, force_x + turning])
