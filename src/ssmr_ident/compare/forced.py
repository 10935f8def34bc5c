"""Rigs: driven by a measured force, or let go."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from ssmr_ident.campaign import MOTIONS, UNITS, Measurement
from ssmr_ident.compare.outcome import Prediction
from ssmr_ident.core.parameter import ParameterSet
from ssmr_ident.physics.rig import rig_from_parameters
from ssmr_ident.physics.slots import Effects, effect_values
from ssmr_ident.signals.grid import even_samples
from ssmr_ident.simulate.rig import simulate_rig

_COLUMN = {"position": 0, "angle": 0, "velocity": 1, "angular_rate": 1, "acceleration": 2, "acceleration_2": 2}
INPUTS = ("force", "torque")


def predict(parameters: ParameterSet, measurement: Measurement) -> Prediction:
    """Simulate a rig under its measured force; starting state, force zero and sensor zeros are fitted.

    Without effects all of these enter linearly and one least-squares solution finds them; with effects the linear
    model's derivatives are used until they no longer help. A second accelerometer elsewhere on the structure
    moves in proportion to the first: its gain is fitted as well.
    """
    rig, effects = rig_from_parameters(parameters), effect_values(parameters)
    recording = measurement.recording
    outputs = tuple(name for name in (*MOTIONS, "acceleration_2") if name in recording)
    drive = next((name for name in INPUTS if name in recording), None)
    wanted = (*outputs, drive) if drive else outputs
    even = even_samples(recording.time, np.column_stack([recording[name] for name in wanted]))
    measured = even.samples[:, : len(outputs)]
    force = even.samples[:, -1] if drive else np.zeros(len(measured))
    columns = [_COLUMN[name] for name in outputs]
    bandwidth = parameters.number("accelerometer.bandwidth_hz", float("inf"))
    if bandwidth >= 0.5 * even.sample_rate:
        # the force comes through a sensor and a converter of the same kind: what both delay alike cancels
        bandwidth = float("inf")

    def run(force: np.ndarray, start: np.ndarray, effects: Effects | None = None) -> np.ndarray:
        position, velocity = float(start[0]), float(start[1])
        motion = simulate_rig(rig, force, even.sample_rate, position, velocity, bandwidth_hz=bandwidth, effects=effects)
        return motion[:, columns]

    rest = np.zeros_like(force)
    names = ["start_position", "start_velocity"] + (["force_zero"] if drive else [])
    parts = [run(rest, np.array([1.0, 0.0])), run(rest, np.array([0.0, 1.0]))]
    if drive:
        parts.append(run(rest + 1.0, np.zeros(2)))

    def full(found: np.ndarray) -> np.ndarray:
        return run(force + (found[2] if drive else 0.0), found[:2], effects)

    simulated, nuisances = _fit(measured, full, np.stack(parts, axis=-1), names, outputs)
    units = tuple(UNITS[name] for name in outputs)
    return Prediction(even.time, outputs, units, measured, simulated, nuisances=nuisances)


def _fit(
    measured: np.ndarray,
    full: Callable[[np.ndarray], np.ndarray],
    parts: np.ndarray,
    names: list[str],
    outputs: tuple[str, ...],
) -> tuple[np.ndarray, dict[str, float]]:
    """Nuisances by least squares; each channel counts by its own size, so that metres and m/s^2 weigh alike.

    ``parts`` is the linear model's answer to a unit of each nuisance, (n, c, k). Sensor zeros are eliminated by
    taking means off.
    """
    scale = measured.std(axis=0)
    scale[scale == 0.0] = 1.0
    main = [index for index, name in enumerate(outputs) if name != "acceleration_2"]

    def stacked(signal: np.ndarray) -> np.ndarray:
        part = signal[:, main] / scale[main].reshape((-1,) + (1,) * (signal.ndim - 2))
        return np.concatenate(list(np.moveaxis(part - part.mean(axis=0), 1, 0)))

    design, target = stacked(parts), stacked(measured)
    size = np.linalg.norm(design, axis=0)
    size[size == 0.0] = 1.0
    found = np.zeros(len(names))
    simulated = full(found)
    rest = target - stacked(simulated)
    for _ in range(12):
        # the cut-off leaves out what the record cannot tell from another nuisance (a force zero from a sensor zero)
        move = np.linalg.lstsq(design / size, rest, rcond=1e-6)[0] / size
        gain = 0.0
        for share in (1.0, 0.3, 0.1):
            trial = full(found + share * move)
            trial_rest = target - stacked(trial)
            if np.sum(trial_rest**2) < np.sum(rest**2):
                gain = 1.0 - np.sum(trial_rest**2) / np.sum(rest**2)
                found, simulated, rest = found + share * move, trial, trial_rest
                break
        if gain < 1e-4:
            break
    nuisances = dict(zip(names, map(float, found), strict=True))
    simulated = simulated.copy()
    for index in main:
        zero = float(np.mean(measured[:, index] - simulated[:, index]))
        simulated[:, index] += zero
        nuisances[f"zero_{outputs[index]}"] = zero
    if "acceleration_2" in outputs:
        second = outputs.index("acceleration_2")
        gain, zero = np.polyfit(simulated[:, second], measured[:, second], 1)
        simulated[:, second] = gain * simulated[:, second] + zero
        nuisances |= {"gain_acceleration_2": float(gain), "zero_acceleration_2": float(zero)}
    return simulated, nuisances
