"""Two effects that hide each other, behind a third one that explains a little of both."""

from __future__ import annotations

import math

import numpy as np
import pytest
from small_rigs import Run, campaign, fitted, prepared

from ssmr_ident.compare.recorded import follow
from ssmr_ident.diagnose.accept import leaves_structure
from ssmr_ident.diagnose.explain import with_suspect
from ssmr_ident.diagnose.followed import explained
from ssmr_ident.diagnose.pairs import instead
from ssmr_ident.diagnose.scan import Suspect
from ssmr_ident.diagnose.weigh import Explanation
from ssmr_ident.identify.fitting.descent import descend
from ssmr_ident.identify.fitting.joint import differentiate, evaluate
from ssmr_ident.identify.trials import Trial

pytestmark = pytest.mark.slow

BOTH = {"nonlinear_stiffness": {"k3_N_m3": 2e6}, "quadratic_damping": {"d2_N_s2_m2": 300.0}}
RUNS = [Run(force=60.0), Run(force=30.0), Run(force=90.0)]
BEGUN = {
    "quadratic_damping": {"d2_N_s2_m2": 100.0},
    "nonlinear_stiffness": {"k3_N_m3": 1e6},
    "dry_friction": {"F_c_N": 1.0, "element_stiffness_N_m": 2e5},
}


def judged(effects: dict[str, dict[str, float]]) -> tuple[dict[str, Explanation], tuple[Trial, ...]]:
    """The baseline and single effects beside it, by id, and what was kept back."""
    setup = prepared(campaign(effects, RUNS, seed=5, duration=3.0))
    base = fitted(setup)
    kept = follow(setup.kept, base.model, base.point).trials
    found = {"baseline": explained(kept, base)}
    for name, at in BEGUN.items():
        model, point = with_suspect(base, Suspect(name, at, {}, {"k3_N_m3": 1e6}, 0.0))
        fit = descend(evaluate(base.trials, model, point, base.nuisances), 12)
        found[name] = explained(kept, differentiate(fit))
    return found, kept


@pytest.fixture(scope="module")
def both() -> tuple[dict[str, Explanation], tuple[Trial, ...]]:
    return judged(BOTH)


def test_they_take_the_place_of_the_third(both: tuple[dict[str, Explanation], tuple[Trial, ...]]) -> None:
    found, kept = both
    third = found["dry_friction"]
    chosen, tried = instead(third, list(found.values()), kept, "sdof", (math.inf,), None)
    assert set(chosen.fit.model.ids) == set(BOTH)
    assert chosen in tried
    _, effects = chosen.fit.model.split(chosen.fit.point)
    assert effects["nonlinear_stiffness"]["k3_N_m3"] == pytest.approx(2e6, rel=0.05)
    # what a wrong law leaves grows with the motion, what the right pair leaves does not
    assert leaves_structure(third)
    assert not leaves_structure(chosen)


def test_one_that_explains_the_recordings_stays() -> None:
    found, kept = judged({"nonlinear_stiffness": BOTH["nonlinear_stiffness"]})
    right = found["nonlinear_stiffness"]
    chosen, tried = instead(right, list(found.values()), kept, "sdof", (math.inf,), None)
    assert chosen is right
    assert len(tried) == len(found)


def test_of_a_wrong_one_no_pair_is_made_where_one_effect_is_enough() -> None:
    """Beside hardening nothing mends anything, so friction is replaced by hardening alone."""
    found, kept = judged({"nonlinear_stiffness": BOTH["nonlinear_stiffness"]})
    wrong = found["dry_friction"]
    chosen, tried = instead(wrong, list(found.values()), kept, "sdof", (math.inf,), None)
    assert chosen.id == "nonlinear_stiffness"
    assert chosen in tried
    assert any(len(e.fit.model.ids) == 2 for e in tried)


def test_where_no_other_single_has_a_partner_the_first_one_stays(
    both: tuple[dict[str, Explanation], tuple[Trial, ...]],
) -> None:
    found, kept = both
    third = found["dry_friction"]
    chosen, tried = instead(third, [found["baseline"], third], kept, "sdof", (math.inf,), None)
    assert chosen is third
    assert len(tried) == 2


def test_noise_however_loud_is_no_structure() -> None:
    """Four times the variance that the noise was thought to have, evenly."""
    setup = prepared(campaign({}, RUNS, seed=6, duration=8.0, noise=4e-5), noise=2e-5)
    base = fitted(setup)
    kept = follow(tuple(t.with_noises(base.trials[0].noises) for t in setup.kept), base.model, base.point).trials
    loud = explained(kept, base)
    assert float(np.median(loud.kept.parts / [t.size for t in kept])) > 2.0
    assert not leaves_structure(loud)
