"""A belt is begun in the place of the tires that a baseline has softened to do without it."""

from __future__ import annotations

import pytest
from bank import FAMILIES, mixed

from ssmr_ident.diagnose import explore
from ssmr_ident.diagnose.baseline import bent, best_baseline
from ssmr_ident.diagnose.setup import set_up
from ssmr_ident.physics.effects import CATALOGUE

SEED = 6262


def test_a_belt_is_found_whose_give_a_baseline_had_put_into_the_tires(monkeypatch: pytest.MonkeyPatch) -> None:
    drawn = mixed(SEED, tuple(FAMILIES))
    known = drawn.campaign.parameters
    setup = set_up(drawn.campaign, known)
    base, lengths = best_baseline(setup.fitted, setup, known)
    softer = next(k for k, u in enumerate(base.model.physics) if u.name == "tire.stiffness_x_N_m")
    assert bent(base)
    assert base.point[softer] < -4.0
    monkeypatch.setattr(explore, "candidates", lambda fit, baseline: (CATALOGUE["motor_belt"],))
    (found,) = explore.search(base, "rigid6", lengths).tried
    belt = found.model.split(found.point)[1]["motor_belt"]
    assert belt["K_b_N_m"] == pytest.approx(drawn.truth.effects["motor_belt"]["K_b_N_m"], rel=0.1)
    assert abs(found.point[softer]) < 2.0
    assert found.cost(found.counted) < base.cost(found.counted) - 100.0
