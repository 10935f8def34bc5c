"""Planar dynamics of a skid-steering robot on four sliding contacts (2.24), (2.29), (2.36).

Slower motions than the tires' vibrations, so the tires are rigid here. An independent and much faster second opinion
on how fast the 6-DOF simulator turns.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from scipy.integrate import solve_ivp

from ssmr_ident.core.errors import SimulationError
from ssmr_ident.physics.planar import slip
from ssmr_ident.physics.robot import GRAVITY, Robot

FrictionLaw = Callable[[float], float]


@dataclass(frozen=True)
class PlanarRobot:
    """What the plane needs of a robot.

    Parameters
    ----------
    mass : float [kg]
    yaw_inertia : float [kg m^2]
    rear, front, half_track, radius : float [m]
        a, b, c and r.
    """

    mass: float
    yaw_inertia: float
    rear: float
    front: float
    half_track: float
    radius: float

    @property
    def contacts(self) -> np.ndarray:
        """(4, 2) float [m]: rear left, front left, front right, rear right."""
        a, b, c = self.rear, self.front, self.half_track
        return np.array([[-a, c], [b, c], [b, -c], [-a, -c]])


def planar_robot(robot: Robot) -> PlanarRobot:
    """From the 6-DOF robot: mean distances of its axles."""
    x = robot.contact_points[:, 0]
    return PlanarRobot(
        robot.mass, float(robot.inertia[2, 2]), -float(x[x < 0].mean()), float(x[x > 0].mean()),
        robot.half_track, robot.radius,
    )  # fmt: skip


def load_split(robot: PlanarRobot) -> np.ndarray:
    """Wheel loads at rest by moments about the axles (2.24), (4,) float [N], in the order of ``contacts``."""
    a, b = robot.rear, robot.front
    return robot.mass * GRAVITY / (2.0 * (a + b)) * np.array([b, a, a, b])


def saturating_friction(mu: float, lambda_max: float) -> FrictionLaw:
    """µ(λ) = µ·min(|λ|/λ_max, 1): one of the two laws (2.29a/b).

    The digest names the two laws without printing them. This one has the form that (4.10) keeps.

    >>> saturating_friction(0.8, 0.1)(0.05)
    0.4
    """
    return lambda ratio: mu * min(abs(ratio) / lambda_max, 1.0)


def peaking_friction(mu: float, lambda_peak: float) -> FrictionLaw:
    """µ(λ) = 2·µ·λ_p·|λ|/(λ_p² + λ²): rises to µ at λ_p and falls beyond; stands for the other law of (2.29a/b).

    Not printed in the digest either; this is the usual law with one peak (C. Ünsal and P. Kachroo, IEEE Trans.
    Control Systems Technology 7(2), 1999).

    >>> peaking_friction(0.8, 0.1)(0.1)
    0.8
    """
    return lambda ratio: 2.0 * mu * lambda_peak * abs(ratio) / (lambda_peak**2 + ratio**2)


def contact_forces(robot: PlanarRobot, velocity: np.ndarray, wheel_rates: np.ndarray, law: FrictionLaw) -> np.ndarray:
    """Force of the floor on each wheel, (4, 2) float [N].

    Along x it is µ(λ)·N against the slip; across, as in (4.12), min(|tan θ|·µ(λ), µ(1))·N with θ the direction of the
    slip: a wheel that hardly slips lengthwise holds little sideways for its speed, one that spins or stands is a
    plain Coulomb contact. How (2.36) splits the axes is not in the digest.

    Parameters
    ----------
    velocity : (3,) float [m/s, m/s, rad/s]
        Forward, left, yaw rate of the CoM, robot axes.
    wheel_rates : (2,) float [rad/s]
        Left, right.
    law : callable
        µ over |λ|.
    """
    sliding = sliding_velocities(robot, velocity, wheel_rates)
    loads = load_split(robot)
    rims = robot.radius * np.asarray(wheel_rates, dtype=float)[[0, 0, 1, 1]]
    forces = np.zeros((4, 2))
    for wheel, ((along, across), rim) in enumerate(zip(sliding, rims, strict=True)):
        if rim == 0.0:  # a wheel that does not turn holds alike in all directions
            speed = math.hypot(along, across)
            shares = law(1.0) * np.array([along, across]) / speed if speed > 0.0 else np.zeros(2)
        else:
            lengthwise = max(abs(along), 1e-9 * abs(rim))
            grip = law(abs(slip(rim / robot.radius, rim + along, robot.radius)))
            limited = min(abs(across) / lengthwise * law(min(lengthwise / abs(rim), 1.0)), law(1.0))
            shares = np.array([math.copysign(grip, along), math.copysign(limited, across)])
        forces[wheel] = -loads[wheel] * shares
    return forces


def sliding_velocities(robot: PlanarRobot, velocity: np.ndarray, wheel_rates: np.ndarray) -> np.ndarray:
    """Velocity of each contact over the floor: that of the hub less the rolling; (4, 2) float [m/s]."""
    forward, left, turning = velocity
    x, y = robot.contacts.T
    rolling = robot.radius * np.asarray(wheel_rates, dtype=float)[[0, 0, 1, 1]]
    return np.column_stack([forward - turning * y - rolling, left + turning * x])


def acceleration(robot: PlanarRobot, velocity: np.ndarray, wheel_rates: np.ndarray, law: FrictionLaw) -> np.ndarray:
    """Rates of forward, sideways and yaw velocity (2.36), (3,) float [m/s^2, m/s^2, rad/s^2].

    In the robot's turning axes, so with the term that section 6.1 drops: m(v̇_x − ωv_y) = ΣF_x,
    m(v̇_y + ωv_x) = ΣF_y, I_z ω̇ = Σ(x F_y − y F_x).
    """
    forces = contact_forces(robot, velocity, wheel_rates, law)
    forward, left, turning = velocity
    x, y = robot.contacts.T
    total = forces.sum(axis=0) / robot.mass
    moment = float(x @ forces[:, 1] - y @ forces[:, 0])
    return np.array([total[0] + turning * left, total[1] - turning * forward, moment / robot.yaw_inertia])


def settle(robot: PlanarRobot, wheel_rates: np.ndarray, law: FrictionLaw, duration: float = 5.0) -> np.ndarray:
    """Motion after some time at constant wheel rates, from rest; (3,) float [m/s, m/s, rad/s].

    Raises
    ------
    SimulationError
        The integration did not get to the end.
    """
    found = solve_ivp(
        lambda _, velocity: acceleration(robot, velocity, wheel_rates, law),
        (0.0, duration), np.zeros(3), method="LSODA", rtol=1e-8, atol=1e-10,
    )  # fmt: skip
    if not found.success:
        raise SimulationError(f"planar motion at wheel rates {np.asarray(wheel_rates).tolist()}: {found.message}")
    return np.asarray(found.y[:, -1])
