"""What a decay's trial takes for the sensor's, and not for motion."""

from __future__ import annotations

import numpy as np
import pytest

from ssmr_ident.core.parameter import Estimate
from ssmr_ident.core.recording import Channel, Provenance, Recording
from ssmr_ident.experiments.campaign import Measurement
from ssmr_ident.experiments.free_response import free_response
from ssmr_ident.identify.body.builder import RobotBuilder
from ssmr_ident.identify.trials.decay import decay_trial
from ssmr_ident.identify.trials.trial import Trial
from ssmr_ident.physics.robot import robot_from_parameters
from ssmr_ident.session import Entry, read_parameters
from ssmr_ident.simulate import simulate


@pytest.fixture(scope="module")
def trial() -> Trial:
    """A pitch decay with hum that folds, its lines taken from a residual that has them."""
    robot = robot_from_parameters(read_parameters("p3at-extended"))
    made = simulate(robot, free_response("pitch", duration=3.0), 500.0)
    noise = 0.01 * np.random.default_rng(2).standard_normal(len(made.time))
    hum = sum(0.3 / k * np.sin(2.0 * np.pi * 60.01 * k * made.time + k) for k in (1, 3))
    recording = Recording(made.time, (Channel("ax", made["ax"] + noise + hum, "m/s^2"),), Provenance("p.csv", "", "x"))
    found = decay_trial(Measurement(Entry("p.csv", "free_response", motion="pitch"), recording), RobotBuilder(robot))
    clean = found.run({}, {}, found.begin({}, {}))
    return found.with_lines(found.target - clean)


@pytest.mark.compiles
@pytest.mark.parametrize(("hz", "counts"), [(60.01, False), (180.03, False), (4.0, True), (45.0, True)])
def test_harmonics_of_the_mains_do_not_count(trial: Trial, hz: float, counts: bool) -> None:
    wave = np.sin(2.0 * np.pi * hz * (trial.times - trial.times[0]) + 1.0)[:, None]
    assert _left(trial, wave) == pytest.approx(float(counts), abs=0.1)


@pytest.mark.parametrize(("order", "counts"), [(0, False), (1, False), (2, False), (5, True)])
def test_a_slow_drift_does_not_count(trial: Trial, order: int, counts: bool) -> None:
    assert (_left(trial, ((trial.times - trial.times[0]) ** order)[:, None]) > 0.1) is counts


def test_a_gain_of_the_file_and_a_fitted_one_are_the_same() -> None:
    """Both begin where the recording began, and show what was logged."""
    known = read_parameters("p3at-extended")
    told = robot_from_parameters(known.updated({"accelerometer.gain.x": Estimate(1.2, None, "1")}))
    made = simulate(told, free_response("pitch", duration=1.0), 500.0)
    noise = 1e-4 * np.random.default_rng(4).standard_normal((2, len(made.time)))
    channels = tuple(Channel(axis, made[axis] + n, "m/s^2") for axis, n in zip(("ax", "az"), noise, strict=True))
    measured = Measurement(
        Entry("p.csv", "free_response", motion="pitch"), Recording(made.time, channels, Provenance("p.csv", "", "x"))
    )
    found = []
    for robot, values in ((told, {}), (robot_from_parameters(known), {"accelerometer.gain.x": 1.2})):
        own = decay_trial(measured, RobotBuilder(robot))
        found.append((own.begin(values, {}), own.run(values, {}, own.begin(values, {}))))
    np.testing.assert_allclose(found[0][0], found[1][0], rtol=1e-6, atol=1e-9)
    np.testing.assert_allclose(found[0][1], found[1][1], rtol=1e-9, atol=1e-12)


def _left(trial: Trial, column: np.ndarray) -> float:
    """Share of a column's size that counts."""
    return float(np.linalg.norm(trial.whitened(column)) * trial.noises[0].std / np.linalg.norm(column))
