"""Explanations are compared at their best, and by what chance gives each of them."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from bank import draw
from small_rigs import Run, campaign, fitted, prepared

from ssmr_ident.diagnose.accept import leading
from ssmr_ident.diagnose.baseline import best_baseline
from ssmr_ident.diagnose.explain import beside
from ssmr_ident.diagnose.followed import NEAR, all_explained, contested, explained
from ssmr_ident.diagnose.race import ranked
from ssmr_ident.diagnose.scan import Suspect
from ssmr_ident.diagnose.setup import set_up
from ssmr_ident.diagnose.weigh import Explanation, evidences, log_evidence
from ssmr_ident.identify.fitting.descent import descend
from ssmr_ident.identify.fitting.joint import evaluate
from ssmr_ident.physics.effects import CATALOGUE

pytestmark = pytest.mark.slow

LENGTHS = (float("inf"),)


@pytest.mark.parametrize(("behind", "wins"), [(0.5 * NEAR, True), (1.5 * NEAR, False)])
def test_what_is_close_behind_is_led_to_its_best_before_it_is_turned_down(behind: float, wins: bool) -> None:
    """Hardening is what the rig has; a descent that stopped short leaves it behind quadratic damping."""
    runs = [Run(release=4e-3), Run(release=3e-3)]
    setup = prepared(campaign({"nonlinear_stiffness": {"k3_N_m3": 2e8}}, runs, seed=4))
    base = fitted(setup)

    def beside_it(effect: str, at: dict[str, float], steps: int) -> Explanation:
        suspect = Suspect(effect, at, {}, {name: abs(value) for name, value in at.items()}, 0.0)
        return explained(base.trials, descend(beside(base, suspect), steps))

    damping = beside_it("quadratic_damping", {"d2_N_s2_m2": 30.0}, 10)
    end = beside_it("nonlinear_stiffness", {"k3_N_m3": 2e8}, 10)

    def short_of_it(share: float) -> Explanation:
        point = end.fit.point.copy()
        point[-1] *= share
        return explained(base.trials, evaluate(base.trials, end.fit.model, point, end.fit.nuisances))

    def lead(other: Explanation) -> float:
        found = evidences([damping, other])
        return found[damping.id] - found[other.id]

    assert lead(end) < 0.0
    shares = np.linspace(1.0, 0.0, 400)
    hardening = short_of_it(next(share for share in shares if lead(short_of_it(float(share))) > behind))
    assert behind < lead(hardening) < behind + 0.5 * NEAR
    new = [damping, hardening]
    found = contested(leading(damping, new), new, base.trials, LENGTHS)
    assert found.id == ("nonlinear_stiffness" if wins else "quadratic_damping")
    assert found in new


@pytest.mark.parametrize("order", [(0, 1), (1, 0)])
def test_of_two_fits_of_one_effect_that_which_predicts_what_was_kept_back_is_an_explanation(
    order: tuple[int, int],
) -> None:
    """The right hardening, and a softening that a quiet recording hardly tells from it."""
    setup = prepared(campaign({"nonlinear_stiffness": {"k3_N_m3": 2e8}}, [Run(force=60.0), Run(force=5.0)], seed=4))
    base = fitted(setup)
    loud, quiet = base.trials
    own = evaluate([quiet], base.model, base.point, base.nuisances[1:])
    suspect = Suspect("nonlinear_stiffness", {"k3_N_m3": 2e8}, {}, {"k3_N_m3": 2e8}, 0.0)
    right = descend(beside(own, suspect), 10)
    wrong = descend(beside(own, replace(suspect, at={"k3_N_m3": -2e8})), 0)
    both = [right, wrong]
    found = all_explained(
        [loud], [both[k] for k in order], evaluate([loud], base.model, base.point, base.nuisances[:1])
    )
    assert [explanation.fit for explanation in found] == [right]


def test_states_that_one_explanation_alone_has_count_against_it() -> None:
    """A mast has four at each release, and noise fills them."""
    drawn = draw("decays", "none", 3, short=True)
    setup = set_up(drawn.campaign, drawn.campaign.parameters)
    base, _ = best_baseline(setup.fitted, setup, drawn.campaign.parameters)
    mast = {p.name: p.nominal for p in CATALOGUE["flexible_mast"].parameters}
    swaying = replace(base, model=replace(base.model, held={"flexible_mast": mast}))
    assert swaying.states - base.states == 4 * len(base.trials)
    assert ranked([swaying, base])[0] is base
    before, after = Explanation(base, base), Explanation(swaying, swaying)
    schwarz = 0.5 * np.log(2.0 * base.counted.sum())  # an effect counts as one parameter at least
    assert log_evidence(before, before) - log_evidence(after, before) == pytest.approx(
        0.5 * 4 * 2 * len(base.trials) + schwarz
    )
