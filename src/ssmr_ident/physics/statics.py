"""The robot at rest: wheel loads and how far the tires sink in."""

from __future__ import annotations

import math
from weakref import WeakKeyDictionary

import numpy as np

from ssmr_ident.core.kernel import kernel
from ssmr_ident.physics.robot import GRAVITY, Robot


def rest_pose(robot: Robot, cubic: float = 0.0) -> np.ndarray:
    """Sinking and tilt at which the tires carry the weight, by Newton's method on the exact geometry.

    Parameters
    ----------
    robot : Robot
    cubic : float [N/m^3]
        k3 of each tire beside its K_z.

    Returns
    -------
    (3,) float [m, rad, rad]
        Height of the CoM above the floor, roll and pitch.
    """
    known = _FOUND.setdefault(robot, {})
    if cubic not in known:
        known[cubic] = resting(robot.contact_points, robot.mass, float(robot.stiffness[2]), cubic)
    return known[cubic].copy()


_FOUND: WeakKeyDictionary[Robot, dict[float, np.ndarray]] = WeakKeyDictionary()
"""Rest poses of robots that are still in use: one robot is let go from many starts."""


@kernel
def resting(points, mass, stiffness, cubic):
    """``rest_pose`` of numbers: (4, 3) float [m], [kg], [N/m], [N/m^3]."""
    sink = mass * GRAVITY / (4.0 * stiffness)
    height, roll, pitch = -points[:, 2].mean() - sink, 0.0, 0.0
    for _ in range(30):
        cr, sr, cp, sp = math.cos(roll), math.sin(roll), math.cos(pitch), math.sin(pitch)
        up, about_x, about_y = -mass * GRAVITY, 0.0, 0.0
        # how stiff the wheels are together: up, up by roll and pitch, roll, roll by pitch, pitch
        uu, ux, uy, xx, xy, yy = 0.0, 0.0, 0.0, 0.0, 0.0, 0.0
        for i in range(len(points)):
            x, y, z = points[i, 0], points[i, 1], points[i, 2]
            raised = sr * y + cr * z
            lateral, along = cr * y - sr * z, -(cp * x + sp * raised)
            depth = sp * x - cp * raised - height
            force = stiffness * depth + cubic * depth**3
            slope = stiffness + 3.0 * cubic * depth**2
            up, about_x, about_y = up + force, about_x + lateral * force, about_y + along * force
            uu, ux, uy = uu + slope, ux + lateral * slope, uy + along * slope
            xx, xy, yy = xx + lateral**2 * slope, xy + lateral * along * slope, yy + along**2 * slope
        # what is left, by Cramer's rule
        a, b, c = xx * yy - xy * xy, uy * xy - ux * yy, ux * xy - uy * xx
        whole = uu * a + ux * b + uy * c
        higher = (a * up + b * about_x + c * about_y) / whole
        rolled = (b * up + (uu * yy - uy * uy) * about_x + (ux * uy - uu * xy) * about_y) / whole
        pitched = (c * up + (ux * uy - uu * xy) * about_x + (uu * xx - ux * ux) * about_y) / whole
        height, roll, pitch = height + higher, roll + rolled, pitch + pitched
        if max(abs(higher), abs(rolled), abs(pitched)) < 1e-13:  # Newton: what is left now is the square of that
            break
    return np.array([height, roll, pitch])


def rest_loads(robot: Robot) -> np.ndarray:
    """Load on each wheel at rest, (4,) float [N]; equals the split of eq (2.24) for a symmetric robot."""
    return loads_at(robot, rest_pose(robot))


def loads_at(robot: Robot, pose: np.ndarray) -> np.ndarray:
    """Load on each wheel in a pose (height, roll, pitch), (4,) float [N], linear tires."""
    return robot.stiffness[2] * _arms_and_depth(robot, pose)[1]


def _arms_and_depth(robot: Robot, pose: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    height, roll, pitch = pose
    arms = robot.contact_points @ tilt(roll, pitch).T
    return arms, -(height + arms[:, 2])


def tilt(roll: float, pitch: float) -> np.ndarray:
    """Rotation from body to heading axes, (3, 3): Ry(pitch)·Rx(roll), eq (2.37) without the heading."""
    cr, sr, cp, sp = np.cos(roll), np.sin(roll), np.cos(pitch), np.sin(pitch)
    return np.array([[cp, sp * sr, sp * cr], [0.0, cr, -sr], [-sp, cp * sr, cp * cr]])
