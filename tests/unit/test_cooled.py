"""Models led from what they leave as noise to the noise: the variances in between, and what cannot be simulated."""

from __future__ import annotations

from types import SimpleNamespace

import numpy as np
import pytest

from ssmr_ident.core.errors import InputError
from ssmr_ident.doctor.robots import cooled
from ssmr_ident.doctor.robots.cooled import cooled_alone, distinct, fewer, from_known, variances
from ssmr_ident.doctor.robots.members import Member
from ssmr_ident.physics.linear import responses


def fit(rss: float, size: int = 100) -> SimpleNamespace:
    return SimpleNamespace(rss=rss, size=size, penalty=0.0, point=np.zeros(1))


def member(name: str) -> Member:
    return Member(name, "static_force", name, None, np.zeros(0))  # type: ignore[arg-type]


def test_every_variance_is_a_tenth_of_the_last_and_the_last_is_the_noises() -> None:
    assert variances(fit(25000.0)) == pytest.approx([250.0, 25.0, 2.5, 1.0])  # type: ignore[arg-type]
    assert variances(fit(80.0)) == [1.0]  # type: ignore[arg-type]


def test_two_fits_of_an_effect_go_on_and_none_that_leaves_far_more() -> None:
    tried = [
        (member(name), fit(left)) for name, left in (("a", 10.0), ("a", 12.0), ("a", 14.0), ("b", 90.0), ("c", 120.0))
    ]
    first = [(m.id, f.rss) for m, f in fewer(tried, 0, 10.0)]  # type: ignore[arg-type]
    assert first == [("a", 10.0), ("a", 12.0), ("b", 90.0)]
    assert [m.id for m, _ in fewer(tried, 1, 10.0)] == ["a", "a"]  # type: ignore[arg-type]


def test_starts_that_have_come_to_one_place_are_one() -> None:
    near, apart = fit(10.2), fit(10.2)
    apart.point = np.ones(1)
    tried = [(member("a"), fit(10.0)), (member("a"), near), (member("a"), apart), (member("b"), fit(10.0))]
    assert [f for _, f in distinct(tried)] == [tried[0][1], apart, tried[3][1]]  # type: ignore[arg-type]


def test_what_cannot_be_simulated_is_said_of_the_file(monkeypatch: pytest.MonkeyPatch) -> None:
    burst = fit(np.inf)
    assert cooled_alone(burst) is burst  # type: ignore[arg-type]
    monkeypatch.setattr(cooled, "follow", lambda *_: SimpleNamespace(rss=np.nan, trials=()))
    with pytest.raises(InputError, match="leaves the finite numbers"):
        from_known([], SimpleNamespace(unknowns=()))  # type: ignore[arg-type]


def test_a_motion_that_grows_beyond_all_numbers_is_not_finite_and_nothing_more() -> None:
    grows = np.array([[0.0, 1.0], [0.0, 500.0]])
    assert not np.all(np.isfinite(responses(grows, np.eye(2), np.linspace(0.0, 10.0, 5))))
