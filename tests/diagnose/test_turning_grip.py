"""Wheels that turn lose grip sideways: with all of it they have none, and no slope there says how much they keep."""

from __future__ import annotations

import pytest
from made_pulls import made_pulls

from ssmr_ident.diagnose.baseline import fit_baseline
from ssmr_ident.diagnose.race import combined
from ssmr_ident.diagnose.scan import scan
from ssmr_ident.identify.fitting.descent import descend
from ssmr_ident.physics.effects import CATALOGUE

pytestmark = pytest.mark.slow

TRUE = {"weight": 0.4, "lambda_max": 0.15}
PULLS = (("lateral", 1.0, 6e-3),) * 4


def test_the_grip_that_turning_wheels_lose_is_begun_at_several_shares_beside_the_robot_as_known() -> None:
    setup, known = made_pulls(PULLS, {"slip_coupling": TRUE}, 6, turning=(0.0, 0.2, 0.1, 0.4))
    base = fit_baseline(setup.fitted, setup, known)
    (group,) = scan(base, [CATALOGUE["slip_coupling"]])
    assert [suspect.at["weight"] for suspect in group] == [1.0]
    physics = len(base.model.physics)
    (begun,) = [f for f in combined(base, group[0]) if not f.point[:physics].any()]
    assert begun.model.split(begun.point)[1]["slip_coupling"]["weight"] in (0.35, 0.5)
    best = descend(descend(begun, 3, plain=True), 8)
    assert all(part < 1.2 * t.size for part, t in zip(best.parts, best.trials, strict=True))
    weight = best.model.split(best.point)[1]["slip_coupling"]["weight"]
    assert weight == pytest.approx(TRUE["weight"], abs=0.05)
