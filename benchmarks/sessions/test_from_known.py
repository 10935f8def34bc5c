"""Effects begun from what is known, where a baseline that is bent far leads none of them home."""

from __future__ import annotations

from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest
from bank import draw

from ssmr_ident.diagnose import engine, explore, from_known
from ssmr_ident.diagnose.baseline import best_baseline
from ssmr_ident.diagnose.explore import Search, leads_astray, search, searched_from_known
from ssmr_ident.diagnose.from_known import SHARES, begun_from_known
from ssmr_ident.diagnose.setup import Setup, set_up
from ssmr_ident.identify.fitting.joint import JointFit, evaluate
from ssmr_ident.physics.effects import CATALOGUE


def _left(fit: JointFit) -> np.ndarray:
    return np.array(fit.parts / [t.size for t in fit.trials])


def test_tires_that_harden_by_swings_are_found_from_what_is_known(monkeypatch: pytest.MonkeyPatch) -> None:
    """Beside the bent baseline others come further on a first horizon, and stay far above the noise."""
    drawn = draw("decays", "one", 2, "nonlinear_stiffness", 0.97, short=True)
    assert set(drawn.truth.effects) == {"nonlinear_stiffness"}
    setup = set_up(drawn.campaign, drawn.campaign.parameters)
    base, lengths = best_baseline(setup.fitted, setup, drawn.campaign.parameters)
    assert np.median(_left(base)) > 100.0
    some = tuple(CATALOGUE[name] for name in ("nonlinear_stiffness", "quadratic_damping"))
    monkeypatch.setattr(explore, "candidates", lambda *_: some[1:])
    monkeypatch.setattr(from_known, "candidates", lambda *_: some)
    before = search(base, "rigid6", lengths)
    assert before.astray
    assert leads_astray(before.tried)
    after = searched_from_known(before, "rigid6")
    assert after is not None
    assert not after.astray
    found = {fit.model.ids: fit for fit in after.tried}
    assert np.median(_left(found["quadratic_damping",])) > 4.0
    assert np.median(_left(found["nonlinear_stiffness",])) < 1.5


def test_where_an_effect_explains_the_recordings_nothing_is_begun_anew(monkeypatch: pytest.MonkeyPatch) -> None:
    drawn = draw("decays", "one", 3, "nonlinear_stiffness", 0.5, short=True)
    setup = set_up(drawn.campaign, drawn.campaign.parameters)
    base, lengths = best_baseline(setup.fitted, setup, drawn.campaign.parameters)
    assert np.max(_left(base)) > 2.0
    monkeypatch.setattr(explore, "candidates", lambda *_: (CATALOGUE["nonlinear_stiffness"],))
    found = search(base, "rigid6", lengths)
    assert not found.astray
    assert np.median(_left(found.tried[0])) < 2.0


def test_an_effect_that_has_lost_its_way_is_led_home_before_all_are_begun_anew(monkeypatch: pytest.MonkeyPatch) -> None:
    drawn = draw("decays", "one", 3, "nonlinear_stiffness", 0.5, short=True)
    setup = set_up(drawn.campaign, drawn.campaign.parameters)
    base, lengths = best_baseline(setup.fitted, setup, drawn.campaign.parameters)
    monkeypatch.setattr(explore, "candidates", lambda *_: (CATALOGUE["nonlinear_stiffness"],))
    found = search(base, "rigid6", lengths).tried[0]
    # each release the other way round: the effect has its size, and all else is wrong
    away = evaluate(found.trials, found.model, found.point, [-n for n in found.nuisances])
    assert np.median(_left(away)) > 10.0
    monkeypatch.setattr(explore, "to_the_end", lambda *_, **__: [away])
    led = search(base, "rigid6", lengths)
    assert not led.astray
    assert np.median(_left(led.tried[0])) < 2.0
    # where that does not help, all effects may be begun in all sizes; of those only what is better than all counts
    monkeypatch.setattr(explore, "anew", lambda fit, _: fit)
    lost = search(base, "rigid6", lengths)
    assert lost.astray
    assert lost.tried == (away,)
    monkeypatch.setattr(explore, "begun_from_known", lambda *_: [])
    monkeypatch.setattr(explore, "to_the_end", lambda *_, **__: [])
    assert searched_from_known(lost, "rigid6") is None
    monkeypatch.setattr(explore, "to_the_end", lambda *_, **__: [found])
    again = searched_from_known(lost, "rigid6")
    assert again is not None
    assert again.tried == (found,)
    _only_where_even_two_lead_astray(monkeypatch, setup, lost, again)


def test_a_search_that_has_been_made_serves_the_first_round_alone(monkeypatch: pytest.MonkeyPatch) -> None:
    drawn = draw("decays", "one", 3, "nonlinear_stiffness", 0.5, short=True)
    parameters = drawn.campaign.parameters
    setup = set_up(drawn.campaign, parameters)
    base, lengths = best_baseline(setup.fitted, setup, parameters)
    monkeypatch.setattr(explore, "candidates", lambda *_: (CATALOGUE["nonlinear_stiffness"],))
    made = search(base, "rigid6", lengths)
    further: list[bool] = []
    monkeypatch.setattr(engine, "search", lambda *args: further.append(args[3]) or search(*args))
    found = engine._examined(replace(setup, begun=(base, lengths)), parameters, None, made)
    assert found.chosen.fit.model.ids == ("nonlinear_stiffness",)
    assert found.searches[0] is made
    assert all(further)
    engine._examined(replace(setup, begun=(base, lengths)), parameters, None)
    assert further.count(False) == 1


def _only_where_even_two_lead_astray(
    monkeypatch: pytest.MonkeyPatch, setup: Setup, lost: Search, again: Search
) -> None:
    """All sizes are tried where what was chosen, two effects perhaps, leaves much; and the better search is gone on
    with."""
    (away,), (found,) = lost.tried, again.tried
    asked: list[Search | None] = []
    chosen = [found]

    def examined(_: object, __: object, ___: object, searched: Search | None = None) -> SimpleNamespace:
        asked.append(searched)
        return SimpleNamespace(searches=(lost,), chosen=SimpleNamespace(fit=chosen[0]))

    monkeypatch.setattr(engine, "_examined", examined)
    monkeypatch.setattr(engine, "searched_from_known", lambda *_: again)
    for fit, passes in ((found, [None]), (away, [None, again])):
        chosen[0] = fit
        asked.clear()
        engine.examine(setup, setup.campaign.parameters)
        assert asked == passes
    monkeypatch.setattr(engine, "searched_from_known", lambda *_: None)
    asked.clear()
    engine.examine(setup, setup.campaign.parameters)
    assert asked == [None]


def test_every_formula_is_begun_at_sizes_far_apart_on_the_first_horizon(monkeypatch: pytest.MonkeyPatch) -> None:
    drawn = draw("decays", "one", 3, "nonlinear_stiffness", 0.5, short=True)
    setup = set_up(drawn.campaign, drawn.campaign.parameters)
    base, lengths = best_baseline(setup.fitted, setup, drawn.campaign.parameters)
    asked: list[tuple[int, int]] = []
    some = tuple(CATALOGUE[name] for name in ("nonlinear_stiffness", "free_play"))
    monkeypatch.setattr(from_known, "candidates", lambda *_: some)
    found = begun_from_known(base, "rigid6", lengths[0], lambda _, done, of: asked.append((done, of)))
    assert {fit.model.ids for fit in found} == {("nonlinear_stiffness",), ("free_play",)}
    forms = {tuple(c.parameter.name for c in fit.model.free) for fit in found}
    assert {("k3_N_m3",), ("knee_share", "knee_m")} <= forms
    assert asked[-1][1] % len(SHARES) == 0
    counted = min(found, key=lambda fit: float(np.log(fit.parts).sum())).counted  # the best one's independent samples
    costs = [fit.cost(counted) for fit in found if len(fit.model.free) == len(found[0].model.free)]
    assert costs == sorted(costs)
    longest = max(float(t.times[-1] - t.times[0]) for t in found[0].trials)
    assert longest <= lengths[0]
