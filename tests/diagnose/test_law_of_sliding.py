"""Pulls of a robot off its centre are explained whichever law they slid by, and the fit that decided is handed on."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
import pytest
from pulls_off_centre import pulled

from ssmr_ident.core.parameter import Estimate, ParameterSet
from ssmr_ident.diagnose import sliding
from ssmr_ident.diagnose.baseline import best_baseline
from ssmr_ident.diagnose.setup import Setup, set_up
from ssmr_ident.diagnose.sliding import KEY, of_those_that_stand, unexplained, with_law_of_sliding
from ssmr_ident.identify.fitting.joint import JointFit, differentiate, evaluate
from ssmr_ident.identify.trials import Trial
from ssmr_ident.physics.robot import SLIDING_SPEED

pytestmark = pytest.mark.slow


@pytest.mark.parametrize("cone", [False, True])
def test_pulls_of_either_law_are_explained_by_the_fit_that_decides(cone: bool) -> None:
    campaign = pulled(cone)
    setup, _ = with_law_of_sliding(campaign, campaign.parameters)
    assert setup.begun is not None
    fit, _ = setup.begun
    assert fit.model == setup.model
    assert np.max(fit.parts / [t.size for t in fit.trials]) < 1.5
    values, _ = fit.model.split(fit.point)
    assert values["contact_shift_x_m"] == pytest.approx(-0.009, abs=0.002)


def test_pulls_that_stand_are_fitted_from_where_all_have_ended_as_well(monkeypatch: pytest.MonkeyPatch) -> None:
    """By themselves they may end in a hollow that the fit of all is out of."""
    campaign = pulled(False, noise=0.05)
    known = campaign.parameters
    decided = known.updated({KEY: Estimate(SLIDING_SPEED, None, "m/s", fixed=True)})
    laws = [(set_up(replace(campaign, parameters=p), p), p) for p in (known, decided)]
    whole = [best_baseline(setup.fitted, setup, p)[0] for setup, p in laws]

    def hollow(trials: Sequence[Trial], setup: Setup, p: ParameterSet) -> tuple[JointFit, tuple[float, ...]]:
        fit = whole[0] if setup is laws[0][0] else whole[1]
        point = fit.point.copy()
        if fit is whole[0]:
            point[[u.name for u in fit.model.physics].index("contact_shift_x_m")] -= 4.0
        begun = evaluate(trials, fit.model, point, fit.nuisances[: len(trials)])
        return differentiate(begun), ()

    monkeypatch.setattr(sliding, "best_baseline", hollow)
    monkeypatch.setattr(sliding, "crossed", list)
    last = whole[0].trials[-1].name
    assert of_those_that_stand(laws, {last}, whole) == 0
    monkeypatch.setattr(sliding, "_better_of", lambda fit, _: fit)
    assert of_those_that_stand(laws, {last}, whole) == 1


def test_a_law_counts_as_unexplained_by_turning_wheels_alone() -> None:
    campaign = pulled(False)
    setup, _ = with_law_of_sliding(campaign, campaign.parameters)
    assert setup.begun is not None
    fit, _ = setup.begun
    first, second = (trial.name for trial in fit.trials[:2])
    worse = replace(fit, residuals=(4.0 * fit.residuals[0], *fit.residuals[1:]))
    assert unexplained(worse, {first})
    assert not unexplained(worse, {second})
    assert not unexplained(fit, {first, second})
