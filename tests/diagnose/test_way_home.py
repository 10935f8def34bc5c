"""An answer beside a baseline in a hollow, and an effect of no size that has led out of it."""

from __future__ import annotations

import pytest
from small_rigs import ROUGH, Run, campaign, fitted, prepared

from ssmr_ident.compare.recorded import follow
from ssmr_ident.diagnose.accept import significant
from ssmr_ident.diagnose.explain import with_suspect
from ssmr_ident.diagnose.followed import explained
from ssmr_ident.diagnose.scan import Suspect
from ssmr_ident.diagnose.stripped import way_home
from ssmr_ident.diagnose.weigh import Explanation
from ssmr_ident.identify.fitting.descent import descend
from ssmr_ident.identify.fitting.joint import JointFit, differentiate, evaluate
from ssmr_ident.identify.trials import Trial

pytestmark = pytest.mark.slow

RUNS = [Run(force=60.0), Run(force=30.0), Run(force=90.0)]
FRICTION = Suspect("dry_friction", {"F_c_N": 0.05, "element_stiffness_N_m": 2e5}, {}, {}, 0.0)
HARDENING = Suspect("nonlinear_stiffness", {"k3_N_m3": 1e5}, {}, {"k3_N_m3": 1e6}, 0.0)

Told = tuple[JointFit, Explanation, Explanation, Explanation, tuple[Trial, ...]]


def told(effects: dict[str, dict[str, float]]) -> Told:
    """The baseline at its best; it in a hollow, a hardening beside that, and a friction beside the best."""
    setup = prepared(campaign(effects, RUNS, seed=3))
    home = fitted(setup)
    kept = follow(setup.kept, home.model, home.point).trials
    aside = differentiate(evaluate(home.trials, home.model, home.point + 0.3, home.nuisances))
    hardens = evaluate(home.trials, *with_suspect(aside, HARDENING), aside.nuisances)
    rubs = descend(evaluate(home.trials, *with_suspect(home, FRICTION), home.nuisances), 8)
    baseline, chosen, other = (explained(kept, fit) for fit in (aside, hardens, rubs))
    return home, baseline, chosen, other, kept


def test_a_friction_of_no_size_has_shown_where_the_baseline_is_at_its_best() -> None:
    home, baseline, chosen, other, kept = told({})
    assert not significant(differentiate(other.fit))
    assert baseline.fit.cost(home.counted) > home.cost(home.counted) + 100.0
    found = way_home(chosen, baseline, [baseline, chosen, other], kept, ROUGH)
    assert found is not None
    assert found.fit.model.ids == ()
    assert found.fit.cost(home.counted) == pytest.approx(home.cost(home.counted), abs=0.5)
    assert way_home(other, baseline, [baseline, chosen, other], kept, ROUGH) is None


def test_a_friction_that_is_there_has_shown_no_baseline() -> None:
    _, baseline, chosen, other, kept = told({"dry_friction": {"F_c_N": 4.0, "element_stiffness_N_m": 2e5}})
    assert significant(differentiate(other.fit))
    assert way_home(chosen, baseline, [baseline, chosen, other], kept, ROUGH) is None


def test_a_baseline_that_is_at_its_best_stays() -> None:
    home, _, chosen, other, kept = told({})
    best = explained(kept, home)
    assert way_home(chosen, best, [best, chosen, other], kept, ROUGH) is None
