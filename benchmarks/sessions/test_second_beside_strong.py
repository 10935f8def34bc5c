"""A second effect beside a first one that explains nearly all of a large error."""

from __future__ import annotations

import pytest
from small_rigs import Run, campaign

from ssmr_ident.diagnose import engine
from ssmr_ident.diagnose.accept import FORMULA, left_over
from ssmr_ident.workflows.diagnose import diagnose

BOTH = {"nonlinear_stiffness": {"k3_N_m3": 1e8}, "quadratic_damping": {"d2_N_s2_m2": 20.0}}
RUNS = [Run(force=60.0), Run(force=90.0)]


@pytest.mark.parametrize("halved", [True, False])
def test_it_is_named_where_it_leaves_far_less(halved: bool, monkeypatch: pytest.MonkeyPatch) -> None:
    left: list[float] = []
    monkeypatch.setattr(engine, "left_over", lambda *both: left.append(left_over(*both)) or left[-1])
    if not halved:
        monkeypatch.setattr(engine, "halves", lambda *_: False)
    found = diagnose(campaign(BOTH, RUNS, seed=5, duration=1.5))
    assert left[0] < FORMULA
    assert {effect.id for effect in found.effects} == (set(BOTH) if halved else {"nonlinear_stiffness"})


def test_none_is_looked_for_beside_what_leaves_noise(monkeypatch: pytest.MonkeyPatch) -> None:
    searched: list[bool] = []
    search = engine.search
    monkeypatch.setattr(engine, "search", lambda *a: searched.append(a[3]) or search(*a))
    found = diagnose(campaign({"nonlinear_stiffness": BOTH["nonlinear_stiffness"]}, RUNS, seed=5, duration=1.5))
    assert [effect.id for effect in found.effects] == ["nonlinear_stiffness"]
    assert searched == [False]
