"""Which effect all pairs have that cannot be told apart, and what is said of the others."""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any

import pytest

from ssmr_ident.diagnose import rivals
from ssmr_ident.diagnose.assemble import _apart, _open
from ssmr_ident.diagnose.rivals import shared_by_all


def _named(*ids: str) -> Any:
    fit = SimpleNamespace(model=SimpleNamespace(ids=ids))
    return SimpleNamespace(fit=fit, id="+".join(ids) or "baseline")


NONE, HARDENING, MAST = _named(), _named("nonlinear_stiffness"), _named("flexible_mast")
PAIR = _named("nonlinear_stiffness", "flexible_mast")
OTHERS = [_named("nonlinear_stiffness", name) for name in ("quadratic_damping", "sensor_bandwidth")]
TURNED = _named("wheel_lift", "nonlinear_stiffness")
OTHER = _named("motor_belt", "flexible_mast")
FOUND = {HARDENING.id: 100.0, MAST.id: 20.0, PAIR.id: 180.4, OTHER.id: 110.0}
TRIED = [OTHER, NONE, HARDENING, MAST, PAIR, *OTHERS, TURNED]


@pytest.fixture(autouse=True)
def good(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(rivals, "evidences", lambda tried: {e.id: FOUND.get(e.id, 0.0) for e in tried})
    monkeypatch.setattr(rivals, "good_enough", lambda one, before, first: one is HARDENING and before is NONE and first)
    monkeypatch.setattr(rivals, "significant", lambda fit: fit is HARDENING.fit)


def test_an_effect_that_all_pairs_have_is_named_alone() -> None:
    assert shared_by_all(PAIR, [*OTHERS, TURNED], TRIED, NONE) is HARDENING


@pytest.mark.parametrize("behind", [MAST, OTHER], ids=["a single effect", "a pair"])
def test_what_is_behind_the_effect_alone_says_nothing_against_it(behind: Any, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(FOUND, OTHER.id, 90.0)
    assert shared_by_all(PAIR, [*OTHERS, TURNED, behind], TRIED, NONE) is HARDENING


@pytest.mark.parametrize(
    "pairs",
    [OTHERS, [*OTHERS, OTHER]],
    ids=["few enough to be an answer", "a pair without it that is ahead of it"],
)
def test_nothing_is_named_alone_where_pairs_are_an_answer_or_share_nothing(pairs: list[Any]) -> None:
    assert shared_by_all(PAIR, pairs, TRIED, NONE) is None


def test_nothing_is_named_alone_that_was_not_tried_alone_or_is_no_better_than_nothing(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    pairs = [*OTHERS, TURNED]
    assert shared_by_all(PAIR, pairs, [e for e in TRIED if e is not HARDENING], NONE) is None
    for name in ("good_enough", "significant"):
        with monkeypatch.context() as patched:
            patched.setattr(rivals, name, lambda *_: False)
            assert shared_by_all(PAIR, pairs, TRIED, NONE) is None
    assert shared_by_all(HARDENING, [MAST, *OTHERS], TRIED, NONE) is None  # no pair


def test_what_may_be_beside_it_is_said_and_is_what_the_next_recording_has_to_tell() -> None:
    found = {HARDENING.id: 100.0, PAIR.id: 180.4}
    outcome: Any = SimpleNamespace(beside=(PAIR, *OTHERS, TURNED), chosen=HARDENING, rivals=(), found=found)
    (note,) = _open(outcome)
    assert "flexible mast, quadratic damping, sensor bandwidth, wheel lift" in note
    assert "80 units" in note
    outcome.found |= {e.id: 180.0 - k for k, e in enumerate((*OTHERS, TURNED))}
    first, others, evidence = _apart(outcome)
    assert first is PAIR.fit
    assert others == [e.fit for e in (*OTHERS, TURNED)]
    assert evidence == [180.4, *(180.0 - k for k in range(len(others)))]
