"""What no list holds on a rig is named with its law and its sizes."""

from __future__ import annotations

import pytest
from small_rigs import Run, campaign

from ssmr_ident.workflows.diagnose import diagnose

RUNS = [Run(force=20.0), Run(force=40.0), Run(force=10.0)]
RIDER = {"rider_share": 0.08, "rider_Hz": 6.0, "rider_ratio": 0.04}
STOP = {"c_abs_s_N_m": 2500.0, "place_m": 6e-4}


@pytest.mark.parametrize(("law", "kind"), [(RIDER, "extra_motion"), ({"c_ts_N_m_s": 300.0}, "changing")])
def test_its_kind_is_named_and_it_explains_what_was_kept_back(law: dict[str, float], kind: str) -> None:
    found = diagnose(campaign({"unlisted": law}, RUNS, seed=3, duration=6.0))
    (effect,) = found.effects
    assert (effect.id, effect.kind) == ("unlisted", kind)
    assert not effect.indistinguishable_from
    heldout = found.heldout
    assert heldout.after < 1.1 * heldout.noise_floor < 0.5 * heldout.before


@pytest.mark.parametrize("side", [1.0, -1.0])
def test_a_spring_that_touches_on_one_side_is_named_with_its_place(side: float) -> None:
    # each recording's zero of the force moves the place as well, and how far zeros may be off is all that tells it
    law = {**STOP, "place_m": side * 9e-4}
    diagnosed = diagnose(campaign({"unlisted": law}, RUNS, seed=3, duration=6.0))
    (effect,) = diagnosed.effects
    assert effect.id == "unlisted"
    assert not effect.indistinguishable_from
    found = effect.parameters["place_m"]
    assert effect.parameters["c_abs_s_N_m"].value == pytest.approx(STOP["c_abs_s_N_m"], rel=0.01)
    assert found.std is not None
    assert abs(found.value - law["place_m"]) < 3.0 * found.std
    assert found.std > 5e-5
    assert diagnosed.heldout.after < 1.05 * diagnosed.heldout.noise_floor < 0.2 * diagnosed.heldout.before
