"""Of pulls a second effect is looked for where the first leaves more than noise, or a straight line promises one."""

from __future__ import annotations

import math
from types import SimpleNamespace

import pytest

from ssmr_ident.doctor.robots import search
from ssmr_ident.doctor.rules import MORE_OVER, SECOND

SAMPLES = 900


def leaves(
    monkeypatch: pytest.MonkeyPatch, gain: float, over: float = 1.0, members: tuple[str, ...] = ("one",)
) -> bool:
    suspect = SimpleNamespace(gain=gain, at={"first": 1.0, "second": 1.0})
    monkeypatch.setattr(search, "scan", lambda fit, effects: [[suspect]])
    monkeypatch.setattr(search, "differentiate", lambda fit: fit)
    monkeypatch.setattr(search, "candidates", lambda fit, baseline: ())
    best = SimpleNamespace(members=members, fit=object())
    asked = SimpleNamespace(best=best, samples=SAMPLES, over=lambda found: over)
    return search._leaves_a_second(asked)  # type: ignore[arg-type]


def test_a_straight_line_has_to_promise_certainty_at_the_price_of_its_parameters(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    price = 2.0 * SECOND + 2 * math.log(SAMPLES)
    assert leaves(monkeypatch, price + 0.1)
    assert not leaves(monkeypatch, price - 0.1)


def test_more_than_noise_asks_for_a_second_and_a_baseline_for_none(monkeypatch: pytest.MonkeyPatch) -> None:
    assert leaves(monkeypatch, 0.0, over=MORE_OVER + 0.01)
    assert not leaves(monkeypatch, 1e6, over=2.0 * MORE_OVER, members=())
