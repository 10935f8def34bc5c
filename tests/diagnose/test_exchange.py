"""Of two effects that are no pair the one that explains more is kept, whichever was found first."""

from __future__ import annotations

import math

import pytest
from small_rigs import Run, campaign, fitted, prepared

from ssmr_ident.compare.recorded import follow
from ssmr_ident.diagnose import accept, pairs
from ssmr_ident.diagnose.accept import ahead, certain, mends
from ssmr_ident.diagnose.explain import with_suspect
from ssmr_ident.diagnose.followed import explained
from ssmr_ident.diagnose.pairs import exchange
from ssmr_ident.diagnose.scan import Suspect
from ssmr_ident.diagnose.weigh import Explanation
from ssmr_ident.identify.fitting.descent import descend
from ssmr_ident.identify.fitting.joint import JointFit, differentiate, evaluate
from ssmr_ident.identify.trials import Trial

RUNS = [Run(force=60.0), Run(force=30.0), Run(force=90.0)]
SUSPECTS = {
    "nonlinear_stiffness": Suspect("nonlinear_stiffness", {"k3_N_m3": 1e6}, {}, {"k3_N_m3": 1e6}, 0.0),
    "dry_friction": Suspect("dry_friction", {"F_c_N": 1.0, "element_stiffness_N_m": 2e5}, {}, {}, 0.0),
}


def beside(base: JointFit, name: str) -> JointFit:
    model, point = with_suspect(base, SUSPECTS[name])
    return differentiate(descend(evaluate(base.trials, model, point, base.nuisances), 12))


@pytest.fixture(scope="module")
def hardens() -> tuple[dict[str, Explanation], tuple[Trial, ...]]:
    """Friction first and hardening first, each alone and with the other one; hardening is what is hidden."""
    setup = prepared(campaign({"nonlinear_stiffness": {"k3_N_m3": 2e6}}, RUNS, seed=5))
    base = fitted(setup)
    kept = follow(setup.kept, base.model, base.point).trials
    friction, hardening = beside(base, "dry_friction"), beside(base, "nonlinear_stiffness")
    fits = (friction, hardening, beside(friction, "nonlinear_stiffness"), beside(hardening, "dry_friction"))
    found = [explained(kept, fit) for fit in fits]
    return {e.id: e for e in found}, kept


@pytest.mark.slow
def test_what_stands_behind_another_takes_its_place(hardens: tuple[dict[str, Explanation], tuple[Trial, ...]]) -> None:
    found, kept = hardens
    pair, first = found["dry_friction+nonlinear_stiffness"], found["dry_friction"]
    alone = exchange(pair, first, kept, (math.inf,), ())
    assert alone is not None
    assert alone.id == "nonlinear_stiffness"
    _, effects = alone.fit.model.split(alone.fit.point)
    assert effects["nonlinear_stiffness"]["k3_N_m3"] == pytest.approx(2e6, rel=0.05)
    # one that was refitted by itself before is not refitted again
    known = found["nonlinear_stiffness"]
    assert exchange(pair, first, kept, (math.inf,), (known,)) is known


def test_the_right_one_stays(hardens: tuple[dict[str, Explanation], tuple[Trial, ...]]) -> None:
    found, kept = hardens
    pair, right = found["nonlinear_stiffness+dry_friction"], found["nonlinear_stiffness"]
    assert not mends(pair, right)
    assert exchange(pair, right, kept, (math.inf,), ()) is None
    assert exchange(pair, right, kept, (math.inf,), (found["dry_friction"],)) is None


def test_what_is_far_behind_alone_is_not_led_to_its_end(
    hardens: tuple[dict[str, Explanation], tuple[Trial, ...]], monkeypatch: pytest.MonkeyPatch
) -> None:
    found, kept = hardens
    pair, right = found["nonlinear_stiffness+dry_friction"], found["nonlinear_stiffness"]
    asked: list[JointFit] = []

    def polish(fit: JointFit, lengths: tuple[float, ...]) -> JointFit:
        asked.append(fit)
        return fit

    monkeypatch.setattr(pairs, "polish", polish)
    # alone, friction leaves 5 to 234 times the variance of the noise, and hardening 0.9 to 1.0
    assert exchange(pair, right, kept, (math.inf,), ()) is None
    assert not asked
    exchange(found["dry_friction+nonlinear_stiffness"], found["dry_friction"], kept, (math.inf,), ())
    assert [fit.model.ids for fit in asked] == [("nonlinear_stiffness",)]


def test_ahead_is_one_alone(
    hardens: tuple[dict[str, Explanation], tuple[Trial, ...]], monkeypatch: pytest.MonkeyPatch
) -> None:
    found, _ = hardens
    one, other = found["nonlinear_stiffness"], found["dry_friction"]
    assert ahead(one, other)
    assert not ahead(other, one)
    # each by its own count
    counts = {(one.id, other.id): 415.0, (other.id, one.id): 1256.0}
    monkeypatch.setattr(accept, "surplus", lambda a, b: counts[a.id, b.id])
    assert certain(one, other)
    assert not ahead(one, other)
    assert ahead(other, one)
