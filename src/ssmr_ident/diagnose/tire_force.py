"""The force that tires are missing, from what a robot's accelerometer shows beyond the simulation.

The loudest pattern of tire deflections in a decay is taken as the coordinate u; a force f on that pattern moves the
linearised robot, and the sensor shows −H(s)·f of it. H is known, so f follows by a Wiener filter over all channels.
Source: Masri and Caughey (1979) for the surface; Wiener deconvolution as in Press et al., Numerical Recipes, 13.3.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from ssmr_ident.core.parameter import ParameterSet
from ssmr_ident.diagnose.motion import filtered, main_channel, main_frequency
from ssmr_ident.identify.body.builder import RobotBuilder
from ssmr_ident.identify.body.output_error import START_SCALES
from ssmr_ident.identify.fitting.joint import JointFit
from ssmr_ident.identify.trials.decay import SCALES
from ssmr_ident.identify.trials.trial import Trial
from ssmr_ident.physics.linear import LinearRobot, accelerometer_rows, linear_robot, responses
from ssmr_ident.physics.robot import GRAVITY, Robot

Array = np.ndarray

LOWEST, REACH = 0.5, 3.0
"""Ends of the band, in units of the main frequency."""

QUIETEST = 0.15
"""Share of the largest gain that is added to every gain's square: where the robot hardly answers, noise and what one
pattern of tires cannot explain would pass for a force."""

SMALLEST = 0.1
"""Share of the largest below which a further pattern of deflections is not looked for."""

PLACES = ("x", "y", "z")


@dataclass(frozen=True, eq=False)
class TireState:
    """Of one decay: deflection of the most deflected tire and its rate, and the force that is missing there.

    Parameters
    ----------
    deflection : (n,) float [m]
    rate : (n,) float [m/s]
    forces : tuple of (n,) float [N]
        One per residual.
    place : str
        In words.
    """

    deflection: Array
    rate: Array
    forces: tuple[Array, ...]
    place: str


def is_robot(trial: Trial) -> bool:
    """A robot's decay, simulated with all six degrees of freedom."""
    return trial.experiment.free and len(trial.nuisances) == len(SCALES) and len(trial.channels) > 1


def tire_state(fit: JointFit, index: int, parameters: ParameterSet, simulated: Sequence[Array]) -> TireState:
    """Deflection in the fit's own motion, and the force missing in each simulation.

    Parameters
    ----------
    fit : JointFit
    index : int
        Of a trial with ``is_robot``.
    parameters : ParameterSet
    simulated : sequence of (n, c) float
        What the measured accelerations are held against.
    """
    trial = fit.trials[index]
    values, _ = fit.model.split(fit.point)
    robot = RobotBuilder.of(parameters)(values)
    linear = linear_robot(robot)
    course = _course(linear, robot, trial, fit.simulated[index])
    jacobian = np.vstack([np.hstack([np.eye(3), -_cross(point)]) for point in robot.contact_points])
    _, sizes, patterns = np.linalg.svd(course[:, :6] @ jacobian.T, full_matrices=False)
    count = min(len(trial.channels), int(np.count_nonzero(sizes > SMALLEST * sizes[0])))
    pattern = patterns[0] / patterns[0][np.argmax(np.abs(patterns[0]))]
    # orthogonal patterns share no work, so each has its own force; all are sought, the first is what is shown
    wrenches = jacobian.T @ np.column_stack([pattern, *patterns[1:count]])
    along = jacobian.T @ pattern / (pattern @ pattern)
    forces = tuple(_missing(trial, trial.colour(one), robot, wrenches) for one in simulated)
    deflection, rate = course[:, :6] @ along, course[:, 6:] @ along
    axis = PLACES[int(np.argmax(np.abs(pattern))) % 3]
    return TireState(deflection, rate, forces, f"deflection of the tires along {axis}")


def _course(linear: LinearRobot, robot: Robot, trial: Trial, simulated: Array) -> Array:
    """State of the linear robot, (n, 12), whose accelerations are nearest to those simulated."""
    since = trial.times - trial.times[0]
    rows = accelerometer_rows(linear, robot.accelerometer.position, GRAVITY)[_axes(trial)]
    columns = responses(linear.state_matrix, rows, since) * START_SCALES
    stds = np.array([noise.std for noise in trial.noises])
    design = (columns / stds[:, None]).reshape(-1, 12)
    wanted = ((simulated - simulated.mean(axis=0)) / stds).ravel()
    start = START_SCALES * np.linalg.solve(design.T @ design + np.eye(12), design.T @ wanted)
    return responses(linear.state_matrix, np.eye(12), since) @ start


def _axes(trial: Trial) -> list[int]:
    return ["xyz".index(name[1]) for name in trial.channels]


def _missing(trial: Trial, rest: Array, robot: Robot, wrenches: Array) -> Array:
    """Force on the first of some patterns of tires, by a Wiener filter over the channels.

    ``wrenches``, (6, k), are those of 1 N on each.
    """
    frequency = main_frequency(trial.target[:, main_channel(trial)], trial.step, 2)
    lowest, highest = LOWEST * frequency, REACH * frequency
    stds = np.array([noise.std for noise in trial.noises])
    channels = _axes(trial)

    def gains(s: Array) -> Array:
        return _seen(robot, wrenches, s)[:, channels] / stds[:, None]

    largest = float(np.max(np.abs(gains(2j * np.pi * np.linspace(lowest, highest, 400))) ** 2))
    found = np.zeros(len(rest))
    for number in range(len(channels)):

        def operator(s: Array, number: int = number) -> Array:
            h = gains(s)
            turned = np.conj(np.swapaxes(h, 1, 2))
            gram = turned @ h + QUIETEST**2 * largest * np.eye(h.shape[2])
            return -np.linalg.solve(gram, turned[:, :, [number]])[:, 0, 0] / stds[number]

        found += filtered(rest[:, number], trial.step, operator, lowest, highest)
    return found


def _seen(robot: Robot, wrenches: Array, s: Array) -> Array:
    """ax, ay, az at the accelerometer per newton on each pattern, (f, 3, k) complex."""
    linear = linear_robot(robot)
    matrices = linear.mass * s[:, None, None] ** 2 + linear.damping * s[:, None, None] + linear.stiffness
    moved = np.linalg.solve(matrices, np.broadcast_to(wrenches, (len(s), *wrenches.shape)))
    seen = s[:, None, None] ** 2 * (moved[:, :3] - _cross(robot.accelerometer.position) @ moved[:, 3:])
    seen[:, 0] -= GRAVITY * moved[:, 4]  # a tilt turns gravity into the axes
    seen[:, 1] += GRAVITY * moved[:, 3]
    return seen


def _cross(arm: Array) -> Array:
    """Matrix of the cross product: _cross(a) @ b = a × b."""
    return np.array([[0.0, -arm[2], arm[1]], [arm[2], 0.0, -arm[0]], [-arm[1], arm[0], 0.0]])
