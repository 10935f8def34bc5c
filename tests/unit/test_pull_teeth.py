"""Teeth are compared by their sizes: what repeats counts, and when they come does not."""

from __future__ import annotations

import numpy as np

from ssmr_ident.identify.trials.teeth import find_teeth

STEP, SPEED, STIFFNESS, LEVEL = 0.01, 1e-3, 2e4, 60.0
BLOCK = 10


def saw(depth: float, phase: float, seed: int, seconds: float = 30.0) -> tuple[np.ndarray, np.ndarray]:
    """A rise to ``LEVEL``, then teeth of ``depth`` [N]; the first one ``phase`` of a tooth long."""
    travel = SPEED * STEP * np.arange(round(seconds / STEP))
    beyond = STIFFNESS * travel - LEVEL
    force = np.where(beyond < 0.0, STIFFNESS * travel, LEVEL - depth + np.mod(beyond + (1.0 - phase) * depth, depth))
    return force + 0.3 * np.random.default_rng(seed).standard_normal(len(force)), travel


def averaged(force: np.ndarray) -> np.ndarray:
    return force[: len(force) // BLOCK * BLOCK].reshape(-1, BLOCK).mean(axis=1)[:, None]


def test_the_same_teeth_at_other_times_are_alike_and_others_are_not() -> None:
    force, travel = saw(12.0, 1.0, 1)
    teeth = find_teeth(force, travel, BLOCK)
    assert teeth is not None
    assert teeth.count > 20
    here = averaged(force)

    def apart(other: np.ndarray) -> float:
        return float(np.sqrt(np.mean((teeth.ordered(here) - teeth.ordered(averaged(other))) ** 2)))

    later, _ = saw(12.0, 0.4, 2)
    smooth = np.minimum(STIFFNESS * travel, LEVEL - 6.0)
    smaller, _ = saw(6.0, 0.7, 3)
    assert np.std(here - averaged(later)) > 3.0  # sample by sample they differ as much as teeth and none
    assert apart(later) < 2.0 * teeth.noise
    assert min(apart(smooth), apart(smaller)) > 2.0 * apart(later)


def test_the_first_rise_is_compared_as_it_is() -> None:
    force, travel = saw(12.0, 1.0, 1)
    teeth = find_teeth(force, travel, BLOCK)
    assert teeth is not None
    before = teeth.edges[0]
    assert abs(before * BLOCK * STEP * SPEED * STIFFNESS - LEVEL) < 3.0
    assert np.array_equal(teeth.ordered(averaged(force))[:before], averaged(force)[:before])
    assert force[teeth.rise] < LEVEL
    assert teeth.weight[0] == 1.0
    assert teeth.weight[-1] < 1.0


def test_a_plateau_and_a_log_that_never_rises_have_no_teeth() -> None:
    noise = 0.3 * np.random.default_rng(5).standard_normal(3000)
    travel = SPEED * STEP * np.arange(3000)
    assert find_teeth(np.minimum(STIFFNESS * travel, LEVEL) + noise, travel, BLOCK) is None
    assert find_teeth(noise, travel, BLOCK) is None
