"""Marks, intervals and the power curve on answers whose worth is known."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from ssmr_proof.scores.answer import Answer, Claim
from ssmr_proof.scores.heldout import HeldOut
from ssmr_proof.scores.intervals import mean_interval, median_interval, share_interval
from ssmr_proof.scores.power import power
from ssmr_proof.scores.score import CLEAN, FALSE_ALARM, MISSED, PARTLY, RIGHT, SURPLUS, TIE, WRONG, marked
from ssmr_proof.scores.summary import summarised
from ssmr_proof.scores.table import Row


def truth(*ids: str, also: tuple[str, ...] = ()) -> dict[str, Any]:
    effects = [
        {"id": name, "strength": 0.5, "parameters": {"F_c_N": {"value": 2.0, "unit": "N"}},
         **({"accepted": [name, *also]} if also else {})}
        for name in ids
    ]  # fmt: skip
    return {"case": "session-001", "family": "rig", "kind": "one", "trap": "", "effects": effects}


def answer(*claims: tuple[str, ...]) -> Answer:
    named = tuple(Claim(c[0], c[1:], {"F_c_N": (2.2, 0.1)}) for c in claims)
    return Answer("missing_physics" if named else "nothing_missing", named)


@pytest.mark.parametrize(
    ("hidden", "claims", "outcome"),
    [
        (("dry_friction",), (("dry_friction",),), RIGHT),
        (("dry_friction",), (("hysteresis", "dry_friction"),), TIE),
        (("dry_friction",), (("hysteresis", "free_play", "dry_friction"),), TIE),
        (("dry_friction",), (("hysteresis", "free_play", "unlisted", "dry_friction"),), WRONG),
        (("dry_friction",), (("dry_friction", "a", "b", "c", "d"),), RIGHT),
        (("dry_friction",), (("hysteresis",),), WRONG),
        (("dry_friction",), (("dry_friction",), ("hysteresis",)), SURPLUS),
        (("dry_friction",), (), MISSED),
        (("a", "b"), (("b",), ("a",)), RIGHT),
        (("a", "b"), (("b", "a"),), PARTLY),
        (("a", "b"), (("c", "a"), ("a", "b")), TIE),
        (("a", "b"), (("c",), ("d",)), WRONG),
        ((), (), CLEAN),
        ((), (("dry_friction",),), FALSE_ALARM),
    ],
)
def test_marks(hidden: tuple[str, ...], claims: tuple[tuple[str, ...], ...], outcome: str) -> None:
    assert marked(truth(*hidden), answer(*claims)).outcome == outcome


def test_the_same_physics_under_its_other_name_is_right() -> None:
    told = truth("unlisted", also=("nonlinear_stiffness",))
    assert marked(told, answer(("nonlinear_stiffness",))).outcome == RIGHT


def test_undetermined_is_an_alarm_and_no_answer_is_no_answer() -> None:
    assert marked(truth(), Answer("undetermined", ())).outcome == FALSE_ALARM
    assert marked(truth("a"), Answer("undetermined", ())).outcome == WRONG
    assert marked(truth(), Answer("failed", ())).outcome == "failed"


def test_parameters_are_compared_where_both_have_them() -> None:
    errors = marked(truth("dry_friction"), answer(("dry_friction",))).parameter_errors
    assert errors == {"dry_friction.F_c_N": (pytest.approx(0.1), pytest.approx(2.0))}


def test_intervals_cover() -> None:
    """Each interval holds the truth in 95 % of 600 draws or a little more; 92 % is three standard errors below."""
    random = np.random.default_rng(8)
    shares = [share_interval(int(random.binomial(40, 0.15)), 40) for _ in range(600)]
    assert np.mean([low <= 0.15 <= high for low, high in shares]) > 0.92
    means = [mean_interval(list(random.normal(1.0, 2.0, 4))) for _ in range(600)]
    assert abs(np.mean([low <= 1.0 <= high for low, high in means]) - 0.95) < 0.03
    medians = [median_interval(list(random.exponential(1.0, 25))) for _ in range(600)]
    assert np.mean([low <= np.log(2.0) <= high for low, high in medians]) > 0.92


def test_counts_and_power() -> None:
    """Cases whose physics shows are named, those whose physics does not are missed: half are named in between."""
    rows = []
    for index, excess in enumerate(np.geomspace(0.05, 5.0, 40)):
        before = float(np.sqrt(1.0 + excess**2))
        said = answer(("dry_friction",)) if excess > 0.5 + 0.2 * (-1) ** index else answer()
        told = truth("dry_friction")
        rows.append(Row(told, said, marked(told, said), HeldOut((before,), (1.0,), (1.0,)), 1.0))
    faint = {**truth("dry_friction"), "kind": "faint"}
    rows += [Row(faint, answer(), marked(faint, answer()), HeldOut((1.0,), (1.0,), (1.0,)), 1.0)] * 3
    rows += [Row(truth(), answer(), marked(truth(), answer()), HeldOut((1.0,), (1.0,), (1.0,)), 1.0)] * 9
    summary = summarised(rows)
    assert (summary.false_alarms.hits, summary.false_alarms.total) == (0, 9)
    assert summary.reduced.value == 1.0
    assert (summary.named.hits, summary.named.total) == (summary.outcomes[RIGHT], 40)
    assert summary.right.total == 49
    assert (summary.faint.hits, summary.faint.total, summary.faint_reduced.hits) == (0, 3, 0)
    assert "below the limit, named:     0 of 3" in str(summary)
    assert summary.after_over_floor[0] == pytest.approx(1.0)
    found = power(rows)
    assert len(found.excess) == 43
    assert 0.3 < found.half < 0.7
    assert found.rows()[-1][1] == found.rows()[-1][3] > 0
