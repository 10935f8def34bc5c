"""One friction in three formulas: what both fit stays, and the one that acts is found from either other one."""

from __future__ import annotations

import numpy as np
import pytest
from small_rigs import Run, campaign, fitted, prepared

from ssmr_ident.core.parameter import Estimate
from ssmr_ident.diagnose.formulas import other_formulas
from ssmr_ident.diagnose.words import law
from ssmr_ident.identify.fitting.descent import descend
from ssmr_ident.identify.fitting.joint import JointFit, evaluate

pytestmark = pytest.mark.slow

TRUE = {"F_c_N": 6.0, "rounding_m_s": 0.06}


@pytest.fixture(scope="module")
def dahl() -> JointFit:
    """Dahl's law fitted where a friction without travel acts."""
    runs = [Run(force=60.0), Run(force=30.0), Run(release=4e-3)]
    base = fitted(prepared(campaign({"dry_friction": TRUE}, runs, seed=11, noise=5e-6)))
    model, begin = base.model.with_effect("dry_friction", {"F_c_N": 2.0, "element_stiffness_N_m": 2e5}, {})
    return descend(evaluate(base.trials, model, np.concatenate([base.point, begin]), base.nuisances), 12)


def test_what_both_formulas_fit_stays(dahl: JointFit) -> None:
    own = dahl.model.split(dahl.point)[1]["dry_friction"]
    slider, without = (model.split(point)[1]["dry_friction"] for model, point in other_formulas(dahl, "dry_friction"))
    assert slider == pytest.approx({**own, "slider": 1.0})
    assert without["F_c_N"] == pytest.approx(own["F_c_N"])
    assert without["rounding_m_s"] > 0.0


def test_a_rig_has_one_axis_and_no_proportion() -> None:
    runs = [Run(release=4e-3), Run(release=5e-3)]
    base = fitted(prepared(campaign({"nonlinear_stiffness": {"k3_N_m3": 3e8}}, runs, seed=13)))
    model, begin = base.model.with_effect("nonlinear_stiffness", {"k3_N_m3": 1e8}, {"k3_N_m3": 1e8})
    fit = evaluate(base.trials, model, np.concatenate([base.point, begin]), base.nuisances)
    forms = [{c.parameter.name for c in other.free} for other, _ in other_formulas(fit, "nonlinear_stiffness")]
    assert forms
    assert not any("k3_share_1_m2" in form for form in forms)


def test_the_law_that_is_told_has_the_terms_that_were_fitted() -> None:
    def told(**values: float) -> str:
        return law("nonlinear_stiffness", {name: Estimate(value) for name, value in values.items()})

    both, knee = told(k3_N_m3=-1e8, knee_share=0.2, knee_m=1e-3), told(k3_N_m3=0.0, knee_share=0.2, knee_m=1e-3)
    assert "k3 s^3" in both
    assert "knee_share" in both
    assert "k3" not in knee
    assert "knee_share" in knee
    assert "knee" not in told(k3_N_m3=-1e8, knee_share=0.0, knee_m=1e-3)
    along, all_three = told(k3_N_m3=0.0, k3_share_1_m2=1e5), told(k3_N_m3=1e7, k3_share_1_m2=1e5, knee_share=0.2)
    assert along == "F = K s + k3_share K s^3"
    assert "(k3 + k3_share K) s^3" in all_three
    assert "knee_share" in all_three
