"""What is told of a rig: in steps smaller than the search's, and with what is not known of its mass."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from small_rigs import Run, campaign

from ssmr_ident.core.parameter import Estimate
from ssmr_ident.doctor.run import diagnose
from ssmr_ident.estimate.baseline import baseline_fit
from ssmr_ident.estimate.exact import polish
from ssmr_ident.estimate.finer import PARTS, finer
from ssmr_ident.estimate.problem import problem_of
from ssmr_ident.estimate.values import Start

HARD = {"nonlinear_stiffness": {"k3_N_m3": 2e9}}


@pytest.mark.slow
def test_a_linear_rig_is_the_same_in_smaller_steps() -> None:
    made = campaign({}, [Run(force=400.0), Run(release=3e-3)], 5)
    problem = problem_of(list(made.measurements), made.parameters)
    small = finer(problem)
    assert [p.every for p in small.pieces] == [PARTS * p.every for p in problem.pieces]
    assert [p.rate for p in small.pieces] == pytest.approx([p.rate for p in problem.pieces])
    driven = next(k for k, p in enumerate(problem.pieces) if p.driven)
    np.testing.assert_allclose(small.pieces[driven].drive[::PARTS], problem.pieces[driven].drive, atol=1e-9)
    fit = baseline_fit(problem)
    again = polish(small, fit.node, Start(fit.point, fit.nuisances), 0)
    assert again.cost == pytest.approx(fit.cost, rel=1e-3)


@pytest.mark.slow
def test_a_decays_forces_are_known_no_better_than_its_mass() -> None:
    made = campaign(HARD, [Run(release=3e-3), Run(release=2e-3)], 6)
    known = made.parameters.updated({"mass_kg": Estimate(8.0, 0.4, "kg")})
    (effect,) = diagnose(replace(made, parameters=known)).effects
    k3 = effect.parameters["k3_N_m3"]
    assert effect.id == "nonlinear_stiffness"
    assert k3.value == pytest.approx(2e9, rel=0.02)
    assert 0.05 <= k3.std / k3.value < 0.06
