"""The experiment that is proposed does tell the explanations apart when it is made."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace

import numpy as np
import pytest
from small_rigs import NOISE, Run, campaign, fitted, prepared, quiet

from ssmr_ident.diagnose import discriminate
from ssmr_ident.diagnose.discriminate import _apart, next_experiment
from ssmr_ident.diagnose.experiments import experiments
from ssmr_ident.diagnose.setup import Setup
from ssmr_ident.identify.fitting.descent import descend
from ssmr_ident.identify.fitting.joint import JointFit, differentiate, evaluate
from ssmr_ident.physics.slots import Effects

HARDENING = {"nonlinear_stiffness": {"k3_N_m3": 6e7}}


@pytest.fixture(scope="module")
def alike() -> tuple[Setup, JointFit, JointFit]:
    """A release too small to tell a little hardening from none."""
    setup = prepared(campaign(HARDENING, [Run(0.002)], seed=5))
    return setup, fitted(setup, HARDENING), fitted(setup)


def test_the_proposal_names_what_to_do_and_how_likely_it_decides(alike: tuple[Setup, JointFit, JointFit]) -> None:
    setup, best, rival = alike
    text = next_experiment(setup, best, [rival])
    assert "elease the mass " in text
    assert "between nonlinear stiffness and no further physics" in text
    assert "probability of" in text
    assert next_experiment(setup, best, []) == ""


def test_where_a_rival_cannot_be_simulated_nothing_is_proposed(
    alike: tuple[Setup, JointFit, JointFit], monkeypatch: pytest.MonkeyPatch
) -> None:
    setup, best, rival = alike
    failing = replace(rival)
    monkeypatch.setattr(discriminate, "_differ", lambda one, best, other: np.nan if other is failing else 5.0)
    assert next_experiment(setup, best, [rival]) != ""
    assert next_experiment(setup, best, [rival, failing]) == ""


def test_a_simulation_that_has_burst_tells_nothing(alike: tuple[Setup, JointFit, JointFit]) -> None:
    setup, best, rival = alike
    one = experiments(setup, best)[0]
    grown = np.geomspace(1.0, 1e200, len(one.trial.target))[:, None]

    def bursting(values: Mapping[str, float], effects: Effects, own: np.ndarray) -> np.ndarray:
        return (1.0 + len(effects)) * grown

    assert np.isfinite(discriminate._differ(one, best, rival))
    assert np.isnan(discriminate._differ(replace(one, trial=replace(one.trial, run=bursting)), best, rival))


@pytest.mark.slow
def test_distances_grow_with_the_amplitude_and_say_what_a_recording_gives(
    alike: tuple[Setup, JointFit, JointFit],
) -> None:
    setup, best, rival = alike
    chosen = [one for one in experiments(setup, best) if one.change in (1.0, 2.0, 4.0)]
    distances = _apart(chosen, best, rival)
    assert distances[0] > distances[1] > distances[2]
    # the experiment made: both models fitted to old and new together differ by the square of the distance
    rng = np.random.default_rng(6)
    one, distance = chosen[0], distances[0]
    values, effects = best.model.split(best.point)
    clean = one.trial.run(values, effects, one.growth * best.nuisances[0])
    gains = []
    for _ in range(6):
        made = quiet(replace(one.trial, target=clean + NOISE * rng.standard_normal(clean.shape)))
        trials = [best.trials[0], made]
        scores = []
        for fit in (best, rival):
            start = evaluate(trials, fit.model, fit.point, [fit.nuisances[0], one.growth * fit.nuisances[0]])
            end = descend(start, 8)
            scores.append(end.rss + end.penalty)
        gains.append(scores[1] - scores[0])
    before = rival.rss + rival.penalty - best.rss - best.penalty
    gained = np.array(gains) - before
    # the likelihood ratio is normal about d² with variance 4 d²
    assert np.mean(gained) == pytest.approx(distance**2, abs=4.0 * distance)


def test_a_shaken_rig_is_shaken_otherwise() -> None:
    setup = prepared(campaign({"nonlinear_stiffness": {"k3_N_m3": 1e6}}, [Run(force=20.0)], seed=8))
    fit = fitted(setup)
    made = experiments(setup, fit)
    assert len(made) == 4
    sizes = [float(np.std(one.trial.run(*fit.model.split(fit.point), fit.nuisances[0]))) for one in made]
    assert sizes[1:] == pytest.approx([0.5 * sizes[0], 0.25 * sizes[0], 0.125 * sizes[0]], rel=0.02)
    rival = differentiate(evaluate(fit.trials, fit.model, fit.point + 0.01, fit.nuisances))
    assert "hake as in run-0.csv" in next_experiment(setup, fit, [rival])
