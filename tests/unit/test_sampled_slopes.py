"""Slopes through a cloud of points: exact where a model is a plane, and past a kink that stops differences."""

from __future__ import annotations

import numpy as np
import pytest

from ssmr_ident.experiments import PULL
from ssmr_ident.identify.fitting.coordinates import Model
from ssmr_ident.identify.fitting.descent import descend
from ssmr_ident.identify.fitting.joint import JointFit, evaluate
from ssmr_ident.identify.fitting.sampled_slopes import averaged, settled
from ssmr_ident.identify.posterior.objective import Unknown
from ssmr_ident.identify.trials import Trial
from ssmr_ident.identify.trials.trial import Course, Runner
from ssmr_ident.signals.noise import AutoregressiveNoise

MODEL = Model(tuple(Unknown(name, "1", 0.0, 1.0, positive=False) for name in ("a", "b")))
TIME = np.arange(400) / 100.0
RAMP, WAVE = TIME, np.sin(9.0 * TIME)


def _begun(run: Runner, target: np.ndarray) -> JointFit:
    trial = Trial(
        "drawn.csv", PULL, "lateral", ("force",), TIME, target[:, None], (AutoregressiveNoise(np.ones(1), 0.01),),
        np.ones((len(TIME), 1)), run, lambda values, effects: np.zeros(1), ("slack",), np.ones(1),
        Course(TIME, target[:, None], run, ("N",), None),
    )  # fmt: skip
    return evaluate([trial], MODEL, np.zeros(2), [np.zeros(1)])


def test_a_plane_has_the_slopes_of_its_formula() -> None:
    def run(values, effects, nuisance):
        return ((values["a"] * RAMP + values["b"] * WAVE + nuisance[0] * TIME**2) * np.ones(1))[:, None]

    fit = _begun(run, RAMP)
    slopes = averaged(fit, 0.1, np.random.default_rng(2)).slopes[0]
    white = fit.trials[0].whitened
    for column, direction in zip(slopes.shared.T, (RAMP, WAVE), strict=True):
        assert column == pytest.approx(white(direction[:, None]), abs=1e-6 * np.abs(white(direction[:, None])).max())
    own = white((TIME**2)[:, None])
    assert slopes.own[:, 0] == pytest.approx(own, abs=1e-6 * np.abs(own).max())


def test_a_valley_along_a_kink_is_followed_to_its_end() -> None:
    """Two wheels that let go together: either one alone, up or down, makes a wave; both in proportion make none.

    Differences see the wave grow with each of them, and would let one of them fall while the other grows.
    """

    def run(values, effects, nuisance):
        both, apart = values["a"] + values["b"], abs(values["a"] - 2.0 * values["b"])
        return (both * RAMP + 20.0 * apart * WAVE)[:, None]

    fit = _begun(run, 0.6 * RAMP)
    stuck = descend(fit, 10, plain=True)
    led = settled(fit)
    assert stuck.rss > 0.9 * fit.rss
    assert led.rss < 0.05 * fit.rss
    assert led.point.sum() == pytest.approx(0.6, abs=0.1)
