"""All recordings of a session fitted together, each with nuisances of its own.

The cost is that of residuals whose size is unknown, n ln(RSS), beside the priors: where the model leaves structure
behind, all samples count for less, and what is known beforehand is not outvoted by a misfit. n is the number of
samples that are independent of each other. Nuisances are eliminated recording by recording (Schur complement), so
cost grows linearly with the number of recordings.
Source: Gelman et al., Bayesian Data Analysis (2013), sections 2.7 and 14.2 (normal data of unknown variance).
"""

from __future__ import annotations

import os
from collections.abc import Callable, Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from functools import cached_property
from typing import TypeVar

import numpy as np

from ssmr_ident.identify.coordinates import Model
from ssmr_ident.identify.trials.trial import Trial

Array = np.ndarray
T = TypeVar("T")

SHARES = (1.0, 0.4, 0.12, 0.03)
"""Of a Gauss-Newton step that are tried."""

NUISANCE_STEP = 1e-4
"""Of differences in a nuisance, in units of its scale."""

SETTLED = 0.1
"""Fall of the cost (twice a log-likelihood) at which a fit is at rest."""

_POOL = ThreadPoolExecutor(max_workers=max(1, min(8, os.cpu_count() or 1)))


def over(trials: Sequence[Trial], function: Callable[[int], T]) -> list[T]:
    """``function(index)`` for every trial, several at a time; compiled loops let go of the interpreter."""
    return list(_POOL.map(function, range(len(trials))))


@dataclass(frozen=True, eq=False)
class Slopes:
    """Derivatives of one trial's whitened simulation.

    Parameters
    ----------
    shared : (N, p) float
        By the model's coordinates.
    own : (N, k) float
        By the trial's nuisances.
    """

    shared: Array
    own: Array


@dataclass(frozen=True, eq=False)
class JointFit:
    """A model at some point, with every trial's nuisances.

    Parameters
    ----------
    trials : tuple of Trial
    model : Model
    point : (p,) float
        Scaled coordinates.
    nuisances : tuple of (k,) float
    simulated : tuple of (n, c) float
    residuals : tuple of (N,) float
        Whitened, in units of the noise.
    slopes : tuple of Slopes
        As last worked out, maybe elsewhere.
    """

    trials: tuple[Trial, ...]
    model: Model
    point: Array
    nuisances: tuple[Array, ...]
    simulated: tuple[Array, ...]
    residuals: tuple[Array, ...]
    slopes: tuple[Slopes, ...] = ()

    @cached_property
    def rss(self) -> float:
        """Sum of squared whitened residuals."""
        return float(sum(r @ r for r in self.residuals))

    @property
    def size(self) -> int:
        return sum(trial.size for trial in self.trials)

    @cached_property
    def independent(self) -> float:
        """Samples that are independent of each other, by the residual's own correlation in time."""
        return sum(
            worth(trial.by_channel(r)[:, c])
            for trial, r in zip(self.trials, self.residuals, strict=True)
            for c in range(len(trial.channels))
        )

    @property
    def penalty(self) -> float:
        """What the priors charge."""
        return float(self.point @ self.point) + sum(float(n @ n) for n in self.nuisances)

    def cost(self, independent: float) -> float:
        """Twice the negative log posterior, for a given number of independent samples."""
        if not np.isfinite(self.rss):
            return np.inf
        return independent * np.log(self.rss / self.size) + self.penalty

    def covariance(self) -> Array:
        """Of the scaled coordinates, nuisances integrated out; (p, p)."""
        matrix, _ = _normal(self, self.independent / self.rss)
        return np.linalg.inv(matrix)


def worth(residual: Array) -> float:
    """Number of independent samples in a residual, n/(1 + 2 Σ ρ²) (Bartlett 1946)."""
    used = residual[residual != 0.0] if np.any(residual == 0.0) else residual
    count = len(used)
    if count < 8:
        return float(count)
    size = 1 << (2 * count - 1).bit_length()
    covariance = np.fft.irfft(np.abs(np.fft.rfft(used, size)) ** 2, size)[: max(2, count // 4)]
    if not covariance[0] > 0:
        return float(count)
    rho = covariance[1:] / covariance[0]
    excess = float(np.sum(rho**2)) - len(rho) / count  # what white noise shows of it by chance
    return count / (1.0 + 2.0 * max(excess, 0.0))


def evaluate(
    trials: Sequence[Trial], model: Model, point: Array, nuisances: Sequence[Array], slopes: Sequence[Slopes] = ()
) -> JointFit:
    """Simulate every trial at a point."""
    values, effects = model.split(point)
    sane = bool(np.all(np.isfinite(point))) and all(np.all(np.isfinite(n)) for n in nuisances)

    def one(index: int) -> tuple[Array, Array]:
        trial = trials[index]
        simulated = trial.run(values, effects, nuisances[index]) if sane else np.full_like(trial.target, np.nan)
        return simulated, trial.white_target - trial.whitened(simulated)

    pairs = over(trials, one)
    return JointFit(
        tuple(trials), model, point, tuple(nuisances), tuple(p[0] for p in pairs), tuple(p[1] for p in pairs),
        tuple(slopes),
    )  # fmt: skip


def search_again(fit: JointFit) -> JointFit:
    """The same point, with the nuisances that are found by a search looked for anew."""
    values, effects = fit.model.split(fit.point)

    def one(index: int) -> tuple[Array, Array, Array]:
        trial, kept = fit.trials[index], fit.nuisances[index]
        if trial.searched:
            found = trial.begin(values, effects)
            simulated = trial.run(values, effects, found)
            residual = trial.white_target - trial.whitened(simulated)
            if float(residual @ residual) < float(fit.residuals[index] @ fit.residuals[index]):
                return found, simulated, residual
        return kept, fit.simulated[index], fit.residuals[index]

    if not any(trial.searched for trial in fit.trials):
        return fit
    own, simulated, residuals = zip(*over(fit.trials, one), strict=True)
    return JointFit(fit.trials, fit.model, fit.point, own, simulated, residuals, fit.slopes)


def differentiate(fit: JointFit, only_effects: bool = False, own: bool = True) -> JointFit:
    """The same fit with its slopes by one-sided differences.

    Parameters
    ----------
    fit : JointFit
    only_effects : bool
        Work out the columns of effects' parameters alone and keep the others.
    own : bool
        Work out the nuisances' columns.
    """
    model, point = fit.model, fit.point
    steps = model.steps()
    first = len(model.physics) if only_effects else 0
    names = [unknown.name for unknown in model.unknowns]

    def one(index: int) -> Slopes:
        trial, nuisance = fit.trials[index], fit.nuisances[index]
        centre = trial.whitened(fit.simulated[index])
        shared = np.empty((len(centre), len(point)))
        if only_effects:
            shared[:, :first] = fit.slopes[index].shared[:, :first]
        for column in range(first, len(point)):
            if not trial.sees(names[column]):
                shared[:, column] = 0.0
                continue
            moved = point.copy()
            # towards the prior, so that a bound is not stepped over
            step = trial.coarse * (steps[column] if point[column] <= 0 else -steps[column])
            moved[column] += step
            values, effects = model.split(moved)
            slope = (trial.whitened(trial.run(values, effects, nuisance)) - centre) / step
            # where a step leaves what can be simulated, the fit stays along this coordinate
            shared[:, column] = slope if np.all(np.isfinite(slope)) else 0.0
        if not own:
            return Slopes(shared, fit.slopes[index].own)
        values, effects = model.split(point)
        columns = np.empty((len(centre), len(nuisance)))
        for column in range(len(nuisance)):
            moved = nuisance.copy()
            moved[column] += NUISANCE_STEP * trial.coarse
            ahead = trial.whitened(trial.run(values, effects, moved))
            columns[:, column] = (ahead - centre) / (NUISANCE_STEP * trial.coarse)
        return Slopes(shared, columns)

    slopes = over(fit.trials, one)
    return JointFit(fit.trials, model, point, fit.nuisances, fit.simulated, fit.residuals, tuple(slopes))


def _normal(fit: JointFit, weight: float, damping: float = 0.0) -> tuple[Array, Array]:
    """Matrix and right side in the shared coordinates, nuisances eliminated."""
    count = len(fit.point)
    matrix, right = np.eye(count), -fit.point.copy()
    for slopes, residual, nuisance in zip(fit.slopes, fit.residuals, fit.nuisances, strict=True):
        a, b = slopes.shared, slopes.own
        own = weight * (b.T @ b) + np.eye(len(nuisance))
        if damping:
            own[np.diag_indices_from(own)] *= 1.0 + damping
        side = weight * (b.T @ residual) - nuisance
        cross = weight * (b.T @ a)
        solved = np.linalg.solve(own, np.column_stack([cross, side]))
        matrix += weight * (a.T @ a) - cross.T @ solved[:, :count]
        right += weight * (a.T @ residual) - cross.T @ solved[:, count]
    return matrix, right


def _step(fit: JointFit, weight: float, damping: float) -> tuple[Array, list[Array]]:
    matrix, right = _normal(fit, weight, damping)
    matrix[np.diag_indices_from(matrix)] *= 1.0 + damping
    move = np.linalg.solve(matrix, right) if len(right) else right
    own = []
    for slopes, residual, nuisance in zip(fit.slopes, fit.residuals, fit.nuisances, strict=True):
        b = slopes.own
        gram = weight * (b.T @ b) + np.eye(len(nuisance))
        gram[np.diag_indices_from(gram)] *= 1.0 + damping
        side = weight * (b.T @ (residual - slopes.shared @ move)) - nuisance
        own.append(np.linalg.solve(gram, side))
    return move, own


def descend(fit: JointFit, iterations: int, fresh: str = "all", independent: float | None = None) -> JointFit:
    """Damped Gauss-Newton.

    Parameters
    ----------
    fit : JointFit
        Where to begin; with slopes unless they are made fresh.
    iterations : int
    fresh : {"all", "effects", "none"}
        Which slopes are worked out anew at each iteration. Those of the baseline change little when an effect is
        added, and cost ten times those of an effect.
    independent : float or None
        Number of independent samples; None takes each residual's own.
    """
    damping = 0.0
    for _ in range(iterations):
        fit = search_again(fit)
        if fresh == "all":
            fit = differentiate(fit)
        elif fresh == "effects" and fit.model.free:
            fit = differentiate(fit, only_effects=True, own=False)
        counted = independent or fit.independent
        before = fit.cost(counted)
        after = fit
        for _ in range(3):
            move, own = _step(fit, counted / fit.rss, damping)
            for share in SHARES:
                trial = evaluate(
                    fit.trials,
                    fit.model,
                    fit.point + share * move,
                    [n + share * o for n, o in zip(fit.nuisances, own, strict=True)],
                    fit.slopes,
                )
                if trial.cost(counted) < before:
                    after = trial
                    break
            if after is not fit:
                break
            damping = max(10.0 * damping, 1e-2)
        damping *= 0.1
        gain = before - after.cost(counted)
        fit = after
        if gain < SETTLED:
            break
    return fit
