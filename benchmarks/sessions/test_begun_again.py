"""A bent baseline of decays that leaves much, with nothing found beside it, is begun again from what is known."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import pytest
from bank import draw

from ssmr_ident.diagnose import engine
from ssmr_ident.diagnose.baseline import begun_again, bent, best_baseline, leaves_much
from ssmr_ident.diagnose.engine import examine
from ssmr_ident.diagnose.explore import Search
from ssmr_ident.diagnose.setup import Setup, set_up
from ssmr_ident.identify.fitting.joint import JointFit


def _drawn(seed: int) -> tuple[Setup, JointFit, tuple[float, ...]]:
    drawn = draw("decays", "none", seed, short=True)
    setup = set_up(drawn.campaign, drawn.campaign.parameters)
    return setup, *best_baseline(setup.fitted, setup, drawn.campaign.parameters)


def test_a_baseline_in_a_hollow_is_left_for_the_one_that_what_is_known_leads_to(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    setup, fit, _ = _drawn(5796)
    assert bent(fit)
    assert leaves_much(fit)

    def nothing(base: JointFit, baseline: str, lengths: Sequence[float], *_: object) -> Search:
        return Search(base, (), (), tuple(lengths))

    monkeypatch.setattr(engine, "search", nothing)
    found = examine(setup, setup.campaign.parameters)
    assert found.chosen is found.baseline
    assert found.baseline.fit.cost(fit.counted) < fit.cost(fit.counted) - 100.0
    assert begun_again(found.baseline.fit, (np.inf,)) is None  # nothing can be shortened


def test_a_baseline_that_is_not_bent_stays() -> None:
    _, fit, lengths = _drawn(1)
    assert not bent(fit)
    assert begun_again(fit, lengths) is None
