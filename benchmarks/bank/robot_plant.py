"""The robot on four sticking tires with any laws, by classical Runge-Kutta: not a line of simulate/robot_kernel.py.

Written from the description in docs/theory/simulation.md: velocities along the heading axes, gravity and floor
constant, no M·V̂·V term, no gyroscopic moment (the baseline has neither), tires as K·s + D·v + laws. Contacts must
not slide; ``run_robot`` says so when one would.
"""

from __future__ import annotations

import numpy as np
from scipy.optimize import fsolve
from scipy.signal import butter, sosfilt

from bank.laws import STATES, force, moved, rates
from ssmr_ident.core.kernel import kernel
from ssmr_ident.physics.robot import GRAVITY, Robot
from ssmr_ident.physics.statics import rest_pose, tilt

STEP = 1e-4  # s


def run_robot(
    robot: Robot,
    start: np.ndarray,
    seconds: float,
    sample_rate: float,
    laws_x: np.ndarray,
    laws_y: np.ndarray,
    laws_z: np.ndarray,
) -> tuple[np.ndarray, float]:
    """Specific forces at the accelerometer behind its low-pass, and how near a contact came to sliding.

    Parameters
    ----------
    robot : Robot
    start : (12,) float
        Displacement from rest (x, y, z, roll, pitch, yaw) and its rates.
    seconds, sample_rate : float [s], [Hz]
    laws_x, laws_y, laws_z : (m, WIDTH) float
        Beside each tire's spring along, across and upright; as many rows in all (a force of 0 for none). Those
        along z act on the whole depth to which the tire is pressed, and must have no hidden states.

    Returns
    -------
    (n, 3) float [m/s^2], float
        The second is the largest tangential force over mu·N: above 1 the contact would have slid.
    """
    every = max(1, round(1.0 / (sample_rate * STEP)))
    step = 1.0 / (sample_rate * every)
    samples = round(seconds * sample_rate)
    height, roll, pitch = _rest(robot, laws_z)
    at_rest = np.array([0.0, 0.0, height, roll, pitch, 0.0])
    state = np.concatenate([at_rest + start[:6], start[6:]])
    out = np.empty(((samples - 1) * every + 1, 3))
    slid = _run(
        robot.mass, np.linalg.inv(robot.inertia), robot.contact_points, robot.stiffness, robot.damping,
        robot.mu_static, robot.accelerometer.position, laws_x, laws_y, laws_z, at_rest, state, step, out,
    )  # fmt: skip
    low_pass = butter(2, robot.accelerometer.bandwidth_hz, fs=1.0 / step, output="sos")
    first = out[0].copy()
    out = first + sosfilt(low_pass, out - first, axis=0)
    return out[::every].copy(), slid


def _rest(robot: Robot, laws_z: np.ndarray) -> np.ndarray:
    """Height, roll and pitch at which the tires carry the weight."""
    still = np.zeros(STATES)

    def unbalanced(pose: np.ndarray) -> np.ndarray:
        arms = robot.contact_points @ tilt(pose[1], pose[2]).T
        depth = -(pose[0] + arms[:, 2])
        load = robot.stiffness[2] * depth
        load += [sum(force(row, d, 0.0, still, 0.0) for row in laws_z) for d in depth]
        return np.array([load.sum() - robot.mass * GRAVITY, load @ arms[:, 1], load @ arms[:, 0]])

    return np.asarray(fsolve(unbalanced, rest_pose(robot), xtol=1e-13))


@kernel
def _rotation(roll, pitch, out):
    cr, sr, cp, sp = np.cos(roll), np.sin(roll), np.cos(pitch), np.sin(pitch)
    out[0, 0], out[0, 1], out[0, 2] = cp, sp * sr, sp * cr
    out[1, 0], out[1, 1], out[1, 2] = 0.0, cr, -sr
    out[2, 0], out[2, 1], out[2, 2] = -sp, cp * sr, cp * cr


@kernel
def _slope(mass, inverse, points, k, d, mu, laws_x, laws_y, laws_z, t, s, z, ds, dz, turn, arm, acceleration):
    """d(state)/dt; the state holds pose, velocities and 4 x 2 deflections. Returns the largest use of grip."""
    _rotation(s[3], s[4], turn)
    cy, sy = np.cos(s[5]), np.sin(s[5])
    body = np.empty(3)
    body[0], body[1], body[2] = s[9], s[10], s[11]
    omega = turn @ body
    total, moment = np.zeros(3), np.zeros(3)
    used = 0.0
    for i in range(4):
        for j in range(3):
            arm[j] = turn[j, 0] * points[i, 0] + turn[j, 1] * points[i, 1] + turn[j, 2] * points[i, 2]
        vx = s[6] + omega[1] * arm[2] - omega[2] * arm[1]
        vy = s[7] + omega[2] * arm[0] - omega[0] * arm[2]
        vz = s[8] + omega[0] * arm[1] - omega[1] * arm[0]
        depth = -(s[2] + arm[2])
        normal = k[2] * depth - d[2] * vz
        ds[12 + 2 * i], ds[13 + 2 * i] = vx, vy
        fx = k[0] * s[12 + 2 * i] + d[0] * vx
        fy = k[1] * s[13 + 2 * i] + d[1] * vy
        for m in range(laws_x.shape[0]):
            fx += force(laws_x[m], s[12 + 2 * i], vx, z[2 * i, m], t)
            fy += force(laws_y[m], s[13 + 2 * i], vy, z[2 * i + 1, m], t)
            normal += force(laws_z[m], depth, -vz, z[8, m], t)
            rates(laws_x[m], s[12 + 2 * i], vx, z[2 * i, m], dz[2 * i, m])
            rates(laws_y[m], s[13 + 2 * i], vy, z[2 * i + 1, m], dz[2 * i + 1, m])
        used = max(used, max(abs(fx), abs(fy)) / max(mu * normal, 1e-9))
        total[0] -= fx
        total[1] -= fy
        total[2] += normal
        moment[0] += arm[1] * normal + arm[2] * fy
        moment[1] += -arm[2] * fx - arm[0] * normal
        moment[2] += -arm[0] * fy + arm[1] * fx
    spin = inverse @ (turn.T @ moment)
    for j in range(3):
        acceleration[j] = total[j] / mass
        acceleration[3 + j] = spin[j]
        ds[6 + j] = acceleration[j]
        ds[9 + j] = spin[j]
    ds[8] -= GRAVITY
    turning = (np.sin(s[3]) * s[10] + np.cos(s[3]) * s[11]) / np.cos(s[4])
    ds[0], ds[1], ds[2] = cy * s[6] - sy * s[7], sy * s[6] + cy * s[7], s[8]
    ds[3] = s[9] + np.sin(s[4]) * turning
    ds[4] = np.cos(s[3]) * s[10] - np.sin(s[3]) * s[11]
    ds[5] = turning
    return used


@kernel
def _run(mass, inverse, points, k, d, mu, place, laws_x, laws_y, laws_z, at_rest, start, step, out):
    count = laws_x.shape[0]
    s, trial = np.zeros(20), np.zeros(20)
    s[:12] = start
    turn, arm, acceleration, scratch = np.empty((3, 3)), np.empty(3), np.empty(6), np.empty(6)
    # the tires were set down unstressed at rest: a start away from it has bent them
    set_down = np.empty((4, 2))
    _rotation(at_rest[3], at_rest[4], turn)
    for i in range(4):
        for j in range(2):
            set_down[i, j] = turn[j, 0] * points[i, 0] + turn[j, 1] * points[i, 1] + turn[j, 2] * points[i, 2]
    _rotation(s[3], s[4], turn)
    cy, sy = np.cos(s[5]), np.sin(s[5])
    for i in range(4):
        hx = turn[0, 0] * points[i, 0] + turn[0, 1] * points[i, 1] + turn[0, 2] * points[i, 2]
        hy = turn[1, 0] * points[i, 0] + turn[1, 1] * points[i, 1] + turn[1, 2] * points[i, 2]
        gone_x = s[0] + cy * hx - sy * hy - set_down[i, 0]
        gone_y = s[1] + sy * hx + cy * hy - set_down[i, 1]
        s[12 + 2 * i], s[13 + 2 * i] = cy * gone_x + sy * gone_y, -sy * gone_x + cy * gone_y
    z, z_trial = np.zeros((9, count, STATES)), np.zeros((9, count, STATES))
    slopes, z_slopes = np.zeros((4, 20)), np.zeros((4, 9, count, STATES))
    largest = 0.0
    for n in range(out.shape[0]):
        used = _slope(
            mass, inverse, points, k, d, mu, laws_x, laws_y, laws_z, n * step, s, z, slopes[0], z_slopes[0], turn,
            arm, acceleration,
        )  # fmt: skip
        largest = max(largest, used)
        p, q, r = s[9], s[10], s[11]
        along = p * place[0] + q * place[1] + r * place[2]
        square = p * p + q * q + r * r
        lever = (
            acceleration[4] * place[2] - acceleration[5] * place[1],
            acceleration[5] * place[0] - acceleration[3] * place[2],
            acceleration[3] * place[1] - acceleration[4] * place[0],
        )
        for j in range(3):
            sensed = turn[0, j] * acceleration[0] + turn[1, j] * acceleration[1] + turn[2, j] * acceleration[2]
            out[n, j] = sensed + lever[j] + (p, q, r)[j] * along - square * place[j]
        if n + 1 == out.shape[0]:
            break
        for stage in range(1, 4):
            share = step if stage == 3 else 0.5 * step
            for j in range(20):
                trial[j] = s[j] + share * slopes[stage - 1, j]
            z_trial[:] = z + share * z_slopes[stage - 1]
            for m in range(count):
                for i in range(4):
                    moved(laws_x[m], z[2 * i, m], trial[12 + 2 * i] - s[12 + 2 * i], z_trial[2 * i, m])
                    moved(laws_y[m], z[2 * i + 1, m], trial[13 + 2 * i] - s[13 + 2 * i], z_trial[2 * i + 1, m])
            _slope(
                mass, inverse, points, k, d, mu, laws_x, laws_y, laws_z, n * step + share, trial, z_trial,
                slopes[stage], z_slopes[stage], turn, arm, scratch,
            )  # fmt: skip
        for j in range(20):
            trial[j] = step / 6.0 * (slopes[0, j] + 2.0 * slopes[1, j] + 2.0 * slopes[2, j] + slopes[3, j])
            s[j] += trial[j]
        z += step / 6.0 * (z_slopes[0] + 2.0 * z_slopes[1] + 2.0 * z_slopes[2] + z_slopes[3])
        for m in range(count):
            for i in range(4):
                moved(laws_x[m], z[2 * i, m], trial[12 + 2 * i], z[2 * i, m])
                moved(laws_y[m], z[2 * i + 1, m], trial[13 + 2 * i], z[2 * i + 1, m])
    return largest
