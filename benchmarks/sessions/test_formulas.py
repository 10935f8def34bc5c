"""Tires that harden as a sinh, each axis in proportion to its stiffness, are found from a cubic that does not."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from bank import draw

from ssmr_ident.diagnose import polish
from ssmr_ident.diagnose.baseline import best_baseline
from ssmr_ident.diagnose.polish import loud, turned
from ssmr_ident.diagnose.setup import set_up
from ssmr_ident.diagnose.weigh import TIE
from ssmr_ident.identify.fitting.horizons import horizon_fit
from ssmr_ident.identify.fitting.joint import JointFit


@pytest.fixture(scope="module")
def sinh() -> tuple[JointFit, tuple[float, ...]]:
    """A cubic, alike on every axis, fitted where tires harden as a sinh: each axis in proportion to its stiffness."""
    drawn = draw("decays", "other", 23, size=0.6, short=True)
    assert drawn.truth.formula == "hardening as a sinh"
    setup = set_up(drawn.campaign, drawn.campaign.parameters)
    base, lengths = best_baseline(setup.fitted, setup, drawn.campaign.parameters)
    model, begin = base.model.with_effect("nonlinear_stiffness", {"k3_N_m3": 1e8}, {"k3_N_m3": 1e8})
    rest = lengths[1:] or lengths
    return horizon_fit(base.trials, model, np.concatenate([base.point, begin]), rest, 8, base.nuisances), lengths


def test_tires_that_harden_in_proportion_to_their_stiffness(sinh: tuple[JointFit, tuple[float, ...]]) -> None:
    cubic, lengths = sinh
    assert loud(cubic)
    found = turned(cubic, lengths)
    assert found.model.ids == ("nonlinear_stiffness",)
    # the one from a cubic, the other from that one
    assert {"k3_share_1_m2", "knee_share"} <= {c.parameter.name for c in found.model.free}
    assert found.cost(found.counted) < cubic.cost(found.counted) - 1000.0


def test_a_formula_that_is_no_better_is_no_other(
    sinh: tuple[JointFit, tuple[float, ...]], monkeypatch: pytest.MonkeyPatch
) -> None:
    cubic, lengths = sinh

    def ahead(by: float) -> JointFit:
        smaller = np.exp(-0.5 * by / cubic.independent)
        return replace(cubic, residuals=tuple(smaller * r for r in cubic.residuals))

    for by, better in ((1.9 * TIE, False), (2.1 * TIE, True)):
        other = ahead(by)
        assert cubic.cost(other.counted) - other.cost(other.counted) == pytest.approx(by)
        monkeypatch.setattr(polish, "horizon_fit", lambda *_, other=other: other)
        assert turned(cubic, lengths) is (other if better else cubic)
