"""The frozen benchmark of the doctor: what it asks, that nothing stops it, and how it tells engines apart."""

from __future__ import annotations

import inspect

import pytest
from doctor import session_process
from doctor.engines import ENGINES, engine_named
from doctor.frozen import FAMILIES, Case
from doctor.judged import OUTCOMES
from doctor.session_process import answered
from doctor.side_by_side import differences
from doctor.sources import cases, opened
from doctor.tables import HEAD, line, over_floor, table

NULL = Case("rig-nulls", "bank/rig_decay/none/710000")


def row(key: str, outcome: str, after: float = 1.1, **more: object) -> dict[str, object]:
    said = {"right": [["free_play"]], "named": ["free_play"], "ties": [[]], "confidence": [0.95], "seconds": 2.0}
    return {"key": key, "family": "rigs", "outcome": outcome, "after": after, "floor": 1.0, "errors": {},
            "verdict": "missing_physics", **said, **more}  # fmt: skip


def test_a_larger_set_holds_the_smaller_and_other_sessions_are_others() -> None:
    small, large = (set(cases(FAMILIES, count)) for count in (4, 50))
    assert small < large
    assert {case.family for case in large} >= set(FAMILIES) - {"open"}
    assert not large & set(cases(FAMILIES, 50, start=50))


def test_every_engine_of_the_table_takes_a_campaign_and_a_seed() -> None:
    for name in ENGINES:
        assert {"campaign", "seed"} <= set(inspect.signature(engine_named(name)).parameters)


@pytest.mark.slow
def test_what_is_drawn_for_nulls_has_nothing_missing_and_for_the_others_something() -> None:
    assert opened(NULL).right == ((),)
    drawn = [case for case in cases(("rigs",), 1) if case.key.startswith("bank/")]
    assert drawn
    assert all(opened(case).right != ((),) for case in drawn)


@pytest.mark.parametrize(
    ("engine", "limit", "word"),
    [("breaks", 30.0, "no answer to bank-710000"), ("dies", 30.0, "ended with 7"), ("computes_for_ever", 1.0, "limit"),
     ("sleeps", 0.5, "no answer within")],
)  # fmt: skip
def test_a_session_that_breaks_hangs_or_dies_is_a_failure_and_no_more(
    engine: str, limit: float, word: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(session_process, "PATIENCE", 40.0 if engine == "computes_for_ever" else 1.0)
    found = answered(NULL, f"pretended_engines:{engine}", limit)
    assert (found["key"], found["outcome"]) == (NULL.key, "failed")
    assert word in found["error"]


def test_a_line_counts_what_the_rows_say() -> None:
    errors = {"free_play.gap_m": 2.0, "mass_kg": 9.0}
    rows = [row("a", "right", errors=errors), row("b", "wrong", after=3.1), row("c", "failed", after=float("nan"))]
    cells = [cell.strip() for cell in line("rigs", rows).strip("|").split("|")]
    found = dict(zip((cell.strip() for cell in HEAD.strip("|").split("|")), cells, strict=True))
    assert {found[name] for name in ("right", "wrong", "failed")} == {"1"}
    assert {found[name] for name in OUTCOMES if name not in ("right", "wrong", "failed")} == {"·"}
    assert (found["after/floor"], found["in 3 std"], found["sure, and right"]) == ("2.10", "1 of 1", "1 of 3")
    assert over_floor(rows[:2]) == pytest.approx([1.1, 3.1])
    assert table(rows).splitlines()[2] == line("rigs", rows)


def test_engines_differ_by_more_than_chance_where_the_sign_of_the_difference_is_no_coin() -> None:
    wrong = [row(str(n), "wrong", after=2.0) for n in range(8)]
    right = [row(str(n), "right", after=1.0) for n in range(8)]
    text = differences(wrong, right)
    assert "only by the first 0, only by the second 8: p = 0.0078, more than chance" in text
    assert "larger in 0, smaller in 8: p = 0.0078, more than chance" in text
    assert "answered unlike: 8" in text
    assert "no difference" in differences(right, right)
