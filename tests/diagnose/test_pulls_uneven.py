"""A robot pulled lengthwise whose centre of mass lies beside its middle: one side lets go after the other."""

from __future__ import annotations

import numpy as np
import pytest
from made_pulls import made_pulls

from ssmr_ident.doctor.robots.calibrated import baseline_of
from ssmr_ident.identify.fitting.joint import evaluate

pytestmark = pytest.mark.slow

ASIDE = 0.012
"""m: 2.4 deviations of what a robot's file says."""

PULLS = (("lateral", 1.0, 6e-3), ("lateral", 0.5, 6e-3), ("longitudinal", 2.0, 30e-3), ("longitudinal", 3.0, 30e-3))


def test_pulls_sideways_tell_how_uneven_a_robot_is_that_is_pulled_lengthwise() -> None:
    setup, _ = made_pulls(PULLS, {}, 3, ASIDE)
    base = baseline_of(setup.fitted, setup.model)
    left = {t.kind: p / t.size for t, p in zip(base.trials, base.parts, strict=True)}
    even = evaluate(setup.fitted, base.model, base.point, base.nuisances)
    without = {t.kind: p / t.size for t, p in zip(even.trials, even.parts, strict=True)}
    assert base.model.split(base.point)[0]["contact_shift_y_m"] == pytest.approx(ASIDE, abs=0.003)
    assert without["longitudinal"] > 4.0
    assert max(left.values()) < 1.5


def test_a_robot_that_is_alike_left_and_right_stays_so() -> None:
    setup, _ = made_pulls(PULLS, {}, 3)
    base = baseline_of(setup.fitted, setup.model)
    left = base.parts / [t.size for t in base.trials]
    assert base.model.split(base.point)[0]["contact_shift_y_m"] == pytest.approx(0.0, abs=0.002)
    assert np.max(left) < 1.5


def test_of_a_lone_pull_only_the_fitted_part_counts_whichever_robot_it_is_of() -> None:
    (trial,) = made_pulls(PULLS[2:3], {}, 3)[0].fitted
    whole = trial.as_it_is()
    assert trial.uneven is not None
    assert trial.part is not None
    assert trial.counts is not None
    assert whole.part == trial.part
    assert np.array_equal(whole.counts, trial.counts)
    assert whole.sees("contact_shift_y_m")
    assert not trial.sees("contact_shift_y_m")
    values = {"contact_shift_y_m": ASIDE}
    own = np.array([0.0])
    assert np.array_equal(trial.run(values, {}, own), trial.run({}, {}, own))
    assert np.max(np.abs(whole.run(values, {}, own) - trial.run(values, {}, own))) > 1.0
