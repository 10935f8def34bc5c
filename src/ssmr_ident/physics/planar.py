"""Planar kinematics of a skid-steering robot: slip, instantaneous centres of rotation, wheel rates (2.1)-(2.11).

Left and right wheels turn at one rate each. c is half the track, r the wheels' radius; x forward, y left, yaw
positive to the left. All functions are pure and take plain numbers or arrays.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from ssmr_ident.core.errors import InputError


def world_velocity(velocity: np.ndarray, heading: float) -> np.ndarray:
    """Velocity of the CoM in the world from that in the robot's axes (2.1).

    The source's digest names the equation without printing it; this is the planar rotation that it must be.

    Parameters
    ----------
    velocity : (3,) float [m/s, m/s, rad/s]
        Forward, to the left, yaw rate.
    heading : float [rad]

    Returns
    -------
    (3,) float [m/s, m/s, rad/s]
    """
    forward, left, turning = velocity
    cos, sin = math.cos(heading), math.sin(heading)
    return np.array([cos * forward - sin * left, sin * forward + cos * left, turning])


def slip(wheel_rate: float, hub_speed: float, radius: float) -> float:
    """Longitudinal slip λ = (rω − v)/(rω), clamped to [−1, 1] (2.7).

    0 rolls freely, 1 spins on the spot, −1 is dragged at twice its rolling speed or more, or does not turn though it
    moves. A wheel at rest on the floor has 0.

    >>> slip(2.0, 0.1, 0.1), slip(2.0, 0.0, 0.1), slip(0.0, 0.3, 0.1)
    (0.5, 1.0, -1.0)
    """
    rim = radius * wheel_rate
    if rim == 0.0:
        return 0.0 if hub_speed == 0.0 else -1.0
    return min(1.0, max(-1.0, (rim - hub_speed) / rim))


def hub_speeds(speed: float, yaw_rate: float, half_track: float) -> np.ndarray:
    """Forward speeds of the left and right hubs, v ∓ cω; (2,) float [m/s]."""
    return np.array([speed - half_track * yaw_rate, speed + half_track * yaw_rate])


def body_motion(wheel_rates: np.ndarray, slips: np.ndarray, radius: float, half_track: float) -> np.ndarray:
    """Forward speed and yaw rate from wheel rates and slips (2.11).

    Parameters
    ----------
    wheel_rates : (2,) float [rad/s]
        Left, right.
    slips : (2,) float
    radius, half_track : float [m]

    Returns
    -------
    (2,) float [m/s, rad/s]
    """
    rolled = radius * np.asarray(wheel_rates, dtype=float) * (1.0 - np.asarray(slips, dtype=float))
    return np.array([0.5 * (rolled[0] + rolled[1]), 0.5 * (rolled[1] - rolled[0]) / half_track])


def wheel_rates_for(speed: float, yaw_rate: float, slips: np.ndarray, radius: float, half_track: float) -> np.ndarray:
    """Wheel rates that give a wanted motion under known slips: (2.11) the other way round; (2,) float [rad/s].

    Raises
    ------
    InputError
        A slip of 1 or more: a wheel that spins on the spot gives no motion, whatever its rate.
    """
    if np.max(slips) >= 1.0:
        raise InputError("slips", f"are {np.asarray(slips).tolist()}", "Below 1: a spinning wheel moves nothing")
    return hub_speeds(speed, yaw_rate, half_track) / (radius * (1.0 - np.asarray(slips, dtype=float)))


@dataclass(frozen=True)
class Centres:
    """Instantaneous centres of rotation, in the robot's axes (2.8)-(2.10).

    Parameters
    ----------
    x : float [m]
        All three lie on one line across the robot, this far ahead of the CoM.
    body, left, right : float [m]
        y of the centre of the body, and of the left and right treads over the floor. Infinite where nothing turns.
    """

    x: float
    body: float
    left: float
    right: float


def rotation_centres(velocity: np.ndarray, wheel_rates: np.ndarray, radius: float) -> Centres:
    """Where body and treads turn about (2.8)-(2.10).

    The digest names the equations without printing them; derived here: a point (x, y) of the body moves with
    (v_x − ωy, v_y + ωx), one of a tread with rω_side less along x, and the centre is where that vanishes.

    Parameters
    ----------
    velocity : (3,) float [m/s, m/s, rad/s]
    wheel_rates : (2,) float [rad/s]
    radius : float [m]
    """
    forward, left, turning = (float(value) for value in velocity)
    if turning == 0.0:
        return Centres(
            *(_over_zero(value) for value in (-left, forward, *(forward - radius * np.asarray(wheel_rates))))
        )
    treads = [(forward - radius * float(rate)) / turning for rate in wheel_rates]
    return Centres(-left / turning, forward / turning, treads[0], treads[1])


def _over_zero(value: float) -> float:
    """The limit of value/ω as ω falls to 0 from above; 0 for 0, where any point will do."""
    return math.copysign(math.inf, value) if value else 0.0
