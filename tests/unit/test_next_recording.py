"""What a rig is advised to record next: one recording within what it has shown, and how likely that decides."""

from __future__ import annotations

import re
from dataclasses import replace

import numpy as np
import pytest
from small_rigs import Run, campaign

from ssmr_ident.diagnose.deciding import advice, best_of, chance_of_deciding
from ssmr_ident.doctor.decide import MISSING, Decision
from ssmr_ident.doctor.laws import FORMS, proposals
from ssmr_ident.doctor.named import begun
from ssmr_ident.doctor.next_recording import next_recording
from ssmr_ident.doctor.table import Row, row_of
from ssmr_ident.estimate.baseline import baseline_fit
from ssmr_ident.estimate.motion import motion
from ssmr_ident.estimate.problem import problem_of
from ssmr_ident.estimate.values import Problem


def test_the_chance_is_that_of_a_log_bayes_factor() -> None:
    """Drawn: a unit normal shifted by the distance, or not, and the log of the two densities."""
    distance, rng = 3.4, np.random.default_rng(5)
    seen = rng.standard_normal(200_000)
    leads = 0.5 * distance**2 + distance * seen > 5.0
    apart = np.array([[0.0, distance], [distance, 0.0]])
    assert chance_of_deciding(np.zeros(2), apart) == pytest.approx(np.mean(leads), abs=0.005)


def test_what_leads_already_needs_less_and_what_is_far_behind_hardly_counts() -> None:
    apart = np.full((2, 2), 3.0)
    assert chance_of_deciding(np.array([4.0, 0.0]), apart) > chance_of_deciding(np.zeros(2), apart)


def test_the_mildest_of_the_good_ones_and_words_without_one() -> None:
    assert best_of(np.array([0.99, 0.97]), np.array([4.0, 2.0])) == 1
    told = advice("Let it go as in a.csv", ("play", "friction", "a loop"), 0.2)
    assert told.startswith("No recording within what was shown to be possible")
    assert told.endswith("with a probability of 20 %: let it go as in a.csv")


def tied(force: float) -> tuple[Problem, tuple[Row, ...]]:
    """Quadratic damping fitted beside a cubic spring, to recordings in which the latter acts."""
    runs = [Run(force=force) if force else Run(release=0.004) for _ in range(2)]
    made = campaign({"nonlinear_stiffness": {"k3_N_m3": 4e7}}, runs, seed=4, duration=2.0, noise=1e-4)
    problem = problem_of(made.measurements[:2], made.parameters)
    base = baseline_fit(problem)
    rows = [row_of(base, problem)]
    forms = [f for f in FORMS if f.name == "cubic" or f.effect == "quadratic_damping"]
    for offer in proposals(problem, base, motion(problem, base), forms=forms):
        rows.append(row_of(begun(problem, offer, base), problem))
    best = {r.ids: r for r in sorted(rows, key=lambda r: r.log_evidence)}
    alike = [replace(r, log_evidence=0.0) for r in best.values() if r.ids]
    return problem, tuple(sorted(alike, key=lambda r: r.ids))


@pytest.mark.slow
@pytest.mark.parametrize("force", [0.0, 20.0])
def test_one_recording_within_what_was_shown_with_its_chance(force: float) -> None:
    problem, rows = tied(force)
    decision = Decision(MISSING, rows[0], ties=rows[1].ids)
    told = next_recording(problem, rows, decision, undetermined=False)
    assert "between nonlinear stiffness and quadratic damping" in told
    assert re.search(r"probability of (more than )?\d+ %", told)
    if not force:
        (size,) = map(float, re.findall(r"from ([\d.]+) mm", told))
        assert size <= 4.2
    assert next_recording(problem, rows, replace(decision, ties=()), undetermined=False) == ""
