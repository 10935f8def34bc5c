"""Two effects of which neither alone predicts recordings kept back any better."""

from __future__ import annotations

import pytest
from small_rigs import Run, campaign

from ssmr_ident.diagnose import stripped
from ssmr_ident.diagnose.accept import better
from ssmr_ident.diagnose.weigh import Explanation
from ssmr_ident.workflows.diagnose import diagnose

BOTH = {"nonlinear_stiffness": {"k3_N_m3": 2e6}, "dry_friction": {"F_c_N": 3.0, "element_stiffness_N_m": 2e5}}
RUNS = [Run(force=60.0), Run(force=30.0), Run(force=90.0)]


@pytest.fixture(autouse=True)
def alone_no_better(monkeypatch: pytest.MonkeyPatch) -> None:
    def judged(leader: Explanation, before: Explanation, first: bool) -> bool:
        return len(leader.fit.model.ids) == 2 and better(leader, before, first)

    monkeypatch.setattr(stripped, "better", judged)
    monkeypatch.setattr(stripped, "shown_in_turn", lambda leader, before: False)


def test_they_are_found_together() -> None:
    found = diagnose(campaign(BOTH, RUNS, seed=5, duration=2.0))
    assert {effect.id for effect in found.effects} == set(BOTH)
    assert found.heldout.after < 1.3 * found.heldout.noise_floor


def test_one_alone_makes_no_pair() -> None:
    """What is left beside it is noise, of which no second effect takes a share."""
    found = diagnose(campaign({"nonlinear_stiffness": BOTH["nonlinear_stiffness"]}, RUNS, seed=5, duration=2.0))
    assert not found.effects
