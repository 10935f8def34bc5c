"""Play in pulls, which no straight line points to."""

from __future__ import annotations

import numpy as np
import pytest
from bank import draw

from ssmr_ident.diagnose import explore
from ssmr_ident.diagnose.baseline import best_baseline
from ssmr_ident.diagnose.explore import search
from ssmr_ident.diagnose.loose import SHARES, begun_loose
from ssmr_ident.diagnose.setup import set_up
from ssmr_ident.identify.fitting.joint import JointFit
from ssmr_ident.physics.effects import CATALOGUE

SOME = tuple(CATALOGUE[name] for name in ("free_play", "nonlinear_stiffness"))


@pytest.fixture(scope="module")
def pulled() -> tuple[JointFit, tuple[float, ...], float]:
    """A baseline of short pulls with little play that leaves no more than noise, its horizons, and the gap [m]."""
    drawn = draw("pulls", "one", 7, "free_play", 0.35, short=True)
    setup = set_up(drawn.campaign, drawn.campaign.parameters)
    base, lengths = best_baseline(setup.fitted, setup, drawn.campaign.parameters)
    assert np.max(base.parts / [t.size for t in base.trials]) < 1.3
    return base, lengths, drawn.truth.effects["free_play"]["gap_m"]


def test_every_size_is_begun_of_what_loosens_alone(pulled: tuple[JointFit, tuple[float, ...], float]) -> None:
    base, _, gap = pulled
    starts = begun_loose(base, SOME)
    assert len(starts) == 2 * len(SHARES)  # share_x 1 and 0
    assert {suspect.effect for _, suspect in (s.args for s in starts)} == {"free_play"}
    gaps = sorted({suspect.at["gap_m"] for _, suspect in (s.args for s in starts)})
    np.testing.assert_allclose(np.diff(np.log(gaps)), np.log(2.0), rtol=1e-9)
    assert gaps[0] < gap < gaps[-1]


def test_play_is_found_where_no_straight_line_points(
    pulled: tuple[JointFit, tuple[float, ...], float], monkeypatch: pytest.MonkeyPatch
) -> None:
    base, lengths, gap = pulled
    monkeypatch.setattr(explore, "candidates", lambda *_: SOME)
    found = [fit for fit in search(base, "rigid6", lengths).tried if fit.model.ids == ("free_play",)]
    best = min(found, key=lambda fit: fit.cost(base.counted))
    assert best.cost(base.counted) < base.cost(base.counted) - 60.0
    assert best.model.split(best.point)[1]["free_play"]["gap_m"] == pytest.approx(gap, rel=0.3)
    monkeypatch.setattr(explore, "begun_loose", lambda *_: [])
    blind = [fit for fit in search(base, "rigid6", lengths).tried if fit.model.ids == ("free_play",)]
    assert not any(fit.cost(base.counted) < base.cost(base.counted) - 60.0 for fit in blind)
