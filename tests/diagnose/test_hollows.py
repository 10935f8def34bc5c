"""Pulls are begun again from robots drawn out of what is known: a descent ends in the hollow where it began."""

from __future__ import annotations

from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest
from made_pulls import made_pulls

from ssmr_ident.diagnose import hollows, stripped
from ssmr_ident.diagnose.hollows import ENOUGH, SHAKES, challenged, from_afar
from ssmr_ident.diagnose.setup import Setup
from ssmr_ident.diagnose.start import begin
from ssmr_ident.diagnose.weigh import Explanation
from ssmr_ident.identify.fitting.descent import descend
from ssmr_ident.identify.fitting.joint import JointFit, evaluate

pytestmark = pytest.mark.slow

PULLS = (("lateral", 1.0, 6e-3), ("lateral", 0.5, 6e-3))


@pytest.fixture(scope="module")
def stuck() -> tuple[Setup, JointFit]:
    """A descent from a robot whose centre of mass lies three deviations off to a corner."""
    setup, known = made_pulls(PULLS, {}, 9)
    fit = begin(setup.fitted, setup, known)
    names = [unknown.name for unknown in fit.model.physics]
    point = fit.point.copy()
    point[[names.index("contact_shift_x_m"), names.index("contact_shift_y_m")]] = 3.0, -3.0
    return setup, descend(evaluate(fit.trials, fit.model, point, fit.nuisances), 2, plain=True)


def test_a_draw_ends_lower_than_the_hollow_and_is_the_same_twice(stuck: tuple[Setup, JointFit]) -> None:
    _, fit = stuck
    first, again = from_afar(fit), from_afar(fit)
    assert len(first) == 1
    assert first[0].cost(fit.counted) < fit.cost(fit.counted)
    np.testing.assert_array_equal(first[0].point, again[0].point)


def test_recordings_that_take_their_time_each_are_left_as_they_are(stuck: tuple[Setup, JointFit]) -> None:
    _, fit = stuck
    alone = replace(fit, trials=tuple(replace(trial, abreast=False) for trial in fit.trials))
    assert from_afar(alone) == []


def test_a_baseline_in_a_hollow_is_shaken_until_it_beats_an_effect(stuck: tuple[Setup, JointFit]) -> None:
    _, fit = stuck
    goal = fit.cost(fit.counted) - 2.0
    deeper = challenged(_at(fit, goal), fit.counted, (fit,), lambda f: f.cost(fit.counted) < goal)
    assert deeper.cost(fit.counted) < goal


@pytest.mark.parametrize(("ahead", "times"), [(100.0, ENOUGH), (-1.0, len(SHAKES))])
def test_a_baseline_is_given_up_that_never_gets_to_an_effect(
    stuck: tuple[Setup, JointFit], monkeypatch: pytest.MonkeyPatch, ahead: float, times: int
) -> None:
    _, fit = stuck
    asked: list[float] = []

    def around(_fit: JointFit, _centre: np.ndarray, width: float, *_: object) -> list[JointFit]:
        asked.append(width)
        return []

    monkeypatch.setattr(hollows, "_around", around)
    goal = fit.cost(fit.counted) - ahead
    assert challenged(_at(fit, goal), fit.counted, (fit,), lambda _: False) is fit
    assert asked == list(SHAKES[:times])


def test_an_effect_that_is_beaten_already_costs_nothing(
    stuck: tuple[Setup, JointFit], monkeypatch: pytest.MonkeyPatch
) -> None:
    _, fit = stuck
    monkeypatch.delattr(hollows, "_around")
    assert challenged(fit, fit.counted, (fit,), lambda _: True) is fit


def _at(fit: JointFit, cost: float) -> JointFit:
    """A fit of that cost."""
    change = (cost - fit.cost(fit.counted)) / (2.0 * fit.counted.sum())
    return replace(fit, residuals=tuple(np.exp(change) * r for r in fit.residuals))


@pytest.mark.parametrize(("explained", "outdone"), [(1.0, False), (3000.0, True)])
def test_what_a_baseline_misses_altogether_counts_as_it_does_beside_the_effect(explained: float, outdone: bool) -> None:
    """A drag that is left at 3,300 times the noise has few independent samples, and beside its cable all of them."""

    def fit(parts: list[float], counted: list[float], penalty: float) -> JointFit:
        size = 200
        trials = [SimpleNamespace(size=size, searched=True) for _ in parts]
        found = SimpleNamespace(trials=trials, parts=size * np.array(parts), counted=np.array(counted))
        found.cost = lambda c: float(c @ np.log(parts)) + penalty
        return found  # type: ignore[return-value]

    before = Explanation(*[fit([1100.0, 9.0, 2.5, 1.1, 3300.0], [13.0, 7.0, 158.0, 155.0, 5.0], 9.0)] * 2)
    beside = Explanation(*[fit([730.0, 11.0, 2.5, 1.1, explained], [18.0, 18.0, 158.0, 155.0, 168.0], 83.0)] * 2)
    assert stripped.outdone(beside, before) is outdone
