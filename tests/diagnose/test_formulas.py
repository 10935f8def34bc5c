"""One friction in three formulas: what both fit stays, and the one that acts is found from either other one."""

from __future__ import annotations

import numpy as np
import pytest
from small_rigs import Run, campaign, fitted, prepared

from ssmr_ident.diagnose.formulas import other_formulas
from ssmr_ident.diagnose.polish import loud, turned
from ssmr_ident.identify.descent import descend
from ssmr_ident.identify.joint import JointFit, evaluate

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


def test_the_formula_that_acts_is_found(dahl: JointFit) -> None:
    assert loud(dahl)
    found = turned(dahl, (np.inf,))
    assert found.cost(found.counted) < dahl.cost(found.counted) - 1000.0
    assert not loud(found)
    effect = found.model.split(found.point)[1]["dry_friction"]
    assert effect["F_c_N"] == pytest.approx(TRUE["F_c_N"], rel=0.03)
    assert effect["rounding_m_s"] == pytest.approx(TRUE["rounding_m_s"], rel=0.1)
    assert turned(found, (np.inf,)) is found
