"""What the full simulator shows of a decay beyond small motions on sticking tires.

The difference between simulator and closed form at the same parameters and start is taken from the recording, and
the closed form fitted to the rest (defect correction; Stetter, Numer. Math. 29, 1978). At its fixed point the residual
is the simulator's own, while all derivatives stay those of the closed form.
"""

from __future__ import annotations

import numpy as np
from scipy.signal import lfilter, lfilter_zi

from ssmr_ident.experiments import FREE_RESPONSE, Scenario
from ssmr_ident.identify.body.free_decays import BodyDecay
from ssmr_ident.physics.linear import COORDINATES, accelerometer_rows, linear_robot, responses
from ssmr_ident.physics.robot import GRAVITY, Robot
from ssmr_ident.physics.sensor import low_pass_coefficients
from ssmr_ident.physics.slots import Effects
from ssmr_ident.simulate.simulation import simulate

Array = np.ndarray

STEP = 2e-4
"""Of the simulator [s]: half of it moves no parameter of the reference decays by a hundredth of its std."""


def defect(decay: BodyDecay, robot: Robot, start: Array, effects: Effects | None = None) -> Array:
    """Simulator minus closed form on the decay's block grid, (n, c) float [m/s^2].

    Parameters
    ----------
    decay : BodyDecay
    robot : Robot
    start : (12,) float
        Displacements from rest and velocities at the release [m, rad, m/s, rad/s].
    effects : mapping, optional
        Physics beyond the baseline that the simulator runs with.
    """
    samples, step = len(decay.record.samples), decay.record.step
    scenario = Scenario(
        FREE_RESPONSE.name,
        samples * step,
        offset=dict(zip(COORDINATES, map(float, start[:6]), strict=True)),
        velocity=dict(zip(COORDINATES, map(float, start[6:]), strict=True)),
    )
    axes = list(decay.axes)
    run = simulate(robot, scenario, 1.0 / step, step=STEP, effects=effects).values[:, axes]
    difference = decay.averaged((run - small_motion(robot, start, samples, step)[:, axes])[None])[0]
    # The resting values differ (gravity, zero); each channel has its own offset, so the end is taken as zero.
    result: Array = difference - difference[-1]
    return result


def small_motion(robot: Robot, start: Array, samples: int, step: float) -> Array:
    """Closed form behind the accelerometer's low-pass, (n, 3) float [m/s^2]."""
    linear = linear_robot(robot)
    rows = accelerometer_rows(linear, robot.accelerometer.position, GRAVITY)
    course: Array = responses(linear.state_matrix, rows, step * np.arange(samples)) @ start
    c = low_pass_coefficients(robot.accelerometer.bandwidth_hz, step)
    if c[0] == 1.0:
        return course
    forward, feedback = c[:3], np.array([1.0, c[3], c[4]])
    # as the simulator's: as if the first value had always been there
    settled = lfilter_zi(forward, feedback)[:, None] * course[:1]
    result: Array = lfilter(forward, feedback, course, axis=0, zi=settled)[0]
    return result
