"""The score test: what points to a small effect, and that a large step of it does not."""

from __future__ import annotations

import numpy as np
import pytest
from small_rigs import Run, campaign, fitted, prepared

from ssmr_ident.diagnose.scan import scan
from ssmr_ident.identify.fitting.descent import descend
from ssmr_ident.identify.fitting.joint import JointFit, evaluate
from ssmr_ident.physics.effects import CATALOGUE

BRANCH = {"K_m_N_m": 900.0, "tau_s": 0.03}
"""Five percent of the spring, most of which a refitted stiffness and damping hide."""


@pytest.fixture(scope="module")
def left() -> JointFit:
    runs = [Run(force=20.0), Run(force=10.0), Run(release=2e-3)]
    return fitted(prepared(campaign({"viscoelastic_relaxation": BRANCH}, runs, seed=5, duration=4.0)))


def test_a_small_step_points_to_a_small_effect(left: JointFit) -> None:
    (group,) = scan(left, [CATALOGUE["viscoelastic_relaxation"]], small=True)
    exact = _gain(left)
    assert group[0].gain > 0.5 * exact > 50.0
    assert group[0].at["K_m_N_m"] == pytest.approx(BRANCH["K_m_N_m"], rel=0.7)
    (large,) = scan(left, [CATALOGUE["viscoelastic_relaxation"]])
    assert large[0].gain < 0.1 * exact


def _gain(left: JointFit) -> float:
    """Fall of n ln(RSS) when the true branch is fitted with all the rest."""
    model, begin = left.model.with_effect("viscoelastic_relaxation", BRANCH, {})
    fit = descend(evaluate(left.trials, model, np.concatenate([left.point, begin]), left.nuisances), 12)
    return left.cost(left.counted) - fit.cost(left.counted)
