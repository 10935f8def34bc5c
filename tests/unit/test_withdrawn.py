"""A robot's answer that predicts recordings worse than the baseline is none."""

from __future__ import annotations

from types import SimpleNamespace

import pytest

from ssmr_ident.doctor.robots.answer import GROWS, _harms


def explanation(fitted: float, kept: float) -> SimpleNamespace:
    return SimpleNamespace(fit=SimpleNamespace(rss=fitted), kept=SimpleNamespace(rss=kept))


@pytest.mark.parametrize(
    ("fitted", "kept", "harms"),
    [(40.0, 90.0, False), (40.0, 103.0, False), (40.0, 110.0, True), (110.0, 40.0, True), (40.0, float("nan"), True)],
)
def test_what_predicts_worse_harms(fitted: float, kept: float, harms: bool) -> None:
    assert _harms(explanation(fitted, kept), explanation(100.0, 100.0), GROWS) is harms  # type: ignore[arg-type]


@pytest.mark.parametrize(("fitted", "kept"), [(40.0, 100.5), (100.5, 40.0), (40.0, 100.0)])
def test_a_law_of_decays_that_mends_nothing_harms(fitted: float, kept: float) -> None:
    assert _harms(explanation(fitted, kept), explanation(100.0, 100.0), 1.0)  # type: ignore[arg-type]
    assert not _harms(explanation(fitted, 99.0), explanation(101.0, 100.0), 1.0)  # type: ignore[arg-type]
