"""Swivels and straight runs: stick-slip does not repeat its waveform, so spectra are compared.

The wheels slide all the time, so a contact slides along both axes together here (``sliding_force``): with the relay of
(6.4), axis by axis, simulated swivels hardly shake. What the parameter file does not say of this is taken from the
constants below; a diagnosis fits them.
"""

from __future__ import annotations

import numpy as np

from ssmr_ident.compare.outcome import Prediction
from ssmr_ident.core.errors import InputError
from ssmr_ident.core.parameter import ParameterSet
from ssmr_ident.core.recording import Recording
from ssmr_ident.experiments.campaign import Measurement
from ssmr_ident.experiments.scenario import Scenario
from ssmr_ident.physics.motor import wheel_rates
from ssmr_ident.physics.robot import Robot, robot_from_parameters
from ssmr_ident.physics.slots import Effects, effect_values
from ssmr_ident.signals.grid import even_samples
from ssmr_ident.signals.noise import quietest_density
from ssmr_ident.simulate.simulation import simulate

AXES = ("ax", "ay", "az")
SETTLING = 2.0  # s run before the record, so that motor and tires are in their steady course
FLOOR_HEIGHT, FLOOR_LENGTH = 3e-5, 6e-3  # m: a smooth floor, whose grain keeps runs from repeating
_NOISE_SEED = 1


def turning_robot(parameters: ParameterSet) -> Robot:
    """The robot with contacts that slide along both axes together."""
    return robot_from_parameters(parameters).sliding_together()


def with_floor(effects: Effects, parameters: ParameterSet, seed: float = 1.0) -> dict[str, dict[str, float]]:
    """The effects, and the fine unevenness that every floor has where none is among them."""
    grain = {
        "height_m": parameters.number("floor.height_m", FLOOR_HEIGHT),
        "length_m": parameters.number("floor.length_m", FLOOR_LENGTH),
        "seed": seed,
    }
    return {"ground_roughness": grain, **{name: dict(values) for name, values in effects.items()}}


def predict(parameters: ParameterSet, measurement: Measurement) -> Prediction:
    """Simulate a run at the wanted speed for as long as it was recorded, with as much sensor noise as it holds.

    Raises
    ------
    InputError
        Neither yaw rate, wheel speed nor wheel log is given.
    """
    robot = turning_robot(parameters)
    recording = measurement.recording
    names = tuple(name for name in AXES if name in recording)
    even = even_samples(recording.time, np.column_stack([recording[name] for name in names]))
    rates, rate_step, settling = wanted_rates(robot, measurement)
    duration = len(even.samples) / even.sample_rate
    scenario = Scenario(measurement.entry.experiment, duration + settling, wheel_rates=rates, wheel_rate_step=rate_step)
    active = with_floor(effect_values(parameters), parameters)
    simulation = simulate(robot, scenario, even.sample_rate, effects=active)
    skip = len(simulation.time) - len(even.samples)
    simulated = simulation.values[skip:][:, [AXES.index(name) for name in names]]
    # of the quietest part of a spectrum only what the motion does not put there itself is the sensor's
    beyond = quietest_density(even.samples, even.sample_rate) - quietest_density(simulated, even.sample_rate)
    noise = np.sqrt(np.maximum(beyond, 0.0) * 0.5 * even.sample_rate)
    simulated = simulated + noise * np.random.default_rng(_NOISE_SEED).standard_normal(simulated.shape)
    # a mounting that is not quite level shows as a constant: it is the sensor's, not the motion's
    simulated = simulated - simulated.mean(axis=0) + even.samples.mean(axis=0)
    nuisances = {f"noise_{name}_m_s2": float(value) for name, value in zip(names, noise, strict=True)}
    return Prediction(
        even.time, names, ("m/s^2",) * len(names), even.samples, simulated,
        metric="log_psd_db", low_pass_hz=None, nuisances=nuisances,
    )  # fmt: skip


def wanted_rates(robot: Robot, measurement: Measurement) -> tuple[np.ndarray, float, float]:
    """Wanted wheel rates (k, 2) [rad/s], the step between them [s], and how long to run before the record [s]."""
    entry = measurement.entry
    if measurement.wheels is not None:
        return _from_log(robot, measurement.wheels, measurement.recording)
    if entry.wheel_speed_m_s is not None:
        sign = np.array(measurement.experiment.wheel_signs)
        return np.atleast_2d(sign * entry.wheel_speed_m_s / robot.radius), 1.0, SETTLING
    if entry.yaw_rate_deg_s is not None:
        return np.atleast_2d(wheel_rates(robot, 0.0, np.deg2rad(entry.yaw_rate_deg_s))), 1.0, SETTLING
    raise InputError(
        f"session entry {entry.file}",
        f"a {entry.experiment} needs yaw_rate_deg_s, wheel_speed_m_s or wheel_log",
        "Add one of them to session.yaml",
    )


def _from_log(robot: Robot, wheels: Recording, recording: Recording) -> tuple[np.ndarray, float, float]:
    """Wheel speeds as logged, on the recording's own clock."""
    missing = [name for name in ("v_left", "v_right") if name not in wheels]
    if missing:
        raise InputError(
            wheels.provenance.file,
            f"has no {' or '.join(missing)}; found {', '.join(wheels.names)}",
            "Rename the columns",
        )
    step = 1.0 / wheels.sample_rate
    grid = np.arange(recording.time[0], recording.time[-1], step)
    speeds = np.column_stack([np.interp(grid, wheels.time, wheels[name]) for name in ("v_left", "v_right")])
    return speeds / robot.radius, step, 0.0
