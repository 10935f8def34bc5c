"""An effect that leaves most of the misfit, where more moves, is not the whole answer; one in another formula is."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from small_rigs import NOISE, Run, campaign, fitted, prepared, quiet

from ssmr_ident.diagnose import rivals
from ssmr_ident.diagnose.followed import explained, on_all
from ssmr_ident.diagnose.weigh import CERTAIN, TIE, all_fitted, log_evidence
from ssmr_ident.identify.fitting.joint import differentiate, evaluate
from ssmr_ident.physics.effects import CATALOGUE

pytestmark = pytest.mark.slow

RELEASES = (4e-3, 3e-3, 2e-3, 1.5e-3)
FORCE, SLOW = 3.0, 2e-3


def test_with_all_recordings_fitted_chance_in_the_parameters_tells_nothing() -> None:
    truth = {"quadratic_damping": {"d2_N_s2_m2": 30.0}}
    setup = prepared(campaign(truth, [Run(release=start) for start in RELEASES], seed=10))
    with_it = fitted(setup, truth)
    off = replace(with_it, point=with_it.point + np.array([0.01, 0.0]))
    lucky, other, without = (
        explained([quiet(trial, NOISE) for trial in setup.kept], differentiate(fit))
        for fit in (with_it, evaluate(off.trials, off.model, off.point, off.nuisances), fitted(setup))
    )
    assert log_evidence(lucky, lucky) - log_evidence(other, lucky) > TIE
    assert abs(all_fitted(on_all(lucky), on_all(other))) < 0.5
    assert all_fitted(on_all(lucky), on_all(without)) > CERTAIN
    assert rivals._tied_on_all(lucky, [without, other]) == [other]


def test_a_law_of_no_list_pays_for_those_that_it_was_chosen_from() -> None:
    setup = prepared(campaign({}, [Run(release=start) for start in RELEASES], seed=10))
    bare, off = (
        explained([quiet(trial, NOISE) for trial in setup.kept], differentiate(fitted(setup, effects)))
        for effects in ({}, {"unlisted": CATALOGUE["unlisted"].begun({})})
    )
    assert off.fit.parts == pytest.approx(bare.fit.parts)
    samples = float(bare.fit.counted.sum() + bare.kept.counted.sum())
    paid = log_evidence(bare, bare) - log_evidence(off, bare)
    assert paid == pytest.approx(0.5 * np.log(samples) + np.log(74.0), abs=0.01)
    assert all_fitted(bare.fit, off.fit) == pytest.approx(0.5 * np.log(bare.fit.counted.sum()) + np.log(74.0), abs=0.01)
