"""Recordings in a valley of their own are begun elsewhere, where that has to do with what they are explained by."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from bank import draw

from ssmr_ident.compare.starts import by_other_starts
from ssmr_ident.diagnose import finals
from ssmr_ident.diagnose.baseline import best_baseline
from ssmr_ident.diagnose.finals import led_on, mended
from ssmr_ident.diagnose.setup import set_up
from ssmr_ident.identify.fitting.descent import LOUD
from ssmr_ident.identify.fitting.joint import JointFit, each_best, evaluate, together

pytestmark = pytest.mark.slow


@pytest.fixture(scope="module")
def released() -> JointFit:
    """Decays with nothing missing, at their best."""
    drawn = draw("decays", "none", 11, short=True)
    setup = set_up(drawn.campaign, drawn.campaign.parameters)
    return best_baseline(setup.fitted, setup, drawn.campaign.parameters)[0]


@pytest.fixture(scope="module")
def astray(released: JointFit) -> JointFit:
    """The same, the first release the other way round."""
    own = [-released.nuisances[0], *released.nuisances[1:]]
    fit = evaluate(released.trials, released.model, released.point, own)
    assert fit.parts[0] > 100.0 * released.parts[0]
    return fit


def test_other_roads_lead_back(released: JointFit, astray: JointFit) -> None:
    found = by_other_starts(astray)
    assert found.parts == pytest.approx(released.parts, rel=0.01)
    assert all(one is other for one, other in zip(found.nuisances[1:], astray.nuisances[1:], strict=True))


def test_roads_are_tried_for_what_is_asked_for(astray: JointFit) -> None:
    others = list(range(1, len(astray.trials)))
    assert np.array_equal(by_other_starts(astray, only=others).parts, astray.parts)


def test_a_road_that_ends_worse_is_not_taken(released: JointFit) -> None:
    assert np.array_equal(by_other_starts(released).parts, released.parts)


def test_a_fit_is_mended_where_one_recording_is_astray(released: JointFit, astray: JointFit) -> None:
    found = mended(astray)
    assert found.cost(released.counted) == pytest.approx(released.cost(released.counted), abs=1.0)
    assert mended(astray, released).cost(released.counted) == found.cost(released.counted)


def test_what_is_left_as_well_without_the_effect_is_no_reason(
    released: JointFit, astray: JointFit, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(finals, "by_other_starts", lambda *_, **__: pytest.fail("a hundred simulations for nothing"))
    assert mended(astray, astray) is astray
    assert mended(released) is released
    # of a model that leaves most of them it is no start that is wanting
    all_round = evaluate(released.trials, released.model, released.point, [-n for n in released.nuisances])
    assert float(np.median(all_round.parts / [t.size for t in all_round.trials])) > LOUD
    assert mended(all_round) is all_round


def test_what_cannot_come_first_is_neither_led_on_nor_begun_elsewhere(
    released: JointFit, astray: JointFit, monkeypatch: pytest.MonkeyPatch
) -> None:
    # the one that is astray would not make up for all others
    blunt = replace(astray, residuals=(astray.residuals[0], *(1.2 * r for r in astray.residuals[1:])))
    hopeless = replace(released, residuals=tuple(10.0 * r for r in released.residuals))
    further: list[JointFit] = []
    elsewhere: list[JointFit] = []
    monkeypatch.setattr(finals, "horizon_fit", lambda trials, model, point, *_: handed.pop(0))
    monkeypatch.setattr(finals, "descend", lambda fit, *_, **__: further.append(fit) or fit)
    monkeypatch.setattr(finals, "by_other_starts", lambda fit, **_: elsewhere.append(fit) or fit)
    monkeypatch.setattr(finals, "side_by_side", lambda work, items: [work(item) for item in items])
    for other, led_further, begun_elsewhere in (
        (astray, [released, astray], [astray]),
        (blunt, [released, blunt], []),
        (hopeless, [released], []),
    ):
        handed = [released, other]
        further.clear()
        elsewhere.clear()
        base = replace(released, residuals=tuple(100.0 * r for r in released.residuals))
        assert led_on(base, [released, other], [np.inf], [np.inf], None) == [released, other]
        assert further == led_further
        assert elsewhere == begun_elsewhere


def test_recordings_are_taken_from_the_fit_that_leaves_least_of_them(released: JointFit, astray: JointFit) -> None:
    own = [*released.nuisances[:-1], -released.nuisances[-1]]
    other = evaluate(released.trials, released.model, released.point, own)
    assert np.array_equal(each_best([astray, other]).parts, released.parts)
    again = together([astray.only(k) for k in range(len(astray.trials))])
    assert np.array_equal(again.parts, astray.parts)
    assert again.penalty == pytest.approx(astray.penalty)
