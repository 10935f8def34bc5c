"""Pulls whose robot swings as it slides: led past the valleys of the swing, whatever law of sliding they are in."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from ssmr_ident.diagnose.baseline import unsteady
from ssmr_ident.diagnose.sliding import crossed
from ssmr_ident.experiments import PULL
from ssmr_ident.identify.fitting.after_release import first_part, fit_past_release
from ssmr_ident.identify.fitting.coordinates import Model, Unknown
from ssmr_ident.identify.fitting.descent import chatters, descend
from ssmr_ident.identify.fitting.joint import JointFit, evaluate
from ssmr_ident.identify.trials.moments import lets_go
from ssmr_ident.identify.trials.trial import Array, Course, Trial, Values
from ssmr_ident.signals.noise import AutoregressiveNoise

pytestmark = pytest.mark.slow

TIMES = 0.05 * np.arange(400)
LETS_GO, NOISE = 6.0, 0.6
BEAT = 15.0
"""rad/s at the mass that is known."""

MODEL = Model((Unknown("mass_kg", "kg", 30.0, 0.6), Unknown("tire.mu_static", "1", 0.8, 0.04)), (), {})
TRUE = np.array([-2.0, 0.5])


def swing(values: Values, law: float) -> Array:
    """A ramp up to the friction, then a swing of a beat that the mass sets and a size of its own under each law."""
    since = np.maximum(TIMES - LETS_GO, 0.0)
    beat = BEAT * np.sqrt(30.0 / values["mass_kg"])
    level = values["tire.mu_static"] * 25.0
    ramp = level * np.minimum(TIMES / LETS_GO, 1.0)
    return (ramp + (since > 0.0) * (1.0 + law * np.sin(0.4 * since)) * np.sin(beat * since))[:, None]


def pull(law: float) -> Trial:
    """A pull under the first law, to be explained by another that ``law`` is the size of."""
    truth, _ = MODEL.split(TRUE)
    measured = swing(truth, 0.0) + NOISE * np.random.default_rng(4).standard_normal((len(TIMES), 1))

    def run(values: Values, effects: object, nuisance: Array) -> Array:
        return swing(values, law)

    return Trial(
        "pull.csv", PULL, "lateral", ("force",), TIMES, measured, (AutoregressiveNoise(np.ones(1), NOISE),),
        np.ones((len(TIMES), 1)), run, lambda values, effects: np.zeros(0), (), np.zeros(0),
        Course(TIMES, measured, run, ("N",), None), searched=True, slides_from=LETS_GO,
    )  # fmt: skip


def fitted(law: float, point: Array) -> JointFit:
    return evaluate([pull(law)], MODEL, point, [np.zeros(0)])


def test_a_fit_is_led_past_the_valleys_of_a_swing() -> None:
    begun = fitted(0.0, np.array([4.0, 0.0]))
    caught = descend(begun, 20, plain=True)
    assert caught.parts[0] > 2.0 * caught.size
    led = fit_past_release(begun)
    assert led.point == pytest.approx(TRUE, abs=0.3)
    assert led.parts[0] < 1.2 * led.size
    assert led.trials == begun.trials


def test_what_does_not_slide_is_left_alone() -> None:
    still = replace(pull(0.0), slides_from=None)
    fit = evaluate([still], MODEL, np.zeros(2), [np.zeros(0)])
    assert fit_past_release(fit) is fit
    assert first_part(still, 0.1) is still


def test_the_first_part_of_a_slide_is_what_counts() -> None:
    part = first_part(pull(0.0), 0.25)
    assert part.counts is not None
    assert TIMES[part.counts[:, 0]][-1] == pytest.approx(LETS_GO + 0.25 * (TIMES[-1] - LETS_GO), abs=0.05)


def test_a_pull_is_unsteady_long_before_much_is_left_of_it() -> None:
    near = fitted(0.0, TRUE)
    assert not unsteady(near)
    aside = fitted(0.0, TRUE + np.array([0.7, 0.0]))
    assert 1.3 < aside.parts[0] / aside.size < 2.0
    assert unsteady(aside)
    assert not chatters(aside)


def test_a_law_in_a_hollow_is_begun_where_the_other_one_ended() -> None:
    # from here no leading finds the true law's valley; the other law, nearly as good, stands in it
    hollow, other = fitted(0.0, np.array([30.0, 0.5])), fitted(0.5, TRUE)
    right, wrong = crossed([hollow, other])
    assert wrong is other
    assert right.point == pytest.approx(TRUE, abs=0.3)
    assert right.rss < wrong.rss


def test_a_robot_lets_go_where_its_force_comes_to_the_top() -> None:
    force = 40.0 * np.minimum(np.arange(200) / 120.0, 1.0)[:, None]
    assert 110 <= lets_go(force) <= 120
