"""Height of the floor under one wheel, and how fast it changes."""

from __future__ import annotations

import math

from ssmr_ident.core.kernel import kernel
from ssmr_ident.core.simd import anywhere, first, lanewise
from ssmr_ident.physics.effects import ground_joints, ground_roughness, wheel_eccentricity
from ssmr_ident.physics.slots import ECCENTRICITY, JOINT_DEPTH, JOINT_PITCH, JOINT_WIDTH

_joint, _joint_slope = lanewise(ground_joints.height), lanewise(ground_joints.slope)
_rough = ground_roughness.height
_run_out, _run_out_slope = lanewise(wheel_eccentricity.height), lanewise(wheel_eccentricity.slope)


@kernel
def floor_height(e, wheel, path, speed, angle, rate):
    """Height [m] and its rate [m/s] that the tire of one wheel feels from joints and its own run-out.

    Parameters
    ----------
    e : (SLOTS,) float
        Or a tuple, as ``inner_slots`` gives it.
    wheel : int
    path, speed : float [m], [m/s]
        Way travelled by the contact, and its speed.
    angle, rate : float [rad], [rad/s]
        Of the wheel.
    """
    level, change = 0.0, 0.0
    if first(e[JOINT_DEPTH]) != 0.0:
        level += _joint(path, e[JOINT_PITCH], e[JOINT_DEPTH], e[JOINT_WIDTH])
        change += _joint_slope(path, e[JOINT_PITCH], e[JOINT_DEPTH], e[JOINT_WIDTH]) * speed
    if first(e[ECCENTRICITY]) != 0.0:
        level += _run_out(angle, e[ECCENTRICITY], wheel)
        change += _run_out_slope(angle, e[ECCENTRICITY], wheel) * rate
    return level, change


@kernel
def rough_height(floor, begin, rms, x, y, speed_x, speed_y):
    """Height [m] of a random floor under a contact, and its rate [m/s].

    Parameters
    ----------
    floor : (k n²,) float
        Fields in units of ``rms``.
    begin : float
        Place where the one under the contact begins.
    rms : float [m]
    x, y, speed_x, speed_y : float [m], [m/s]
        Contact in the world.
    """
    height, along_x, along_y = _rough(floor, begin, x, y)
    return rms * height, rms * (along_x * speed_x + along_y * speed_y)


@kernel
def contact_speed(speed_x, speed_y):
    """Speed of the contact over the floor [m/s]."""
    square = speed_x * speed_x + speed_y * speed_y
    if not anywhere(square != 0.0):  # most contacts stand, and a root costs as much as twenty sums
        return square
    return math.sqrt(square)
