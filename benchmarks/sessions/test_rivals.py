"""Friction in a formula of no list is friction, or said to be none that is listed where it acts on one side."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest
from scipy.integrate import solve_ivp
from small_rigs import NOISE, RIG, Run, campaign

from ssmr_ident.core.recording import Channel
from ssmr_ident.experiments.campaign import Campaign
from ssmr_ident.workflows.diagnose import diagnose

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
