"""The judge of diagnoses judges as its page says."""

from __future__ import annotations

from dataclasses import replace

import pytest
from doctor.unseen import is_unseen
from made_diagnoses import hardening
from scoring import errors, outcome, row_of, share

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


@pytest.mark.slow
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


@pytest.mark.slow
def test_a_row_holds_the_floor_of_what_was_kept_back() -> None:
    row, _ = row_of("a", ("nonlinear_stiffness",), hardening, {"roll-3.xlsx": 3.0, "pitch-3.xlsx": 3.0}, seed=1)
    assert (row["outcome"], row["floor"], row["seed"]) == ("right", 3.0, 1)


def test_a_rate_has_its_interval() -> None:
    assert share(0, 1000).endswith("(0.0 … 0.4)")


def test_of_two_the_one_that_was_not_named_must_show() -> None:
    part = {"outcome": "part", "right": [["free_play", "viscoelastic_relaxation"]], "named": ["free_play"]}
    assert is_unseen(part, {"free_play": 1800.0, "viscoelastic_relaxation": 5.2})
    assert not is_unseen(part, {"free_play": 1800.0, "viscoelastic_relaxation": 250.0})
    assert not is_unseen(part, {})
    assert not is_unseen({**part, "outcome": "wrong"}, {"viscoelastic_relaxation": 5.2})


def test_what_is_missed_shows_unless_nothing_could_be_gained() -> None:
    missed = {"outcome": "missed", "right": [["stribeck"]], "named": [], "before": 4.0, "floor": 3.0}
    assert not is_unseen(missed, {})
    assert is_unseen({**missed, "before": 3.03}, {})
    assert is_unseen(missed, {"stribeck": 3.0})
    assert not is_unseen(missed, {"stribeck": 300.0})
