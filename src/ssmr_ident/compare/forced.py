"""Rigs: driven by a measured force, or let go."""

from __future__ import annotations

import numpy as np

from ssmr_ident.campaign import MOTIONS, UNITS, Measurement
from ssmr_ident.compare.outcome import Prediction
from ssmr_ident.core.parameter import ParameterSet
from ssmr_ident.physics.rig import rig_from_parameters
from ssmr_ident.signals.grid import even_samples
from ssmr_ident.simulate.rig import simulate_rig

_COLUMN = {"position": 0, "angle": 0, "velocity": 1, "angular_rate": 1, "acceleration": 2, "acceleration_2": 2}
INPUTS = ("force", "torque")


def predict(parameters: ParameterSet, measurement: Measurement) -> Prediction:
    """Simulate a rig under its measured force; starting state, force zero and sensor zeros are fitted.

    All of these enter linearly, so one least-squares solution finds them. A second accelerometer elsewhere on
    the structure moves in proportion to the first: its gain is fitted as well.
    """
    rig = rig_from_parameters(parameters)
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

    def run(force: np.ndarray, position: float = 0.0, velocity: float = 0.0) -> np.ndarray:
        return simulate_rig(rig, force, even.sample_rate, position, velocity, bandwidth_hz=bandwidth)[:, columns]

    rest = np.zeros_like(force)
    driven = run(force) if drive else np.zeros_like(measured)
    parts = {"start_position": run(rest, position=1.0), "start_velocity": run(rest, velocity=1.0)}
    if drive:
        parts["force_zero"] = run(rest + 1.0)
    simulated, nuisances = _fit(measured, driven, parts, outputs)
    units = tuple(UNITS[name] for name in outputs)
    return Prediction(even.time, outputs, units, measured, simulated, nuisances=nuisances)


def _fit(
    measured: np.ndarray, driven: np.ndarray, parts: dict[str, np.ndarray], outputs: tuple[str, ...]
) -> tuple[np.ndarray, dict[str, float]]:
    """Each channel counts by its own size, so that metres and m/s^2 weigh alike."""
    scale = measured.std(axis=0)
    scale[scale == 0.0] = 1.0
    main = [index for index, name in enumerate(outputs) if name != "acceleration_2"]
    columns = [(part[:, main] / scale[main]).T.ravel() for part in parts.values()]
    names = list(parts)
    for position, index in enumerate(main):
        column = np.zeros((len(main), len(measured)))
        column[position] = 1.0
        columns.append(column.ravel())
        names.append(f"zero_{outputs[index]}")
    design = np.column_stack(columns)
    size = np.linalg.norm(design, axis=0)
    size[size == 0.0] = 1.0
    aim = ((measured - driven)[:, main] / scale[main]).T.ravel()
    # the cut-off leaves out what the record cannot tell from another nuisance (a force zero from a sensor zero)
    found = np.linalg.lstsq(design / size, aim, rcond=1e-6)[0] / size
    simulated = driven + sum(value * parts[name] for name, value in zip(names, found, strict=False) if name in parts)
    nuisances = dict(zip(names, map(float, found), strict=True))
    for position, index in enumerate(main):
        simulated[:, index] += found[len(parts) + position] * scale[index]
        nuisances[f"zero_{outputs[index]}"] *= float(scale[index])
    if "acceleration_2" in outputs:
        second = outputs.index("acceleration_2")
        gain, zero = np.polyfit(simulated[:, second], measured[:, second], 1)
        simulated[:, second] = gain * simulated[:, second] + zero
        nuisances |= {"gain_acceleration_2": float(gain), "zero_acceleration_2": float(zero)}
    return simulated, nuisances
