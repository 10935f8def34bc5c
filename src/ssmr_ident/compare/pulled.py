"""Pulls and bench tests: where the head was when the cable tightened, and the load cell's zero, are fitted."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from scipy.optimize import minimize_scalar

from ssmr_ident.campaign import Measurement
from ssmr_ident.compare.outcome import Prediction
from ssmr_ident.core.errors import InputError
from ssmr_ident.core.parameter import ParameterSet
from ssmr_ident.physics.rig import block_from_parameters
from ssmr_ident.physics.robot import robot_from_parameters
from ssmr_ident.physics.slots import effect_values
from ssmr_ident.signals.grid import even_samples
from ssmr_ident.simulate.bench import compress_wheel, drag_wheel, pull_block
from ssmr_ident.simulate.scenarios import Scenario, cable_properties, fixture_needed
from ssmr_ident.simulate.simulation import simulate

_STEADY = 0.005  # share of the travel by which a head at constant speed may be off a straight line


def predict_robot(parameters: ParameterSet, measurement: Measurement) -> Prediction:
    """A robot pulled by a cable."""
    robot, effects = robot_from_parameters(parameters), effect_values(parameters)
    entry = measurement.entry
    stiffness, damping = cable_properties(entry.cable)
    rates = np.full((1, 2), entry.wheel_rate_rad_s or 0.0)

    def run(head: np.ndarray, step: float) -> np.ndarray:
        scenario = Scenario(
            "pull",
            len(head) * step,
            head=head,
            head_step=step,
            direction=entry.direction or "lateral",
            height=0.05 if entry.height_m is None else entry.height_m,
            wheels_gripping=entry.wheels_gripping,
            cable_stiffness=stiffness,
            cable_damping=damping,
            wheel_rates=rates,
            held=fixture_needed(entry.wheels_gripping, entry.wheel_rate_rad_s or 0.0),
        )
        return simulate(robot, scenario, 1.0 / step, effects=effects)["force"]

    return _fitted(measurement, run)


def predict_wheel(parameters: ParameterSet, measurement: Measurement) -> Prediction:
    """One wheel dragged sideways or pressed down."""
    robot, effects = robot_from_parameters(parameters), effect_values(parameters)
    if measurement.entry.experiment == "vertical_compression":
        return _fitted(measurement, lambda head, step: compress_wheel(robot, head, step, effects=effects))
    free = measurement.entry.free_normal
    return _fitted(measurement, lambda head, step: drag_wheel(robot, head, step, free, effects))


def predict_block(parameters: ParameterSet, measurement: Measurement) -> Prediction:
    """A block pulled over a surface."""
    block, effects = block_from_parameters(parameters), effect_values(parameters)
    return _fitted(measurement, lambda head, step: pull_block(block, head, step, effects))


def _fitted(measurement: Measurement, run: Callable[[np.ndarray, float], np.ndarray]) -> Prediction:
    """Slack by a search over the head's travel, the load cell's zero by its mean."""
    recording, entry = measurement.recording, measurement.entry
    if "position" in recording:
        even = even_samples(recording.time, np.column_stack([recording["force"], recording["position"]]))
        travel = even.samples[:, 1] - even.samples[0, 1]
        if abs(travel.min()) > abs(travel.max()):
            travel = -travel
    elif entry.speed_mm_s:
        even = even_samples(recording.time, recording["force"][:, None])
        travel = entry.speed_mm_s * 1e-3 * (even.time - even.time[0])
    else:
        raise InputError(recording.provenance.file, "has no position, and session.yaml no speed_mm_s", "Give one")
    force, step = even.samples[:, 0], 1.0 / even.sample_rate

    def run_behind(slack: float) -> np.ndarray:
        return run(np.maximum(travel - slack, 0.0), step)

    slack = _find_slack(force, travel, step, run_behind)
    simulated = run_behind(slack)
    zero = float((force - simulated).mean())
    return Prediction(
        even.time,
        ("force",),
        ("N",),
        force[:, None],
        (simulated + zero)[:, None],
        low_pass_hz=None,
        nuisances={"slack_m": slack, "zero_N": zero},
    )


def _find_slack(force: np.ndarray, travel: np.ndarray, step: float, run_behind: Callable[[float], np.ndarray]) -> float:
    """Travel of the head before the cable tightens [m], by least squares with the load cell's zero eliminated.

    Up to a third of the travel; a log that starts under load is told apart by the zero. A head that moves at constant
    speed makes slack a delay, so one simulation serves for all; otherwise each slack is simulated.
    """
    elapsed = step * np.arange(len(travel))
    speed = float(np.polyfit(elapsed, travel, 1)[0])
    steady = np.abs(travel - speed * elapsed).max() < _STEADY * travel.max()
    behind = _delayed(run_behind(0.0), elapsed, speed) if steady else run_behind

    def misfit(slack: float) -> float:
        rest = force - behind(slack)
        return float(np.sum((rest - rest.mean()) ** 2))

    grid = np.linspace(0.0, travel.max() / 3.0, 400 if steady else 9)
    costs = [misfit(slack) for slack in grid]
    best = int(np.argmin(costs))
    low, high = grid[max(best - 1, 0)], grid[min(best + 1, len(grid) - 1)]
    refined = minimize_scalar(misfit, bounds=(low, high), method="bounded", options={"maxiter": 12})
    return float(refined.x) if refined.fun < costs[best] else float(grid[best])


def _delayed(tight: np.ndarray, elapsed: np.ndarray, speed: float) -> Callable[[float], np.ndarray]:
    """Force behind a slack, from the force without: nothing until the head has travelled it."""
    return lambda slack: np.interp(elapsed - slack / speed, elapsed, tight, left=0.0)
