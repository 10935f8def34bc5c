"""Small motions of the robot with every effect that is linear and time-invariant: mast, belts, relaxation, offsets,
turned and slow sensors.

As ``physics.linear`` for the baseline: what moves besides gets coordinates of its own, so that eigenvalues stand in for
time steps. All numbers that it depends on stand in one row, so that slopes by all of them cost one compiled call.
"""

from __future__ import annotations

import math

import numpy as np

from ssmr_ident.core.kernel import kernel
from ssmr_ident.physics.robot import GRAVITY, Robot
from ssmr_ident.physics.slots import Effects
from ssmr_ident.physics.statics import resting, tilt

Array = np.ndarray

MAST, BELT, BRANCH = "flexible_mast", "motor_belt", "viscoelastic_relaxation"
TURNED, SLOW, OFFSET = "sensor_misalignment", "sensor_bandwidth", "com_offset"
LINEAR = (MAST, BELT, BRANCH, TURNED, SLOW, OFFSET)
"""Effects of the catalogue that small motions take exactly."""

BODY = 12
"""States of the body: (x, y, z, roll, pitch, yaw) from rest, and their rates."""

LEAST_MASS = 0.03
"""Smallest eigenvalue, in a mass matrix of unit diagonal, with which a body carries its mast."""

MASS, INERTIA, POINTS, STIFFNESS, DAMPING, SENSOR, GAIN, BANDWIDTH, ANGLES, SWAY, BELTS, BRANCHES, COUNT = (
    0, 1, 7, 19, 22, 25, 28, 31, 32, 35, 39, 42, 44,
)  # fmt: skip
"""Where numbers begin in the row: of the tensor xx, yy, zz, xz, xy, yz; of a mast frequency, mass, height, damping."""

_TENSOR = ((0, 0), (1, 1), (2, 2), (0, 2), (0, 1), (1, 2))

PLACES = {
    "mass_kg": ((MASS, 1.0),),
    **{f"inertia_kg_m2.{axes}": ((INERTIA + k, 1.0),) for k, axes in enumerate(("xx", "yy", "zz", "xz", "xy", "yz"))},
    "height_m": tuple((POINTS + 3 * i + 2, -1.0) for i in range(4)),
    "contact_shift_x_m": tuple((POINTS + 3 * i, 1.0) for i in range(4)),
    "contact_shift_y_m": tuple((POINTS + 3 * i + 1, 1.0) for i in range(4)),
    **{f"tire.stiffness_{axis}_N_m": ((STIFFNESS + k, 1.0),) for k, axis in enumerate("xyz")},
    **{f"tire.damping_{axis}_N_s_m": ((DAMPING + k, 1.0),) for k, axis in enumerate("xyz")},
    **{f"accelerometer.position_m.{axis}": ((SENSOR + k, 1.0),) for k, axis in enumerate("xyz")},
    **{f"accelerometer.gain.{axis}": ((GAIN + k, 1.0),) for k, axis in enumerate("xyz")},
    "accelerometer.bandwidth_hz": ((BANDWIDTH, 1.0),),
    **{f"{TURNED}.angle_{axis}_rad": ((ANGLES + k, 1.0),) for k, axis in enumerate("xyz")},
    **{
        f"{MAST}.{name}": ((SWAY + k, 1.0),)
        for k, name in enumerate(("f_mast_Hz", "mass_kg", "height_above_com_m", "damping_ratio"))
    },
    **{f"{BELT}.{name}": ((BELTS + k, 1.0),) for k, name in enumerate(("K_b_N_m", "D_b_N_s_m", "rim_mass_kg"))},
    **{f"{BRANCH}.{name}": ((BRANCHES + k, 1.0),) for k, name in enumerate(("K_m_N_m", "tau_s"))},
    **{
        f"{OFFSET}.offset_{axis}_m": (*((POINTS + 3 * i + k, -1.0) for i in range(4)), (SENSOR + k, -1.0))
        for k, axis in enumerate("xy")
    },
}
"""What each parameter moves in the row, and by how much for one unit of it; the bandwidth of a slow sensor stands in
the place of the sheet's while it is the smaller one."""


def numbers(robot: Robot, gains: Array, effects: Effects) -> Array:
    """The row, (COUNT,) float, of a robot, what its axes read (3,), and complete parameters of effects."""
    row = np.zeros(COUNT)
    row[MASS] = robot.mass
    row[INERTIA:POINTS] = [robot.inertia[place] for place in _TENSOR]
    row[POINTS:STIFFNESS] = robot.contact_points.ravel()
    row[STIFFNESS:DAMPING], row[DAMPING:SENSOR] = robot.stiffness, robot.damping
    row[SENSOR:GAIN], row[GAIN:BANDWIDTH] = robot.accelerometer.position, gains
    row[BANDWIDTH] = robot.accelerometer.bandwidth_hz
    row[BANDWIDTH] = min(row[BANDWIDTH], effects.get(SLOW, {}).get("bandwidth_hz", math.inf))
    for effect, values in effects.items():
        for name, value in values.items() if effect != SLOW else ():
            for place, factor in PLACES[f"{effect}.{name}"]:
                row[place] += factor * value
    return row


def added(effects: Effects) -> tuple[bool, bool, bool]:
    """Whether a mast, belts and relaxing branches are there."""
    return (
        MAST in effects and math.isfinite(effects[MAST]["f_mast_Hz"]),
        BELT in effects and math.isfinite(effects[BELT]["K_b_N_m"]),
        BRANCH in effects,
    )


def tilted(row: Array) -> tuple[Array, Array]:
    """Sinking and tilt of the robot at rest, and the wheels' loads over K_z: (3, 3) rotation, (4,) float."""
    points = row[POINTS:STIFFNESS].reshape(4, 3)
    height, roll, pitch = resting(points, float(row[MASS]), float(row[STIFFNESS + 2]), 0.0)
    rotation = tilt(roll, pitch)
    return rotation, -(height + (points @ rotation.T)[:, 2])


@kernel
def small_motion(row, rotation, depths, sway, belt, branch):
    """Linearise at rest on sticking tires.

    Parameters
    ----------
    row : (COUNT,) float
    rotation, depths : (3, 3), (4,) float
        As ``tilted`` gives them.
    sway, belt, branch : bool

    Returns
    -------
    (n, n) float
        A of d state / dt = A state.
    (3, n) float
        What the axes read before their low-pass, less what they read at rest.
    (n, k) float
        State at the release over what is free of it: the body's twelve, a mast's sway and its rate, what branches hold
        along and about the body's axes.
    bool
        Whether the body carries its mast.
    """
    n = 6
    at_sway = n
    if sway:
        n += 2
    at_belt = n
    if belt:
        n += 2
    mass, damping, stiffness, relaxing = np.zeros((n, n)), np.zeros((n, n)), np.zeros((n, n)), np.zeros((n, n))
    tensor = np.zeros((3, 3))
    own = row[INERTIA:POINTS]
    tensor[0, 0], tensor[1, 1], tensor[2, 2] = own[0], own[1], own[2]
    tensor[0, 2] = tensor[2, 0] = own[3]
    tensor[0, 1] = tensor[1, 0] = own[4]
    tensor[1, 2] = tensor[2, 1] = own[5]
    for i in range(3):
        mass[i, i] = row[MASS]
    mass[3:6, 3:6] = rotation @ tensor @ np.ascontiguousarray(rotation.T)
    site = np.zeros((3, n))
    belts_from = np.zeros((2, 6))
    wheels = np.zeros(2)
    for w in range(4):
        a, b, c = row[POINTS + 3 * w], row[POINTS + 3 * w + 1], row[POINTS + 3 * w + 2]
        x = rotation[0, 0] * a + rotation[0, 1] * b + rotation[0, 2] * c
        y = rotation[1, 0] * a + rotation[1, 1] * b + rotation[1, 2] * c
        z = rotation[2, 0] * a + rotation[2, 1] * b + rotation[2, 2] * c
        site[:] = 0.0
        for i in range(3):
            site[i, i] = 1.0
        site[0, 4], site[0, 5], site[1, 3], site[1, 5], site[2, 3], site[2, 4] = z, -y, -z, x, y, -x
        side = 0 if b > 0.0 else 1
        wheels[side] += 1.0
        belts_from[side] += site[0, :6]
        if belt:
            site[0, at_belt + side] = -1.0
        for axis in range(3):
            k, d = row[STIFFNESS + axis], row[DAMPING + axis]
            ratio = k / row[STIFFNESS + 1] * row[BRANCHES] if branch else 0.0
            for i in range(n):
                if site[axis, i] != 0.0:
                    for j in range(n):
                        product = site[axis, i] * site[axis, j]
                        stiffness[i, j] += k * product
                        damping[i, j] += d * product
                        relaxing[i, j] += ratio * product
        sunk = row[STIFFNESS + 2] * depths[w] * z
        stiffness[3, 3] += sunk
        stiffness[4, 4] += sunk
    carried = True
    if sway:
        # a point mass above the body; total mass and inertia hold with it locked
        turning, heavy, high = 2.0 * math.pi * row[SWAY], row[SWAY + 1], row[SWAY + 2]
        for axis in range(2):
            s, about, sign = at_sway + axis, 4 - axis, 1.0 - 2.0 * axis
            mass[s, s] = heavy
            mass[axis, s] = mass[s, axis] = heavy
            mass[about, s] = mass[s, about] = sign * heavy * high
            damping[s, s] = 2.0 * heavy * row[SWAY + 3] * turning
            stiffness[s, s] = heavy * turning**2
            # a tilt lets its weight pull along, and its weight out of the middle turns the body
            stiffness[s, about] = stiffness[about, s] = -sign * heavy * GRAVITY
    if belt:
        for side in range(2):
            mass[at_belt + side, at_belt + side] = row[BELTS + 2]
            damping[at_belt + side, at_belt + side] += row[BELTS + 1]
            stiffness[at_belt + side, at_belt + side] += row[BELTS]
    size = np.sqrt(np.diag(mass))
    carried = bool(np.linalg.eigvalsh(mass / np.outer(size, size))[0] > LEAST_MASS)
    inverse = np.linalg.inv(mass)
    states = 3 * n if branch else 2 * n
    a = np.zeros((states, states))
    for i in range(n):
        a[i, n + i] = 1.0
    a[n : 2 * n, :n] = -inverse @ stiffness
    a[n : 2 * n, n : 2 * n] = -inverse @ damping
    if branch:
        a[n : 2 * n, 2 * n :] = -inverse @ relaxing
        for i in range(n):
            a[2 * n + i, n + i] = 1.0
            a[2 * n + i, 2 * n + i] = -1.0 / row[BRANCHES + 1]
    x, y, z = row[SENSOR], row[SENSOR + 1], row[SENSOR + 2]
    felt = np.zeros((3, states))
    felt[0] = a[n] + z * a[n + 4] - y * a[n + 5]
    felt[1] = a[n + 1] - z * a[n + 3] + x * a[n + 5]
    felt[2] = a[n + 2] + y * a[n + 3] - x * a[n + 4]
    felt[0, 4] -= GRAVITY
    felt[1, 3] += GRAVITY
    read = _turned(row[ANGLES], row[ANGLES + 1], row[ANGLES + 2]) @ felt
    for axis in range(3):
        read[axis] *= row[GAIN + axis]
    free = 12 + (4 if sway else 0) + (6 if branch else 0)
    start = np.zeros((states, free))
    for i in range(6):
        start[i, i] = start[n + i, 6 + i] = 1.0
    if sway:
        for i in range(2):
            start[at_sway + i, 12 + i] = start[n + at_sway + i, 14 + i] = 1.0
    if branch:
        for i in range(6):
            start[2 * n + i, free - 6 + i] = 1.0
    if belt:  # belts and tires share what a slow push has moved
        for side in range(2):
            share = row[STIFFNESS] / (row[BELTS] + wheels[side] * row[STIFFNESS])
            for i in range(6):
                start[at_belt + side, i] = start[n + at_belt + side, 6 + i] = share * belts_from[side, i]
    return a, read, start, carried


@kernel
def _turned(about_x, about_y, about_z):
    """What axes read that are turned by Rz·Ry·Rx: its transpose, (3, 3) float."""
    cx, sx, cy, sy = math.cos(about_x), math.sin(about_x), math.cos(about_y), math.sin(about_y)
    cz, sz = math.cos(about_z), math.sin(about_z)
    out = np.empty((3, 3))
    out[0, 0], out[1, 0], out[2, 0] = cz * cy, cz * sy * sx - sz * cx, cz * sy * cx + sz * sx
    out[0, 1], out[1, 1], out[2, 1] = sz * cy, sz * sy * sx + cz * cx, sz * sy * cx - cz * sx
    out[0, 2], out[1, 2], out[2, 2] = -sy, cy * sx, cy * cx
    return out
