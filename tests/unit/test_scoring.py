"""The judge of diagnoses judges as its page says."""

from __future__ import annotations

from dataclasses import replace

import pytest
from made_diagnoses import hardening
from scoring import errors, is_unseen, outcome, row_of, share, summary

from ssmr_ident.core.parameter import Estimate
from ssmr_ident.diagnose.diagnosis import Diagnosis, NamedEffect


def said(verdict: str, *effects: tuple[str, ...]) -> Diagnosis:
    """Names, each followed by its tie."""
    named = tuple(NamedEffect(name, "", "", {}, 0.9, tuple(tie)) for name, *tie in effects)
    return replace(hardening(), verdict=verdict, effects=named)


MISSING, NOTHING, DOUBT = "missing_physics", "nothing_missing", "undetermined"


@pytest.mark.parametrize(
    ("truth", "diagnosis", "expected"),
    [
        ((), said(NOTHING), "right"),
        ((), said(MISSING, ("stribeck",)), "false alarm"),
        ((), said(DOUBT, ("stribeck", "hysteresis")), "undetermined"),
        (("free_play",), said(MISSING, ("free_play",)), "right"),
        (("free_play",), said(MISSING, ("free_play", "hysteresis")), "right"),
        (("free_play",), said(MISSING, ("hysteresis", "free_play")), "tie"),
        (("free_play",), said(DOUBT, ("hysteresis", "free_play")), "tie"),
        (("free_play",), said(DOUBT, ("hysteresis", "stribeck", "unlisted", "free_play")), "undetermined"),
        (("free_play",), said(DOUBT, ("free_play", "hysteresis", "stribeck", "unlisted")), "undetermined"),
        (("free_play",), said(MISSING, ("hysteresis", "stribeck", "unlisted", "free_play")), "wrong"),
        (("free_play",), said(MISSING, ("free_play",), ("stribeck",)), "wrong"),
        (("free_play",), said(NOTHING), "missed"),
        (("a", "b"), said(MISSING, ("b",), ("a",)), "right"),
        (("a", "b"), said(MISSING, ("c", "a"), ("b",)), "tie"),
        (("a", "b"), said(MISSING, ("a",)), "part"),
        (("a", "b"), said(MISSING, ("a",), ("c",)), "wrong"),
    ],
)
def test_outcomes(truth: tuple[str, ...], diagnosis: Diagnosis, expected: str) -> None:
    assert outcome(truth, diagnosis) == expected


def test_errors_are_in_the_diagnosis_own_standard_deviations() -> None:
    diagnosis = hardening()
    after = diagnosis.after.updated({"mass_kg": Estimate(20.0, 0.5, "kg")})
    found = errors(
        replace(diagnosis, after=after), {"nonlinear_stiffness": {"k3_N_m3": 2.894e8}}, {"mass_kg": 21.0, "absent": 1.0}
    )
    assert found == {"nonlinear_stiffness.k3_N_m3": pytest.approx(1.0), "mass_kg": pytest.approx(-2.0)}


def test_a_session_that_breaks_the_engine_is_a_result() -> None:
    row, found = row_of("x", ("free_play",), lambda: 1 / 0, {}, family="forced")  # type: ignore[arg-type,return-value]
    assert found is None
    assert row["outcome"] == "failed"
    assert "ZeroDivisionError" in row["error"]


def test_the_summary_counts() -> None:
    floors = {"roll-3.xlsx": 3.0, "pitch-3.xlsx": 3.0}
    right, _ = row_of("a", ("nonlinear_stiffness",), hardening, floors, family="decays", seed=1)
    missed, _ = row_of("b", ("stribeck",), lambda: said(NOTHING), floors, family="decays", seed=2)
    small = {**missed, "name": "c", "before": 3.03}
    assert right["floor"] == 3.0
    assert not is_unseen(missed)
    assert is_unseen(small)
    assert is_unseen({**missed, "true_evidence": {"stribeck": 3.0}})
    assert not is_unseen({**missed, "true_evidence": {"stribeck": 300.0}})
    text = summary([right, missed, small])
    assert "something missing: right or tie  1/3" in text
    assert "without what nobody could see  1/2" in text
    assert share(0, 1000).endswith("(0.0 … 0.4)")


def test_of_two_the_one_that_was_not_named_must_show() -> None:
    part = {"outcome": "part", "truth": ["free_play", "viscoelastic_relaxation"], "named": ["free_play"]}
    assert is_unseen({**part, "true_evidence": {"free_play": 1800.0, "viscoelastic_relaxation": 5.2}})
    assert not is_unseen({**part, "true_evidence": {"free_play": 1800.0, "viscoelastic_relaxation": 250.0}})
    assert not is_unseen(part)
    assert not is_unseen({**part, "outcome": "wrong", "true_evidence": {"viscoelastic_relaxation": 5.2}})
