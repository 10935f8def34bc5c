"""What no list holds on a rig is named with its law and its sizes."""

from __future__ import annotations

import pytest
from small_rigs import Run, campaign

from ssmr_ident.workflows.diagnose import diagnose

RUNS = [Run(force=20.0), Run(force=40.0), Run(force=10.0)]
RIDER = {"rider_share": 0.08, "rider_Hz": 6.0, "rider_ratio": 0.04}
STOP = {"c_abs_s_N_m": 2500.0, "place_m": 6e-4}
PULSE = {"c_sin_s_N_m": 900.0, "c_cos_s_N_m": -500.0, "pulse_Hz": 1.3}


@pytest.mark.parametrize("law", [RIDER, PULSE, {"c_ts_N_m_s": 300.0}], ids=["mass", "pulse", "drift"])
def test_it_is_named_with_its_sizes(law: dict[str, float]) -> None:
    found = diagnose(campaign({"unlisted": law}, RUNS, seed=3, duration=6.0))
    (effect,) = found.effects
    assert effect.id == "unlisted"
    assert not effect.indistinguishable_from
    assert {name: estimate.value for name, estimate in effect.parameters.items()} == pytest.approx(law, rel=0.05)
    heldout = found.heldout
    assert heldout.after < 1.1 * heldout.noise_floor < 0.5 * heldout.before


@pytest.mark.parametrize(("side", "known"), [(1.0, 3.87e-4), (-1.0, 3.04e-4)])
def test_a_spring_that_touches_on_one_side_is_named_with_its_place(side: float, known: float) -> None:
    # each recording's zero of the force moves the place as well, and how far zeros may be off is all that tells it: a
    # place held this far from the best, all else led to its best beside it, costs one more, however long recordings are
    law = {**STOP, "place_m": side * 9e-4}
    diagnosed = diagnose(campaign({"unlisted": law}, RUNS, seed=3, duration=6.0))
    (effect,) = diagnosed.effects
    assert effect.id == "unlisted"
    assert not effect.indistinguishable_from
    found = effect.parameters["place_m"]
    assert effect.parameters["c_abs_s_N_m"].value == pytest.approx(STOP["c_abs_s_N_m"], rel=0.01)
    assert found.std is not None
    assert abs(found.value - law["place_m"]) < 3.0 * found.std
    assert found.std == pytest.approx(known, rel=0.1)
    assert diagnosed.heldout.after < 1.05 * diagnosed.heldout.noise_floor < 0.2 * diagnosed.heldout.before
