"""Explanations of swivels: starts inside their bounds, laws that the simulator takes, the same place there and back."""

from __future__ import annotations

import pytest

from ssmr_ident.doctor.swivels.candidates import UNLISTED, Candidate, candidates
from ssmr_ident.doctor.swivels.words import EQUATIONS, UNLISTED_EQUATIONS, unlisted_form
from ssmr_ident.physics.slots import checked_for_robot

EVERY = candidates((0.03, 0.1), (10.0,), 3e-5)


@pytest.mark.parametrize("candidate", EVERY, ids=lambda c: f"{c.id}-{'-'.join(f.name for f in c.free)}")
def test_starts_are_places_of_the_search(candidate: Candidate) -> None:
    for start in candidate.starts:
        assert set(start) == {free.name for free in candidate.free}
        assert all(free.lower <= start[free.name] <= free.upper for free in candidate.free)
        back = candidate.values(candidate.position(start))
        assert back == pytest.approx(start, rel=1e-9, abs=1e-12)
        assert checked_for_robot(candidate.effects(start))


def test_what_is_unlisted_has_a_smooth_law_and_one_with_loops() -> None:
    smooth, loops = (c for c in EVERY if c.id == UNLISTED)
    assert set(smooth.effects(smooth.starts[0])) == {"nonlinear_stiffness", "quadratic_damping"}
    assert loops.effects({"alpha": 0.5, "yield_m": 4e-4}) == {"hysteresis": {"alpha": 0.5, "yield_m": 4e-4}}


def test_every_explanation_has_an_equation_in_words() -> None:
    for candidate in EVERY:
        if candidate.id == UNLISTED:
            equation = UNLISTED_EQUATIONS[unlisted_form(candidate.starts[0])].format(**candidate.starts[0])
            assert all(f"{value:.3g}" in equation for value in candidate.starts[0].values())
        else:
            assert EQUATIONS[candidate.id]
