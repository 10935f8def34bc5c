"""An effect that leaves most of the misfit, where more moves, is not the whole answer; one in another formula is."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest
from scipy.integrate import solve_ivp
from small_rigs import NOISE, RIG, Run, campaign, fitted, prepared, quiet

from ssmr_ident.core.recording import Channel
from ssmr_ident.diagnose import rivals
from ssmr_ident.diagnose.followed import explained, on_all
from ssmr_ident.diagnose.weigh import CERTAIN, TIE, all_fitted, log_evidence
from ssmr_ident.experiments.campaign import Campaign
from ssmr_ident.identify.fitting.joint import differentiate, evaluate
from ssmr_ident.physics.effects import CATALOGUE
from ssmr_ident.workflows.diagnose import diagnose

pytestmark = pytest.mark.slow

RELEASES = (4e-3, 3e-3, 2e-3, 1.5e-3)
FORCE, SLOW = 3.0, 2e-3


def _let_go(friction: Callable[[float, float], float]) -> Campaign:
    """Releases of a rig that an integrator of its own moves, friction being a force [N] of place and speed."""
    made = campaign({}, [Run(release=start) for start in RELEASES], seed=8)
    random, measurements = np.random.default_rng(9), []
    for measurement, start in zip(made.measurements, (*RELEASES, RELEASES[-1]), strict=True):
        time = measurement.recording.time

        def slope(_: float, state: np.ndarray) -> tuple[float, float]:
            place, speed = state
            push = RIG.stiffness * place + RIG.damping * speed + friction(place, speed)
            return speed, -push / RIG.mass

        moved = solve_ivp(slope, (0.0, time[-1]), (start, 0.0), t_eval=time, rtol=1e-8, atol=1e-12, max_step=2e-3)
        seen = Channel("position", moved.y[0] + NOISE * random.standard_normal(len(time)), "m")
        measurements.append(replace(measurement, recording=replace(measurement.recording, channels=(seen,))))
    return replace(made, measurements=tuple(measurements))


def test_friction_on_one_side_is_said_to_be_friction_or_none_that_is_listed() -> None:
    found = diagnose(_let_go(lambda place, speed: 2.0 * FORCE * np.tanh(speed / SLOW) * (place > 0.0)))
    (effect,) = found.effects
    assert found.verdict == "missing_physics"
    assert "unlisted" in (effect.id, *effect.indistinguishable_from)
    assert len(effect.indistinguishable_from) <= 2
    assert effect.id == "unlisted" or any("none that is listed" in note for note in found.notes)


@pytest.mark.parametrize("power", [1.0, 0.5], ids=["tanh", "steeper near rest"])
def test_friction_in_another_formula_is_friction(power: float) -> None:
    found = diagnose(_let_go(lambda place, speed: FORCE * np.tanh(speed / SLOW) * min(1.0, abs(speed) / 0.02) ** power))
    (effect,) = found.effects
    assert effect.id == "dry_friction"
    assert "unlisted" not in effect.indistinguishable_from
    assert not any("none that is listed" in note for note in found.notes)


def test_with_all_recordings_fitted_chance_in_the_parameters_tells_nothing() -> None:
    truth = {"quadratic_damping": {"d2_N_s2_m2": 30.0}}
    setup = prepared(campaign(truth, [Run(release=start) for start in RELEASES], seed=10))
    with_it = fitted(setup, truth)
    off = replace(with_it, point=with_it.point + np.array([0.01, 0.0]))
    lucky, other, without = (
        explained([quiet(trial, NOISE) for trial in setup.kept], differentiate(fit))
        for fit in (with_it, evaluate(off.trials, off.model, off.point, off.nuisances), fitted(setup))
    )
    assert log_evidence(lucky, lucky) - log_evidence(other, lucky) > TIE
    assert abs(all_fitted(on_all(lucky), on_all(other))) < 0.5
    assert all_fitted(on_all(lucky), on_all(without)) > CERTAIN
    assert rivals._tied_on_all(lucky, [without, other]) == [other]


def test_a_law_of_no_list_pays_for_those_that_it_was_chosen_from() -> None:
    setup = prepared(campaign({}, [Run(release=start) for start in RELEASES], seed=10))
    bare, off = (
        explained([quiet(trial, NOISE) for trial in setup.kept], differentiate(fitted(setup, effects)))
        for effects in ({}, {"unlisted": CATALOGUE["unlisted"].begun({})})
    )
    assert off.fit.parts == pytest.approx(bare.fit.parts)
    samples = float(bare.fit.counted.sum() + bare.kept.counted.sum())
    paid = log_evidence(bare, bare) - log_evidence(off, bare)
    assert paid == pytest.approx(0.5 * np.log(samples) + np.log(74.0), abs=0.01)
    assert all_fitted(bare.fit, off.fit) == pytest.approx(0.5 * np.log(bare.fit.counted.sum()) + np.log(74.0), abs=0.01)
