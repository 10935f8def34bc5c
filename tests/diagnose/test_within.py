"""What an answer is measured against where the baseline leaves its priors."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from small_rigs import ROUGH, Run, campaign, prepared

from ssmr_ident.core.parameter import Estimate
from ssmr_ident.diagnose.followed import explained
from ssmr_ident.diagnose.weigh import Explanation
from ssmr_ident.diagnose.within import REACH, measure_of
from ssmr_ident.identify.fitting.descent import descend
from ssmr_ident.identify.fitting.joint import differentiate, evaluate

pytestmark = pytest.mark.slow

RUNS = [Run(force=20.0), Run(force=40.0)]


def baseline(known: float, std: float) -> Explanation:
    """A rig of 20 kN/m that its file thinks softer."""
    made = campaign({}, RUNS, seed=5, duration=3.0)
    made = replace(made, parameters=ROUGH.updated({"stiffness_N_m": Estimate(known, std, "N/m")}))
    setup = prepared(made)
    point = np.zeros(len(setup.model.physics))
    values, _ = setup.model.split(point)
    begin = [trial.begin(values, {}) for trial in setup.fitted]
    fit = descend(descend(evaluate(setup.fitted, setup.model, point, begin), 8, plain=True), 8)
    return explained(setup.kept, differentiate(fit))


def stiffness(explanation: Explanation) -> float:
    values, _ = explanation.fit.model.split(explanation.fit.point)
    return values["stiffness_N_m"]


def test_it_stays_within_what_is_known() -> None:
    free = baseline(18000.0, 200.0)
    assert stiffness(free) == pytest.approx(20000.0, rel=1e-3)
    within = measure_of(free, free)
    assert stiffness(within) == pytest.approx(18000.0 * np.exp(REACH * 200.0 / 18000.0), rel=2e-3)
    assert stiffness(within) < 18000.0 * np.exp(REACH * 200.0 / 18000.0)
    assert np.all(within.kept.parts > 10.0 * free.kept.parts)


def test_a_baseline_within_its_priors_is_the_measure() -> None:
    free = baseline(19000.0, 500.0)
    assert measure_of(free, free) is free


def test_what_the_recordings_say_is_measured_against_the_free_baseline() -> None:
    free = baseline(18000.0, 200.0)
    worse = replace(
        free,
        fit=replace(free.fit, residuals=tuple(3.0 * r for r in free.fit.residuals)),
        kept=replace(free.kept, residuals=tuple(3.0 * r for r in free.kept.residuals)),
    )
    assert measure_of(free, worse) is worse
