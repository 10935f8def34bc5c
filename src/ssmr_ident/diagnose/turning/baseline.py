"""Fitting the baseline: sliding speed and floor over a grid, then everything within its prior by Gauss-Newton."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import replace

import numpy as np

from ssmr_ident.diagnose.turning.anchor import SEEDS, Anchor, Prior, as_columns, priors_of
from ssmr_ident.diagnose.turning.bench import COARSE, Bench
from ssmr_ident.diagnose.turning.conditions import Condition
from ssmr_ident.diagnose.turning.likelihood import NEPER_DB, Score

_DIFFERENCE = 0.7  # standard deviations of the prior; spectra of chaotic runs are no smooth functions of less
ROUNDS, FRESH = 5, 2  # of Gauss-Newton, and in how many of them slopes are simulated anew


def anchored(
    bench: Bench,
    fitted_on: tuple[Condition, ...],
    calibrated: bool,
    scale: np.ndarray,
    advance: Callable[[], None],
    rounds: int = ROUNDS,
    seeds: tuple[int, ...] = SEEDS,
    fixed: Mapping[str, float] | None = None,
    starts: tuple[np.ndarray, ...] = (),
    slopes: np.ndarray | None = None,
) -> Anchor:
    """Fit the baseline: sliding speed and floor over a grid, then everything within its prior by Gauss-Newton.

    ``fixed`` are parameters held at values of their own; ``starts``, in standard deviations, take the grid's place;
    with ``slopes`` from a neighbouring fit none are simulated.
    """
    priors = priors_of(bench.parameters)
    free = Anchor(bench, scale, priors, np.zeros(len(priors)), (), Score(-np.inf, 0.0, 0.0), seeds, fixed=fixed or {})

    def value(z: np.ndarray, of: Anchor = free) -> Score | None:
        found = of.score(fitted_on, {}, of.at(z))
        if found is None:
            return None
        one = found[0]
        return Score(one.log_likelihood - 0.5 * float(z @ z), one.tau_db, one.rms_db)

    best_z = np.zeros(len(priors))
    best: Score | None = None
    grid = starts or _grid(priors)
    if not starts:  # only the best of the grid with short steps
        coarse = replace(free, step=COARSE)
        bench.prefetch(((c, free.at(z), {}, seed) for z in grid for c in fitted_on for seed in seeds), COARSE)
        rough = [(found.log_likelihood, i) for i, z in enumerate(grid) if (found := value(z, coarse)) is not None]
        grid = tuple(grid[i] for _, i in sorted(rough, reverse=True)[:2])
    bench.prefetch((c, free.at(z), {}, seed) for z in grid for c in fitted_on for seed in seeds)
    for z in grid:
        found = value(z)
        if found is not None and (best is None or found.log_likelihood > best.log_likelihood):
            best, best_z = found, z
    advance()
    given = slopes is not None
    for done in range(rounds):
        if best is None:
            break
        if not given and done < FRESH:
            slopes = _slopes(free, fitted_on, best_z)
        before = best
        if slopes is not None:
            best, best_z = _step(free, fitted_on, best_z, best, slopes, value)
        advance()
        if best is before and (given or done >= FRESH - 1):
            break
    if best is None:
        raise FloatingPointError("no values within the priors make a robot that can be simulated")
    return Anchor(
        bench, scale, priors, best_z, fitted_on if calibrated else (), best, seeds, fixed=fixed or {}, slopes=slopes
    )


def _grid(priors: tuple[Prior, ...]) -> tuple[np.ndarray, ...]:
    index = {p.path: i for i, p in enumerate(priors)}
    grid = []
    for speed in (-1.8, -0.9, 0.0, 0.9, 1.8):
        for floor in (-1.5, 0.0, 1.5):
            z = np.zeros(len(priors))
            for path, shift in (("tire.sliding_speed_m_s", speed), ("floor.height_m", floor)):
                if path in index:
                    z[index[path]] = shift
            grid.append(z)
    return tuple(grid)


def _residual(free: Anchor, conditions: tuple[Condition, ...], z: np.ndarray) -> np.ndarray | None:
    blocks = free.blocks(conditions, {}, 0.0, free.at(z))
    return None if blocks is None else np.concatenate([b.residual for b in blocks])


def _slopes(free: Anchor, conditions: tuple[Condition, ...], z: np.ndarray) -> np.ndarray | None:
    """(n, p) float: of the residuals over ``z``."""
    ahead = [z + _DIFFERENCE * (np.arange(len(z)) == i) for i in range(len(z))]
    free.bench.prefetch((c, free.at(at), {}, seed) for at in [z, *ahead] for c in conditions for seed in free.seeds)
    base = _residual(free, conditions, z)
    if base is None:
        return None
    columns = [_residual(free, conditions, at) for at in ahead]
    found = [np.zeros_like(base) if c is None else (c - base) / _DIFFERENCE for c in columns]
    return as_columns(found, len(base))


def _step(
    free: Anchor,
    conditions: tuple[Condition, ...],
    z: np.ndarray,
    now: Score,
    slopes: np.ndarray,
    value: Callable[[np.ndarray], Score | None],
) -> tuple[Score, np.ndarray]:
    """One step of Gauss-Newton, shortened until it helps; where it began if it does not."""
    base = _residual(free, conditions, z)
    if base is None:
        return now, z
    weight = 1.0 / (6.0 * (0.05 + (now.tau_db / NEPER_DB) ** 2))
    change = np.linalg.solve(weight * slopes.T @ slopes + np.eye(len(z)), -weight * slopes.T @ base - z)
    for length in (1.0, 0.5, 0.25, 0.1):
        at = z + length * change
        free.bench.prefetch((c, free.at(at), {}, seed) for c in conditions for seed in free.seeds)
        found = value(at)
        if found is not None and found.log_likelihood > now.log_likelihood:
            return found, at
    return now, z
