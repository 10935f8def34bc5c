"""Height of the floor under one wheel, and how fast it changes."""

from __future__ import annotations

import math

from ssmr_ident.core.kernel import kernel
from ssmr_ident.physics.effects import ground_joints, ground_roughness, wheel_eccentricity
from ssmr_ident.physics.slots import ECCENTRICITY, JOINT_DEPTH, JOINT_PITCH, JOINT_WIDTH, ROUGHNESS

_joint, _joint_slope = ground_joints.height, ground_joints.slope
_rough = ground_roughness.height
_run_out, _run_out_slope = wheel_eccentricity.height, wheel_eccentricity.slope


@kernel
def floor_height(e, floor, wheel, path, speed, angle, rate, x, y, speed_x, speed_y):
    """Height [m] and its rate [m/s] that the tire of one wheel feels; only called where something is uneven.

    Parameters
    ----------
    e : (SLOTS,) float
    floor : (n, n) float [m]
        Random floor.
    wheel : int
    path, speed : float [m], [m/s]
        Way travelled by the contact, and its speed.
    angle, rate : float [rad], [rad/s]
        Of the wheel.
    x, y, speed_x, speed_y : float [m], [m/s]
        Contact in the world.
    """
    level, change = 0.0, 0.0
    if e[JOINT_DEPTH] != 0.0:
        level += _joint(path, e[JOINT_PITCH], e[JOINT_DEPTH], e[JOINT_WIDTH])
        change += _joint_slope(path, e[JOINT_PITCH], e[JOINT_DEPTH], e[JOINT_WIDTH]) * speed
    if e[ECCENTRICITY] != 0.0:
        level += _run_out(angle, e[ECCENTRICITY], wheel)
        change += _run_out_slope(angle, e[ECCENTRICITY], wheel) * rate
    if e[ROUGHNESS] != 0.0:
        height, along_x, along_y = _rough(floor, x, y)
        level += height
        change += along_x * speed_x + along_y * speed_y
    return level, change


@kernel
def contact_speed(speed_x, speed_y):
    """Speed of the contact over the floor [m/s]."""
    return math.sqrt(speed_x * speed_x + speed_y * speed_y)
