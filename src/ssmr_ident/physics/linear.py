"""Small motions about rest in closed form: mass, damping and stiffness matrices and their modes.

Valid while every contact sticks. Independent of the integrator, which it checks; exact and fast, which fits use.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ssmr_ident.physics.robot import Robot
from ssmr_ident.physics.statics import loads_at, rest_pose, tilt

COORDINATES = ("x", "y", "z", "roll", "pitch", "yaw")

GROWN = 1e100
"""In SI units, beyond which a response is none: its square would overflow."""


@dataclass(frozen=True, eq=False)
class LinearRobot:
    """M q'' + C q' + K q = 0 with q = (x, y, z, roll, pitch, yaw) from rest.

    Parameters
    ----------
    mass, damping, stiffness : (6, 6) float
        SI; rows of force [N], then of moment [N m].
    """

    mass: np.ndarray
    damping: np.ndarray
    stiffness: np.ndarray

    @property
    def state_matrix(self) -> np.ndarray:
        """A of d(q, q')/dt = A (q, q'), (12, 12)."""
        inverse = np.linalg.inv(self.mass)
        return np.block([[np.zeros((6, 6)), np.eye(6)], [-inverse @ self.stiffness, -inverse @ self.damping]])

    def modes(self) -> np.ndarray:
        """Natural frequency [rad/s], damping ratio, and the share of each coordinate, rows by rising frequency.

        Returns
        -------
        (6, 8) float
            omega_n, xi, then |shape| of the six coordinates, scaled to 1 at the largest.
        """
        values, vectors = np.linalg.eig(self.state_matrix)
        upper = values.imag > 0
        values, vectors = values[upper], np.abs(vectors[:6, upper])
        order = np.argsort(np.abs(values))
        shapes = (vectors / vectors.max(axis=0))[:, order].T
        omega = np.abs(values[order])
        return np.column_stack([omega, -values.real[order] / omega, shapes])


def linear_robot(robot: Robot) -> LinearRobot:
    """Linearise the robot at rest on sticking tires (the coupled form of eq 5.11, thesis.md section 5)."""
    pose = rest_pose(robot)
    rotation = tilt(pose[1], pose[2])
    arms = robot.contact_points @ rotation.T
    loads = loads_at(robot, pose)
    mass = np.zeros((6, 6))
    mass[:3, :3] = robot.mass * np.eye(3)
    mass[3:, 3:] = rotation @ robot.inertia @ rotation.T
    damping, stiffness = np.zeros((6, 6)), np.zeros((6, 6))
    for arm, load in zip(arms, loads, strict=True):
        jacobian = np.hstack([np.eye(3), -_cross(arm)])
        damping += jacobian.T @ np.diag(robot.damping) @ jacobian
        stiffness += jacobian.T @ np.diag(robot.stiffness) @ jacobian
        # the load moves sideways against the CoM: minus m g h in roll and pitch
        stiffness[3, 3] += load * arm[2]
        stiffness[4, 4] += load * arm[2]
    return LinearRobot(mass, damping, stiffness)


def pure_rotations(robot: Robot) -> LinearRobot:
    """Rotations about a CoM that stays where it is (5.3): no products of inertia, no coupling, no m g h."""
    squares = (robot.contact_points**2).sum(axis=0)
    stiffness, damping = (
        np.diag([k[1] * squares[2] + k[2] * squares[1], k[0] * squares[2] + k[2] * squares[0],
                 k[0] * squares[1] + k[1] * squares[0]])
        for k in (robot.stiffness, robot.damping)
    )  # fmt: skip
    empty = np.zeros((3, 3))
    locked = np.block([[np.eye(3) * 1e6, empty], [empty, empty]])  # holds the CoM in place
    return LinearRobot(
        np.block([[np.eye(3) * robot.mass, empty], [empty, np.diag(np.diag(robot.inertia))]]),
        np.block([[empty, empty], [empty, damping]]),
        locked + np.block([[empty, empty], [empty, stiffness]]),
    )


def _cross(arm: np.ndarray) -> np.ndarray:
    """Matrix of the cross product: _cross(a) @ b = a × b."""
    return np.array([[0.0, -arm[2], arm[1]], [arm[2], 0.0, -arm[0]], [-arm[1], arm[0], 0.0]])


def accelerometer_rows(linear: LinearRobot, position: np.ndarray, gravity: float) -> np.ndarray:
    """Specific force at the accelerometer for small motions, without the resting value (3.4).

    Parameters
    ----------
    linear : LinearRobot
    position : (3,) float [m]
        p_a from the CoM.
    gravity : float [m/s^2]

    Returns
    -------
    (3, 12) float
        Rows ax, ay, az over the state (q, q').
    """
    acceleration = linear.state_matrix[6:]
    rows = acceleration[:3] - _cross(position) @ acceleration[3:]
    rows[0, 4] -= gravity  # a tilt turns gravity into the axes
    rows[1, 3] += gravity
    return rows


def responses(state_matrix: np.ndarray, rows: np.ndarray, time: np.ndarray) -> np.ndarray:
    """What each unit of the starting state gives at the output.

    Parameters
    ----------
    state_matrix : (k, k) float
    rows : (c, k) float
        Output over the state.
    time : (n,) float [s]

    Returns
    -------
    (n, c, k) float
        NaN where a motion grows beyond ``GROWN``.
    """
    values, vectors = np.linalg.eig(state_matrix)
    with np.errstate(over="ignore", invalid="ignore"):
        course = np.exp(np.outer(time, values))
        found = np.einsum("ck,nk,kj->ncj", rows @ vectors, course, np.linalg.inv(vectors), optimize=True).real
        return np.where(np.abs(found) < GROWN, found, np.nan)
