"""Slopes between differences, and the time scale by which first horizons are cut."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from ssmr_ident.experiments import FREE_RESPONSE
from ssmr_ident.identify.fitting.coordinates import Model
from ssmr_ident.identify.fitting.descent import corrected
from ssmr_ident.identify.fitting.horizons import radian
from ssmr_ident.identify.fitting.joint import JointFit, differentiate, evaluate
from ssmr_ident.identify.posterior.objective import Unknown
from ssmr_ident.identify.trials import Trial
from ssmr_ident.identify.trials.trial import Course
from ssmr_ident.signals.noise import AutoregressiveNoise

MODEL = Model(tuple(Unknown(name, "1", 0.0, 1.0, positive=False) for name in ("a", "b")))
RATE, COUNT = 100.0, 400


def _trial(target: np.ndarray, run=None, noise: float = 1.0, quiet: bool = False) -> Trial:
    times = np.arange(len(target)) / RATE
    return Trial(
        "drawn.csv", FREE_RESPONSE, "roll", ("ay",), times, target[:, None],
        (AutoregressiveNoise(np.ones(1), noise),), np.ones((len(target), 1)), run, lambda values, effects: np.zeros(1),
        ("start",), np.ones(1), Course(times, target[:, None], run, ("m/s^2",), None), quiet=quiet,
    )  # fmt: skip


def _curved(point: np.ndarray, start: float) -> JointFit:
    """A decaying swing whose frequency, damping and size bend what is seen of them."""
    times = np.arange(COUNT) / RATE

    def run(values, effects, nuisance):
        omega, rate = 20.0 * np.exp(0.1 * values["a"]), 2.0 * np.exp(0.5 * values["b"])
        return ((1.0 + nuisance[0]) * np.exp(-rate * times) * np.cos(omega * times))[:, None]

    return evaluate([_trial(np.zeros(COUNT), run, 0.1)], MODEL, point, [np.array([start])])


def test_corrected_slopes_say_what_the_step_did_and_nothing_new_across_it() -> None:
    before = differentiate(_curved(np.zeros(2), 0.0))
    after = _curved(np.array([0.3, -0.2]), 0.1)
    found = corrected(before, replace(after, slopes=before.slopes))
    (old,), (new,) = before.slopes, found.slopes
    move, own = after.point - before.point, after.nuisances[0] - before.nuisances[0]
    done = before.residuals[0] - after.residuals[0]
    assert new.shared @ move + new.own @ own == pytest.approx(done, abs=1e-9 * np.abs(done).max())
    assert np.abs(old.shared @ move + old.own @ own - done).max() > 0.05 * np.abs(done).max()
    # a step across, in units of what coordinates do, is told as before
    metric = np.concatenate([np.sum(old.shared**2, axis=0), np.sum(old.own**2, axis=0)])
    along = metric * np.concatenate([move, own])
    across = np.array([along[1], -along[0], 0.0])
    change = np.hstack([new.shared - old.shared, new.own - old.own])
    assert change @ across == pytest.approx(
        np.zeros(len(change)), abs=1e-9 * np.abs(change).max() * np.abs(across).max()
    )
    assert not found.exact


def test_a_step_of_nuisances_alone_corrects_their_slopes_alone() -> None:
    before = differentiate(_curved(np.zeros(2), 0.0))
    after = _curved(np.zeros(2), 0.4)
    (old,), (new,) = before.slopes, corrected(before, replace(after, slopes=before.slopes)).slopes
    done = before.residuals[0] - after.residuals[0]
    assert new.shared == pytest.approx(old.shared, abs=0.0)
    assert new.own @ (after.nuisances[0] - before.nuisances[0]) == pytest.approx(done, abs=1e-9 * np.abs(done).max())


def test_differences_of_what_the_recordings_know_far_better_than_its_scale_are_small() -> None:
    """A step of a hundredth of the scale turns the swing by half a radian; the next slopes know that."""
    wide = replace(MODEL, physics=tuple(replace(u, prior_std=30.0) for u in MODEL.physics))
    begun = _curved(np.zeros(2), 0.0)
    first = differentiate(evaluate(begun.trials, wide, np.zeros(2), begun.nuisances))
    second = differentiate(replace(first, exact=False))
    times = np.arange(COUNT) / RATE
    turned = -0.1 * 30.0 * 20.0 * times * np.exp(-2.0 * times) * np.sin(20.0 * times) / 0.1
    off = [np.linalg.norm(fit.slopes[0].shared[:, 0] - turned) / np.linalg.norm(turned) for fit in (first, second)]
    assert off[0] > 0.1
    assert off[1] < 0.02


def test_a_point_is_split_once_and_every_point_by_itself() -> None:
    here = MODEL.split(np.array([0.3, -0.2]))
    assert MODEL.split(np.array([0.3, -0.2])) is here
    assert here == ({"a": 0.3, "b": -0.2}, {})
    assert MODEL.split(np.array([0.3, -0.1])) == ({"a": 0.3, "b": -0.1}, {})
    wider = replace(MODEL, physics=tuple(replace(u, prior_std=2.0) for u in MODEL.physics))
    assert wider.split(np.array([0.3, -0.2])) == ({"a": 0.6, "b": -0.4}, {})


@pytest.mark.parametrize("hertz", [2.0, 8.0])
def test_a_radian_of_a_swing_is_found_under_hum_and_noise(hertz: float) -> None:
    """1/omega; noise and a mains line, whose slopes are steep, would have it several times shorter."""
    times = np.arange(1200) / RATE
    random = np.random.default_rng(2)
    swing = np.cos(2.0 * np.pi * hertz * times)
    noise, line = 0.1, 0.8 * np.cos(2.0 * np.pi * 40.0 * times)
    trial = _trial(swing + line + noise * random.standard_normal(len(times)), noise=noise, quiet=True)
    basis = np.column_stack([np.ones(len(times)), np.cos(80.0 * np.pi * times), np.sin(80.0 * np.pi * times)])
    found = radian([replace(trial, basis=basis)])
    # the slope of samples: sin(omega h/2)/(omega h/2) of the true one
    half = np.pi * hertz / RATE
    assert found == pytest.approx(1.0 / (2.0 * np.pi * hertz) * half / np.sin(half), rel=0.15)
    assert radian([trial]) < 0.6 * found  # with the line
