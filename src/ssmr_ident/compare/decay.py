"""Free responses of the robot: the state at the release is fitted, the physics is not."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from scipy.signal import lfilter, lfilter_zi

from ssmr_ident.campaign import Measurement
from ssmr_ident.compare.outcome import Prediction
from ssmr_ident.core.errors import InputError
from ssmr_ident.core.parameter import ParameterSet
from ssmr_ident.identify.release import find_release
from ssmr_ident.physics.linear import LinearRobot, accelerometer_rows, linear_robot, pure_rotations, responses
from ssmr_ident.physics.robot import GRAVITY, Robot, robot_from_parameters
from ssmr_ident.physics.sensor import low_pass_coefficients
from ssmr_ident.physics.slots import Effects, effect_values
from ssmr_ident.signals.clean import MAINS_HZ
from ssmr_ident.signals.filters import low_pass
from ssmr_ident.signals.grid import even_samples
from ssmr_ident.simulate.scenarios import Scenario
from ssmr_ident.simulate.simulation import simulate

AXES = ("ax", "ay", "az")
LOW_PASS_HZ = 50.0
# Scales of a plausible start (m, rad, m/s, rad/s): a prior that only decides between starts which the record
# cannot tell apart.
_SCALES = np.array([1e-3, 1e-3, 3e-4, 5e-3, 5e-3, 5e-3, 0.03, 0.03, 0.02, 0.15, 0.15, 0.15, 2e-3, 2e-3, 0.1, 0.1])
_NOISE_FLOOR = 1e-3  # share of the signal that is taken as noise at the least: no sensor is better
_STRAIGHT = 0.02  # a run within this share of the linear model needs no derivatives of its own
_MOTIONS = ("x", "y", "z", "roll", "pitch", "yaw", "vx", "vy", "vz", "wx", "wy", "wz")
STATES = (*_MOTIONS, "sway_x", "sway_y", "sway_vx", "sway_vy")


def predict(parameters: ParameterSet, measurement: Measurement, decoupled: bool = False) -> Prediction:
    """Fit the start of a decay and simulate it.

    Parameters
    ----------
    parameters : ParameterSet
        With its effects.
    measurement : Measurement
        At least one of ax, ay, az [m/s^2].
    decoupled : bool
        Pure rotations (5.3) in closed form instead of the 6-DOF simulator, on the thesis' channel alone.
    """
    robot, effects = robot_from_parameters(parameters), effect_values(parameters)
    recording = measurement.recording
    wanted = (_main_axis(measurement),) if decoupled else AXES
    names = tuple(name for name in wanted if name in recording)
    if not names:
        where, found = recording.provenance.file, ", ".join(recording.names)
        raise InputError(where, f"needs {' or '.join(wanted)}; found {found}", "Map the columns by channels:")
    even = even_samples(recording.time, np.column_stack([recording[name] for name in names]))
    begin = find_release(even.samples, 1.0 / even.sample_rate, (60.0,))
    measured, time = even.samples[begin:], even.time[begin:]
    rows = [AXES.index(name) for name in names]
    if decoupled and "translation_coupling" in effects:
        decoupled = False
    model = pure_rotations(robot) if decoupled else linear_robot(robot)
    jacobian = _jacobian(model, robot, time - time[0], even.sample_rate, rows)
    if decoupled:
        jacobian[:, :, [0, 1, 2, 6, 7, 8]] = 0.0
        run = _linear_runner(jacobian)
    else:
        run = _runner(robot, effects, len(time), even.sample_rate, rows)
    start, bias, simulated = fit_start(measured, even.sample_rate, jacobian, run, exact=not decoupled)
    nuisances = {f"start_{name}": float(value) for name, value in zip(STATES, start, strict=True) if value != 0.0}
    nuisances |= {f"bias_{name}_m_s2": float(value) for name, value in zip(names, bias, strict=True)}
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
    measured: np.ndarray,
    sample_rate: float,
    jacobian: np.ndarray,
    run: Callable[[np.ndarray], np.ndarray],
    exact: bool = True,
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Least squares for the start of a decay, on the low-passed channels, sensor biases eliminated.

    The mains line is fitted alongside and not simulated. The derivatives come from the linear model as long as they
    help, then from differences of the simulator itself: contacts that slide and nonlinear effects bend the response.
    The residual is always the simulator's own, and a step that does not help is shortened.

    Parameters
    ----------
    measured : (n, c) float [m/s^2]
    sample_rate : float [Hz]
    jacobian : (n, c, 12) float
        Of the linear model.
    run : callable
        Start, (16,) float, to channels, (n, c) float.
    exact : bool
        Go on with differences of ``run`` after the linear derivatives.

    Returns
    -------
    (16,) float, (c,) float, (n, c) float
        Start (offsets, velocities, sway of a mast and its rate), biases, simulated channels without bias.
    """
    n, channels = measured.shape

    def smooth(signal: np.ndarray) -> np.ndarray:
        """Low-passed without its mean, channels one after the other: (n, c, ...) to (n c, ...)."""
        flat = low_pass(signal.reshape(n, -1), sample_rate, LOW_PASS_HZ)
        return np.moveaxis((flat - flat.mean(axis=0)).reshape(signal.shape), 1, 0).reshape(n * channels, -1)

    target = smooth(measured)[:, 0]
    # noise of the low-passed samples from the last fifth, where the decay is over
    tail = target.reshape(channels, n)[:, int(0.8 * n) :]
    noise = max(float(np.std(tail - tail.mean(axis=1, keepdims=True))), _NOISE_FLOOR * float(np.std(target)))
    weight = noise / _SCALES
    full = np.zeros((n, channels, len(STATES)))
    full[:, :, : jacobian.shape[2]] = jacobian
    start = np.zeros(len(STATES))
    simulated = run(start)
    base = smooth(simulated)[:, 0]
    hum = (
        smooth(_hum_columns(n, channels, sample_rate)) if sample_rate > 2.0 * MAINS_HZ else np.zeros((n * channels, 0))
    )
    directions = np.linalg.qr(hum)[0]

    def without_hum(rest: np.ndarray) -> np.ndarray:
        return rest - directions @ (directions.T @ rest)

    cost = _cost(without_hum(target - base), weight, start)
    design = smooth(full)
    first, differences = base, False
    for _ in range(14):
        rest = target - base
        stacked = np.block([[design, hum], [np.diag(weight), np.zeros((len(start), hum.shape[1]))]])
        move = np.linalg.lstsq(stacked, np.concatenate([rest, -weight * start]), rcond=None)[0][: len(start)]
        gain = 0.0
        for share in (1.0, 0.5, 0.2, 0.05):
            trial = start + share * move
            trial_run = run(trial)
            trial_base = smooth(trial_run)[:, 0]
            trial_cost = _cost(without_hum(target - trial_base), weight, trial)
            if trial_cost < cost:
                gain = 1.0 - trial_cost / cost
                start, simulated, base, cost = trial, trial_run, trial_base, trial_cost
                break
        if gain > 1e-3:
            if differences:
                design = smooth(_differences(run, start, simulated))
            continue
        bent = base - first - design @ start
        if differences or not exact or np.linalg.norm(bent) < _STRAIGHT * np.linalg.norm(base - first):
            break
        differences = True
        design = smooth(_differences(run, start, simulated))
    bias = (low_pass(measured, sample_rate, LOW_PASS_HZ) - low_pass(simulated, sample_rate, LOW_PASS_HZ)).mean(axis=0)
    return start, bias, simulated


def _hum_columns(n: int, channels: int, sample_rate: float) -> np.ndarray:
    """Cosine and sine of the mains line in each channel, (n, c, 2c): what a low-pass leaves of it near the ends of a
    record would otherwise be taken for motion."""
    angle = 2.0 * np.pi * MAINS_HZ * np.arange(n) / sample_rate
    columns = np.zeros((n, channels, 2 * channels))
    for index in range(channels):
        columns[:, index, 2 * index], columns[:, index, 2 * index + 1] = np.cos(angle), np.sin(angle)
    return columns


def _cost(rest: np.ndarray, weight: np.ndarray, start: np.ndarray) -> float:
    return float(np.sum(rest**2) + np.sum((weight * start) ** 2))


def _differences(run: Callable[[np.ndarray], np.ndarray], start: np.ndarray, simulated: np.ndarray) -> np.ndarray:
    """Derivatives of the simulated channels by the start, (n, c, 16)."""
    columns = []
    for index, scale in enumerate(_SCALES):
        moved = start.copy()
        moved[index] += 1e-3 * scale
        columns.append((run(moved) - simulated) / (1e-3 * scale))
    return np.stack(columns, axis=-1)


def _runner(
    robot: Robot, effects: Effects, samples: int, sample_rate: float, rows: list[int]
) -> Callable[[np.ndarray], np.ndarray]:
    names = STATES[:6]

    def run(start: np.ndarray) -> np.ndarray:
        offset = dict(zip((*names, "sway_x", "sway_y"), (*start[:6], *start[12:14]), strict=True))
        velocity = dict(zip((*names, "sway_x", "sway_y"), (*start[6:12], *start[14:]), strict=True))
        scenario = Scenario("free_response", samples / sample_rate, offset=offset, velocity=velocity)
        return simulate(robot, scenario, sample_rate, step=2e-4, effects=effects).values[:, rows]

    return run


def _linear_runner(jacobian: np.ndarray) -> Callable[[np.ndarray], np.ndarray]:
    return lambda start: jacobian @ start[: jacobian.shape[2]]


def _jacobian(model: LinearRobot, robot: Robot, time: np.ndarray, sample_rate: float, rows: list[int]) -> np.ndarray:
    output = accelerometer_rows(model, robot.accelerometer.position, GRAVITY)[rows]
    course = responses(model.state_matrix, output, time)
    c = low_pass_coefficients(robot.accelerometer.bandwidth_hz, 1.0 / sample_rate)
    if c[0] == 1.0:  # a sensor that passes everything
        return course
    forward, feedback = c[:3], np.array([1.0, c[3], c[4]])
    # the simulator's low-pass starts as if the first value had always been there
    settled = lfilter_zi(forward, feedback)[:, None, None] * course[:1]
    return lfilter(forward, feedback, course, axis=0, zi=settled)[0]
