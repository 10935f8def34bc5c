"""The body together with a mast that sways on it."""

from __future__ import annotations

import math

import numpy as np

from ssmr_ident.core.errors import Impossible
from ssmr_ident.core.kernel import kernel
from ssmr_ident.physics.effects import flexible_mast
from ssmr_ident.physics.robot import Robot
from ssmr_ident.physics.slots import MAST_DAMPING, MAST_HZ, MAST_MASS, Effects

_force = flexible_mast.force


def inverse_mass_matrix(robot: Robot, active: Effects) -> np.ndarray:
    """Inverse mass matrix of body and swaying mast in body axes; total mass and inertia hold with it locked.

    Returns
    -------
    (8, 8) float
        Rows of the CoM's acceleration (3), the angular acceleration (3), and the sway's (x, y); the identity while
        the mast is stiff.

    Raises
    ------
    Impossible
        The mast is heavier or higher than the robot's mass and inertia hold.
    """
    values = active.get("flexible_mast")
    if not values or math.isinf(values["f_mast_Hz"]):
        return np.eye(8)
    mass, height = values["mass_kg"], values["height_above_com_m"]
    matrix = np.zeros((8, 8))
    matrix[:3, :3] = robot.mass * np.eye(3)
    matrix[3:6, 3:6] = robot.inertia
    matrix[6:, 6:] = mass * np.eye(2)
    coupling = np.zeros((6, 2))
    coupling[0, 0] = coupling[1, 1] = mass
    coupling[4, 0], coupling[3, 1] = mass * height, -mass * height  # p × e_x and p × e_y with p = (0, 0, height)
    matrix[:6, 6:], matrix[6:, :6] = coupling, coupling.T
    if np.linalg.eigvalsh(matrix)[0] <= 0.0:
        raise Impossible(
            "effects: flexible_mast",
            f"{mass:g} kg at {height:g} m is more than the robot's mass and inertia hold",
            "Give a lighter or lower mast",
        )
    return np.linalg.inv(matrix)


@kernel
def accelerate_with_mast(inverse, e, sway, sway_rate, force, torque, gravity, out):
    """Accelerations of body and mast, all along the body axes.

    Parameters
    ----------
    inverse : (8, 8) float
    e : (SLOTS,) float
    sway, sway_rate : (float, float) [m], [m/s]
    force, torque : (float, float, float) [N], [N m]
        On the body with the mast locked, weight included.
    gravity : (float, float, float) [m/s^2]
    out : (1, 8) float
        Filled: CoM [m/s^2], rates [rad/s^2], sway [m/s^2].
    """
    mass = e[MAST_MASS]
    right = (
        force[0],
        force[1],
        force[2],
        torque[0] + mass * sway[1] * gravity[2],
        torque[1] - mass * sway[0] * gravity[2],
        torque[2] + mass * (sway[0] * gravity[1] - sway[1] * gravity[0]),
        _force(sway[0], sway_rate[0], mass, e[MAST_HZ], e[MAST_DAMPING]) + mass * gravity[0],
        _force(sway[1], sway_rate[1], mass, e[MAST_HZ], e[MAST_DAMPING]) + mass * gravity[1],
    )
    for j in range(8):
        total = 0.0
        for k in range(8):
            total += inverse[j, k] * right[k]
        out[0, j] = total
