"""Free responses of the robot: the state at the release is fitted, the physics is not."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from scipy.signal import lfilter

from ssmr_ident.campaign import Measurement
from ssmr_ident.compare.outcome import Prediction
from ssmr_ident.core.errors import InputError
from ssmr_ident.core.parameter import ParameterSet
from ssmr_ident.identify.release import find_release
from ssmr_ident.physics.linear import LinearRobot, accelerometer_rows, linear_robot, responses
from ssmr_ident.physics.robot import GRAVITY, Robot, robot_from_parameters
from ssmr_ident.physics.sensor import low_pass_coefficients
from ssmr_ident.signals.filters import low_pass
from ssmr_ident.signals.grid import even_samples
from ssmr_ident.simulate.scenarios import Scenario
from ssmr_ident.simulate.simulation import simulate

AXES = ("ax", "ay", "az")
LOW_PASS_HZ = 50.0
# Scales of a plausible start (m, rad, m/s, rad/s): a weak pull towards rest that only decides between starts
# which the record cannot tell apart.
_SCALES = np.array([0.005, 0.005, 0.002, 0.02, 0.02, 0.02, 0.1, 0.1, 0.05, 0.5, 0.5, 0.5])
_PULL = 1e-4


def predict(parameters: ParameterSet, measurement: Measurement, decoupled: bool = False) -> Prediction:
    """Fit the start of a decay and simulate it.

    Parameters
    ----------
    parameters : ParameterSet
    measurement : Measurement
        At least one of ax, ay, az [m/s^2].
    decoupled : bool
        Pure rotations (5.3) in closed form instead of the 6-DOF simulator, on the thesis' channel alone.
    """
    robot = robot_from_parameters(parameters)
    recording = measurement.recording
    names = tuple(name for name in AXES if name in recording)
    if not names:
        raise InputError(
            recording.provenance.file, "a robot's decay needs ax, ay or az", "Map the columns by channels:"
        )
    even = even_samples(recording.time, np.column_stack([recording[name] for name in names]))
    begin = find_release(even.samples, 1.0 / even.sample_rate, (60.0,))
    measured, time = even.samples[begin:], even.time[begin:]
    rows = [AXES.index(name) for name in names]
    model = _decoupled(linear_robot(robot), robot) if decoupled else linear_robot(robot)
    jacobian = _jacobian(model, robot, time - time[0], even.sample_rate, rows)
    if decoupled:
        jacobian[:, :, [0, 1, 2, 6, 7, 8]] = 0.0
        run = _linear_runner(jacobian)
    else:
        run = _runner(robot, len(time), even.sample_rate, rows)
    start, bias, simulated = fit_start(measured, even.sample_rate, jacobian, run)
    nuisances = {f"start_{index}": value for index, value in enumerate(start)}
    nuisances |= {f"bias_{name}_m_s2": value for name, value in zip(names, bias, strict=True)}
    nuisances["release_s"] = float(time[0])
    return Prediction(time, names, ("m/s^2",) * len(names), measured, simulated + bias, nuisances=nuisances)


def _main_axis(measurement: Measurement) -> str:
    """The channel that a pure rotation is read from (5.8): gravity for roll and pitch, the lever arm for yaw."""
    axes = {"roll": "ay", "pitch": "ax", "yaw": "ay"}
    motion = measurement.entry.motion
    if motion is None:
        raise InputError(f"session entry {measurement.name}: motion", "is missing", "Give roll, pitch or yaw")
    return axes[motion]


def fit_start(
    measured: np.ndarray, sample_rate: float, jacobian: np.ndarray, run: Callable[[np.ndarray], np.ndarray]
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Least squares for the start of a decay, on the low-passed channels.

    The linear model gives the derivatives; the model itself gives the residual, so that the answer is the
    simulator's own. A step that does not help is halved.

    Returns
    -------
    (12,) float, (c,) float, (n, c) float
        Start (offsets, then velocities), sensor biases, simulated channels without bias.
    """
    n, channels = measured.shape
    target = low_pass(measured, sample_rate, LOW_PASS_HZ)
    smooth = low_pass(jacobian.reshape(n, -1), sample_rate, LOW_PASS_HZ).reshape(jacobian.shape)
    smooth = smooth - smooth.mean(axis=0)  # the bias is eliminated by taking means off
    design = np.moveaxis(smooth, 1, 0).reshape(n * channels, -1)
    weight = _PULL * np.linalg.norm(target - target.mean(axis=0)) / _SCALES
    stacked = np.vstack([design, np.diag(weight)])

    def misfit(simulated: np.ndarray) -> np.ndarray:
        rest = target - low_pass(simulated, sample_rate, LOW_PASS_HZ)
        return rest - rest.mean(axis=0)

    def cost_of(start: np.ndarray, rest: np.ndarray) -> float:
        return float(np.sum(rest**2) + np.sum((weight * start) ** 2))

    start = np.zeros(design.shape[1])
    simulated = run(start)
    rest = misfit(simulated)
    cost = cost_of(start, rest)
    for _ in range(8):
        aim = np.concatenate([rest.T.ravel(), -weight * start])
        move = np.linalg.lstsq(stacked, aim, rcond=None)[0]
        for share in (1.0, 0.5, 0.25, 0.1):
            trial = start + share * move
            trial_run = run(trial)
            trial_rest = misfit(trial_run)
            trial_cost = cost_of(trial, trial_rest)
            if trial_cost < cost:
                break
        else:
            break
        gain = 1.0 - trial_cost / cost
        start, simulated, rest, cost = trial, trial_run, trial_rest, trial_cost
        if gain < 1e-4:
            break
    return start, (target - low_pass(simulated, sample_rate, LOW_PASS_HZ)).mean(axis=0), simulated


def _runner(robot: Robot, samples: int, sample_rate: float, rows: list[int]) -> Callable[[np.ndarray], np.ndarray]:
    names = ("x", "y", "z", "roll", "pitch", "yaw")

    def run(start: np.ndarray) -> np.ndarray:
        scenario = Scenario(
            "free_response",
            samples / sample_rate,
            offset=dict(zip(names, start[:6], strict=True)),
            velocity=dict(zip(names, start[6:], strict=True)),
        )
        return simulate(robot, scenario, sample_rate, step=2e-4).values[:, rows]

    return run


def _linear_runner(jacobian: np.ndarray) -> Callable[[np.ndarray], np.ndarray]:
    return lambda start: jacobian @ start


def _jacobian(model: LinearRobot, robot: Robot, time: np.ndarray, sample_rate: float, rows: list[int]) -> np.ndarray:
    output = accelerometer_rows(model, robot.accelerometer.position, GRAVITY)[rows]
    course = responses(model.state_matrix, output, time)
    c = low_pass_coefficients(robot.accelerometer.bandwidth_hz, 1.0 / sample_rate)
    return lfilter(c[:3], [1.0, c[3], c[4]], course, axis=0)


def _decoupled(model: LinearRobot, robot: Robot) -> LinearRobot:
    """Pure rotations about the CoM (5.3): no translation, no products of inertia, no coupling, no m g h."""
    tire_k, tire_d, points = robot.stiffness, robot.damping, robot.contact_points
    squares = (points**2).sum(axis=0)
    stiffness, damping = (
        np.diag([k[1] * squares[2] + k[2] * squares[1], k[0] * squares[2] + k[2] * squares[0],
                 k[0] * squares[1] + k[1] * squares[0]])
        for k in (tire_k, tire_d)
    )  # fmt: skip
    empty = np.zeros((3, 3))
    locked = np.block([[np.eye(3) * 1e6, empty], [empty, empty]])  # holds the CoM in place
    inertia = np.diag(np.diag(robot.inertia))
    return LinearRobot(
        np.block([[np.eye(3) * robot.mass, empty], [empty, inertia]]),
        np.block([[empty, empty], [empty, damping]]),
        locked + np.block([[empty, empty], [empty, stiffness]]),
    )
