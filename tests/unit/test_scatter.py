"""Stated standard deviations: no more is known than recordings can tell, and estimates scatter by what is said."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from scipy.signal import lfilter
from small_rigs import Run, campaign, fitted, prepared

from ssmr_ident.core.parameter import Estimate
from ssmr_ident.experiments import FORCED
from ssmr_ident.identify.fitting.coordinates import Model
from ssmr_ident.identify.fitting.curvature import Curvature
from ssmr_ident.identify.fitting.descent import descend
from ssmr_ident.identify.fitting.joint import JointFit, differentiate, evaluate
from ssmr_ident.identify.fitting.scatter import covariance, sharpened, smoothed
from ssmr_ident.identify.posterior.objective import Unknown
from ssmr_ident.identify.trials import Trial
from ssmr_ident.identify.trials.trial import Course
from ssmr_ident.signals.noise import AutoregressiveNoise

MODEL = Model((Unknown("a", "1", 0.0, 50.0, positive=False),))


def by_curvature(fit: JointFit) -> np.ndarray:
    return np.sqrt(np.diag(np.linalg.inv(Curvature.of(fit, fit.weights).normal_equations()[0])))


@pytest.mark.parametrize("effects", [{}, {"free_play": {"gap_m": 4e-5, "rounding": 0.1}}], ids=["linear", "play"])
def test_a_rig_that_is_let_go_tells_no_mass(effects: dict[str, dict[str, float]]) -> None:
    """Mass, damping and stiffness may all be larger by the same share: nothing moves otherwise."""
    made = campaign(effects, [Run(release=8e-4), Run(release=4e-4), Run(release=6e-4)], seed=2, duration=2.0)
    known = made.parameters.updated({"mass_kg": Estimate(8.0, 0.4, "kg")})
    fit = fitted(prepared(replace(made, parameters=known)), effects)
    assert fit.model.physics[0].name == "mass_kg"
    spread = np.sqrt(np.diag(covariance(fit)))
    # of the scaled coordinates: 1 is what the file leaves open; stiffness and damping share a little of what it says
    assert 0.95 < spread[0] < 1.001


def test_fine_differences_are_the_exact_slopes_of_a_decay() -> None:
    """x = X e^{-Dt/2m} cos(wt): its slope along the stiffness, by the chain rule of the closed form, to 10^-5."""
    fit = fitted(prepared(campaign({}, [Run(release=8e-4), Run(release=4e-4)], seed=2, duration=2.0)))
    trial, fine = fit.trials[0], sharpened(fit).slopes[0]
    values, _ = fit.model.split(fit.point)
    column = [u.name for u in fit.model.physics].index("stiffness_N_m")
    unknown, reach = fit.model.physics[column], 1e-3
    ends = []
    for sign in (1.0, -1.0):  # fourth order: Richardson's extrapolation of two symmetric differences
        for width in (reach, 2.0 * reach):
            point = fit.point.copy()
            point[column] += sign * width
            ends.append(trial.whitened(trial.run(*fit.model.split(point), fit.nuisances[0])))
    exact = (8.0 * (ends[0] - ends[2]) - (ends[1] - ends[3])) / (12.0 * reach)
    error = fine.shared[:, column] - exact
    assert np.linalg.norm(error) < 1e-5 * np.linalg.norm(exact)
    assert np.linalg.norm(fit.slopes[0].shared[:, column] - exact) > 1e-3 * np.linalg.norm(exact)
    assert unknown.value(float(fit.point[column])) == pytest.approx(values["stiffness_N_m"])


@pytest.mark.slow
@pytest.mark.parametrize(("phi", "frequency"), [(0.0, 0.8), (0.9, 0.8), (0.9, 20.0)])
def test_estimates_scatter_by_what_is_said_in_noise_of_any_colour(phi: float, frequency: float) -> None:
    """A wave in noise that is loudest where it is slow: 200 recordings against the stated deviation."""
    count, random = 600, np.random.default_rng(8)
    times = np.arange(count) / 100.0
    wave = np.sin(2.0 * np.pi * frequency * times)
    found, stated, curvature = [], [], []
    for _ in range(200):
        noise = lfilter([np.sqrt(1.0 - phi**2)], [1.0, -phi], random.standard_normal(count + 200))[200:]
        fit = descend(_measured(wave, 3.0 * wave + noise, times), 5)
        fit = differentiate(fit)
        found.append(50.0 * fit.point[0])
        stated.append(50.0 * float(np.sqrt(covariance(fit)[0, 0])))
        curvature.append(50.0 * float(by_curvature(fit)[0]))
    assert np.std(found) == pytest.approx(np.mean(stated), rel=0.2)  # a spectrum is known to a quarter
    assert np.mean(found) == pytest.approx(3.0, abs=4.0 * np.std(found) / np.sqrt(200))
    if phi and frequency > 10.0:
        assert np.mean(curvature) > 2.0 * np.std(found)  # one number of independent samples for all frequencies


@pytest.mark.slow
def test_what_priors_of_nuisances_leave_open_is_part_of_it() -> None:
    """A wave, and a gain of each recording that is known beforehand and does the same: the mean of four is known to
    half of what one gain is open by, however quiet the noise."""
    count, open_by, random = 400, 0.3, np.random.default_rng(5)
    times = np.arange(count) / 100.0
    wave = 20.0 * np.sin(2.0 * np.pi * 0.8 * times)
    found, stated = [], []
    for _ in range(200):
        gains = 3.0 + open_by * random.standard_normal(4)
        trials = [_trial(wave, gain * wave + random.standard_normal(count), times, open_by) for gain in gains]
        fit = differentiate(descend(evaluate(trials, MODEL, np.zeros(1), [np.zeros(1)] * 4), 5))
        found.append(50.0 * fit.point[0])
        stated.append(50.0 * float(np.sqrt(covariance(fit)[0, 0])))
    assert np.mean(stated) == pytest.approx(open_by / np.sqrt(4), rel=0.02)
    assert np.std(found) == pytest.approx(np.mean(stated), rel=0.2)  # four deviations of a deviation of 200


def _measured(wave: np.ndarray, target: np.ndarray, times: np.ndarray) -> JointFit:
    return evaluate([_trial(wave, target, times)], MODEL, np.zeros(1), [np.zeros(0)])


def _trial(wave: np.ndarray, target: np.ndarray, times: np.ndarray, open_by: float | None = None) -> Trial:
    """``open_by`` is how far a gain of its own may be off."""
    own = () if open_by is None else ("gain",)
    scales = np.array([1.0 if open_by is None else open_by])[: len(own)]

    def run(values: dict[str, float], effects: object, nuisance: np.ndarray) -> np.ndarray:
        return ((values["a"] + float(np.sum(nuisance * scales))) * wave)[:, None]

    course = Course(times, target[:, None], run, ("m",), None)
    noise = (AutoregressiveNoise(np.ones(1), 1.0),)
    return Trial(
        "one.csv", FORCED, "", ("position",), times, target[:, None], noise, np.ones((len(times), 1)), run,
        lambda values, effects: np.zeros(len(own)), own, scales, course,
    )  # fmt: skip


def test_a_smoothed_spectrum_keeps_its_power() -> None:
    power = np.abs(np.fft.fft(np.random.default_rng(3).standard_normal(301))) ** 2
    assert smoothed(power).mean() == pytest.approx(power.mean())
    assert len(smoothed(power)) == len(power)
    assert len(smoothed(power[:7])) == 7
