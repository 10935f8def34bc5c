"""An effect that only loud recordings show, where what is kept back is quiet."""

from __future__ import annotations

from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest
from small_rigs import Run, campaign, fitted, prepared, quiet

from ssmr_ident.diagnose import rotate
from ssmr_ident.diagnose.followed import explained
from ssmr_ident.diagnose.rotate import left_elsewhere, shown_by_all, shown_in_turn
from ssmr_ident.diagnose.weigh import CERTAIN, Explanation
from ssmr_ident.identify.fitting.joint import differentiate, evaluate
from ssmr_ident.workflows.diagnose import diagnose

pytestmark = pytest.mark.slow

LOUD_ONCE = [Run(force=30.0), Run(force=34.0), Run(force=26.0), Run(force=3.0)]
"""The last one is kept back as well."""


def test_it_is_found_where_what_is_kept_back_is_quiet() -> None:
    found = diagnose(campaign({"nonlinear_stiffness": {"k3_N_m3": 5e5}}, LOUD_ONCE, seed=3, duration=4.0))
    (effect,) = found.effects
    assert effect.id == "nonlinear_stiffness"
    assert effect.parameters["k3_N_m3"].value == pytest.approx(5e5, rel=0.1)


@pytest.mark.parametrize("seed", [3, 4, 5])
def test_nothing_is_named_where_nothing_is_missing(seed: int) -> None:
    assert diagnose(campaign({}, LOUD_ONCE, seed=seed, duration=4.0)).verdict == "nothing_missing"


def test_no_pull_is_kept_back_in_its_turn() -> None:
    """Where contacts slide, two simulators differ by more than small effects do."""
    sliding = SimpleNamespace(fit=SimpleNamespace(trials=(SimpleNamespace(searched=True),) * 4))
    assert not shown_in_turn(sliding, sliding)  # type: ignore[arg-type]


def test_a_recording_kept_back_may_be_left_with_more_than_any_that_was_fitted() -> None:
    setup = prepared(campaign({}, LOUD_ONCE, seed=3))
    base = explained([quiet(trial) for trial in setup.kept], fitted(setup))
    assert not left_elsewhere(base)
    louder = replace(base.kept, residuals=tuple(1.4 * r for r in base.kept.residuals))
    assert left_elsewhere(replace(base, kept=louder))


@pytest.mark.parametrize(("fitted_says", "all_say", "shown"), [(2.0, 30.0, True), (2.0, 3.0, False), (9.0, 0.0, True)])
def test_what_only_kept_pulls_show_is_asked_of_all_of_them(
    fitted_says: float, all_say: float, shown: bool, monkeypatch: pytest.MonkeyPatch
) -> None:
    fits = SimpleNamespace(trials=[SimpleNamespace(searched=True)]), SimpleNamespace(trials=[])
    monkeypatch.setattr(rotate, "_all_fitted", lambda explanation: explanation)
    monkeypatch.setattr(
        rotate, "_by_fitted", lambda leader, before: all_say if isinstance(leader, Explanation) else fitted_says
    )
    leader, before = (Explanation(fits[0], fits[1]) for _ in range(2))  # type: ignore[arg-type]
    assert shown_by_all(leader, before) is shown


def test_where_all_are_fitted_a_stiffness_that_only_the_loudest_show_is_certain() -> None:
    """Kept back are the loud ones here: the quiet ones that are fitted say nothing of a cubic."""
    runs = [Run(force=2.0), Run(force=2.5), Run(force=34.0), Run(force=30.0)]
    setup = prepared(campaign({"nonlinear_stiffness": {"k3_N_m3": 3e6}}, runs, seed=3, duration=2.0))
    trials = setup.fitted
    base = explained(trials[2:], fitted(replace(setup, fitted=trials[:2])))
    model, begin = base.fit.model.with_effect("nonlinear_stiffness", {"k3_N_m3": 3e6}, {})
    beside = evaluate(trials[:2], model, np.concatenate([base.fit.point, begin]), base.fit.nuisances)
    leader = explained(trials[2:], differentiate(beside))
    assert rotate._by_fitted(leader.fit, base.fit) < CERTAIN
    whole = [rotate._all_fitted(e) for e in (leader, base)]
    assert len(whole[0].trials) == 4
    assert rotate._by_fitted(*whole) > CERTAIN
