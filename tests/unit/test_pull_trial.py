"""What a pull's trial reads from its log before anything is fitted."""

from __future__ import annotations

import numpy as np
import pytest

from ssmr_ident.identify.trials.pull import find_slack, holds

STEP, SPEED, STIFFNESS = 0.01, 1e-3, 2e4


def ramp_and_hold(moving: float, standing: float) -> np.ndarray:
    return SPEED * np.minimum(STEP * np.arange(round((moving + standing) / STEP)), moving)


def relaxing(travel: np.ndarray, tau: float = 1.0) -> np.ndarray:
    """Spring, and as stiff a Maxwell branch beside it."""
    branch, force = 0.0, np.zeros(len(travel))
    for n, move in enumerate(np.diff(travel), start=1):
        branch += move - branch * STEP / tau
        force[n] = STIFFNESS * (travel[n] + branch)
    return force


@pytest.mark.parametrize("standing", [0.0, 4.0])
def test_a_slack_is_found_whether_or_not_the_head_stands_still_at_the_end(standing: float) -> None:
    travel = ramp_and_hold(3.0, standing)
    slack = 0.4e-3
    measured = relaxing(np.maximum(travel - slack, 0.0))
    measured += 0.3 * np.random.default_rng(3).standard_normal(len(measured))
    assert find_slack(measured, travel, relaxing(travel)) == pytest.approx(slack, abs=1e-5)


def test_a_wheel_that_lets_go_is_told_from_one_that_holds() -> None:
    noise = 0.5 * np.random.default_rng(4).standard_normal(700)
    travel = ramp_and_hold(3.0, 4.0)
    creeping = relaxing(travel)
    assert holds(creeping + noise, travel)
    assert not holds(np.minimum(creeping, 0.6 * creeping.max()) + noise, travel)
    # teeth rise as steeply as the first ramp, but get nowhere
    head = ramp_and_hold(7.0, 0.0)
    teeth = np.where(STIFFNESS * head < 40.0, STIFFNESS * head, 30.0 + np.mod(STIFFNESS * head, 10.0))
    assert not holds(teeth + noise, head)


def test_a_head_that_never_moves_holds_nothing() -> None:
    assert not holds(np.zeros(50), np.zeros(50))
