"""The plane with a constraint: A(q)·q̇ = 0, q̇ = S(q)·η, and the reduced model of chapter 2.

A skid-steered robot whose sideways skid is bounded turns about points at one distance x_0 ahead of its CoM:
v_y = −x_0·ω. That is one constraint on q = (X, Y, θ); S spans what is left, η = (v_x, ω). The source's digest names A,
S and the reduced model without printing them; derived here, in the form of K. Kozłowski and D. Pazderski (Int. J.
Appl. Math. Comput. Sci. 14(4), 2004).
"""

from __future__ import annotations

import math

import numpy as np


def constraint(heading: float, ahead: float) -> np.ndarray:
    """A(q): the row with A·(Ẋ, Ẏ, θ̇) = v_y + x_0·ω, (1, 3) float.

    Parameters
    ----------
    heading : float [rad]
    ahead : float [m]
        x_0.
    """
    return np.array([[-math.sin(heading), math.cos(heading), ahead]])


def free_directions(heading: float, ahead: float) -> np.ndarray:
    """S(q) with A·S = 0: (Ẋ, Ẏ, θ̇) = S·(v_x, ω), (3, 2) float."""
    sin, cos = math.sin(heading), math.cos(heading)
    return np.array([[cos, ahead * sin], [sin, -ahead * cos], [0.0, 1.0]])


def free_directions_rate(heading: float, ahead: float, turning: float) -> np.ndarray:
    """dS/dt at the yaw rate ``turning`` [rad/s], (3, 2) float."""
    sin, cos = math.sin(heading), math.cos(heading)
    return turning * np.array([[-sin, ahead * cos], [cos, ahead * sin], [0.0, 0.0]])


def reduced_acceleration(
    mass: float, yaw_inertia: float, ahead: float, motion: np.ndarray, wrench: np.ndarray
) -> np.ndarray:
    """η̇ of SᵀMS·η̇ + SᵀMṠ·η = Sᵀ·F: the constraint's force drops out, as A·S = 0.

    Parameters
    ----------
    mass, yaw_inertia : float [kg], [kg m^2]
    ahead : float [m]
        x_0, constant.
    motion : (2,) float [m/s, rad/s]
        η = (v_x, ω).
    wrench : (3,) float [N, N, N m]
        Forward, sideways and yaw moment of all that acts but the constraint, robot axes.

    Returns
    -------
    (2,) float [m/s^2, rad/s^2]
    """
    inertia = np.diag([mass, mass, yaw_inertia])
    directions = free_directions(0.0, ahead)  # the same for every heading, so in the robot's axes
    rate = free_directions_rate(0.0, ahead, float(motion[1]))
    return np.linalg.solve(
        directions.T @ inertia @ directions, directions.T @ (np.asarray(wrench) - inertia @ rate @ motion)
    )


def constraint_force(mass: float, yaw_inertia: float, ahead: float, motion: np.ndarray, wrench: np.ndarray) -> float:
    """Sideways force [N] with which the constraint holds: the multiplier of A in M·q̈ = F + Aᵀ·λ."""
    _, turning_faster = reduced_acceleration(mass, yaw_inertia, ahead, motion, wrench)
    sideways = -ahead * turning_faster + motion[0] * motion[1]
    return float(mass * sideways - wrench[1])
