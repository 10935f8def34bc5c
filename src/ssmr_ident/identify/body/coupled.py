"""Free vibration of the body on four tires with translation: the derived form of (5.11), and all six axes at once.

``plane_modes`` is the determinant of section 5 (roll with lateral, pitch with longitudinal motion);
``body_modes`` takes contact points as they are (a ≠ b, products of inertia). For a symmetric robot both agree.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ssmr_ident.physics.linear import linear_robot
from ssmr_ident.physics.robot import GRAVITY, Robot


@dataclass(frozen=True)
class Modes:
    """Natural frequencies and damping ratios.

    Parameters
    ----------
    natural : (k,) float [rad/s]
        Ascending.
    xi : (k,) float [1]
    shapes : (k, n) float
        Kinetic-energy share of each axis in each mode.
    """

    natural: np.ndarray
    xi: np.ndarray
    shapes: np.ndarray


def vibration_modes(mass: np.ndarray, damping: np.ndarray, stiffness: np.ndarray) -> Modes:
    """Oscillating modes of M q̈ + D q̇ + K q = 0; over-damped ones are left out.

    Parameters
    ----------
    mass, damping, stiffness : (n, n) float
    """
    count = len(mass)
    inverse = np.linalg.inv(mass)
    state = np.block([[np.zeros((count, count)), np.eye(count)], [-inverse @ stiffness, -inverse @ damping]])
    poles, vectors = np.linalg.eig(state)
    keep = np.flatnonzero(poles.imag > 1e-9)
    keep = keep[np.argsort(np.abs(poles[keep]))]
    natural = np.abs(poles[keep])
    velocity = vectors[:count, keep]
    energy = np.real(np.conj(velocity) * (mass @ velocity))
    return Modes(natural, -poles[keep].real / natural, (energy / energy.sum(axis=0)).T)


def plane_modes(
    mass: float,
    inertia: float,
    horizontal: tuple[float, float],
    vertical: tuple[float, float],
    height: float,
    arm: float,
) -> Modes:
    """Both modes of roll with lateral motion (arm c), or of pitch with longitudinal motion (arm a).

    Parameters
    ----------
    mass : float [kg]
    inertia : float [kg m^2]
        About x for roll, about y for pitch.
    horizontal : (stiffness, damping) [N/m], [N s/m]
        Per tire along y for roll, along x for pitch.
    vertical : (stiffness, damping) [N/m], [N s/m]
        Per tire.
    height, arm : float [m]
        h, and c or a.
    """
    (k_h, d_h), (k_v, d_v) = horizontal, vertical

    def matrix(side: float, up: float) -> np.ndarray:
        return 4 * np.array([[side, height * side], [height * side, height**2 * side + arm**2 * up]])

    stiffness = matrix(k_h, k_v)
    stiffness[1, 1] -= mass * GRAVITY * height
    return vibration_modes(np.diag([mass, inertia]), matrix(d_h, d_v), stiffness)


AXES_OF = {"roll": (1, 3), "pitch": (0, 4), "yaw": (5,)}
"""Axes of (x, y, z, roll, pitch, yaw) that a motion lives in."""


FURTHER = "further mode "
"""Name of a mode beside the main ones, before its number."""


def body_modes(robot: Robot) -> dict[str, tuple[float, float]]:
    """ω_n [rad/s] and ξ of the main mode of each motion, which its decay log shows, and of the further modes.

    Parameters
    ----------
    robot : Robot
        Linearised at rest on sticking tires.

    Yaw is the mode with the largest share of energy in yaw; roll and pitch are the slowest modes with most of
    their energy in roll and y, or pitch and x. What remains (the partners of roll and pitch, and the bounce) is
    numbered by rising frequency under ``FURTHER``.
    """
    linear = linear_robot(robot)
    modes = vibration_modes(linear.mass, linear.damping, linear.stiffness)
    found: dict[str, tuple[float, float]] = {}
    taken: list[int] = []
    yaw = int(np.argmax(modes.shapes[:, 5])) if len(modes.natural) else -1
    for motion, axes in AXES_OF.items():
        share = modes.shapes[:, list(axes)].sum(axis=1)
        if motion == "yaw":
            index = yaw
        else:
            among = [k for k in range(len(share)) if share[k] > 0.5 and k != yaw]
            index = among[0] if among else -1
        if index >= 0:
            taken.append(index)
            found[motion] = (float(modes.natural[index]), float(modes.xi[index]))
    further = [k for k in range(len(modes.natural)) if k not in taken]
    for number, k in enumerate(further, 1):
        found[f"{FURTHER}{number}"] = (float(modes.natural[k]), float(modes.xi[k]))
    return found
