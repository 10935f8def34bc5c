"""All recordings of a session fitted together, each with nuisances of its own.

The cost is that of residuals whose size is unknown in every recording, Σ n ln(RSS), beside the priors: where the model
leaves structure behind, samples count for less; what is known beforehand is not outvoted by a misfit, nor are
recordings that it explains by one that it does not. n is the number of samples that are independent of each other.
Nuisances are eliminated recording by recording (Schur complement), so
cost grows linearly with the number of recordings.
Source: Gelman et al., Bayesian Data Analysis (2013), sections 2.7 and 14.2 (normal data of unknown variance).
"""

from __future__ import annotations

from collections.abc import Callable, Collection, Iterator, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from typing import TypeVar

import numpy as np

from ssmr_ident.core.threads import side_by_side
from ssmr_ident.identify.fitting.coordinates import Model, Split
from ssmr_ident.identify.trials.trial import Asked, Trial
from ssmr_ident.signals.noise import independent_samples

Array = np.ndarray
T = TypeVar("T")
Place = tuple[Array, Sequence[Array]]
"""A point, (p,), and the nuisances of every trial."""

MOVED = 0.3
"""By how much of the noise's size, over all samples, a difference may move the simulation, as slopes that are there
already have it: a coordinate of which the recordings know far more than its scale has bent by then. Of recordings that
ask for coarse steps it says nothing."""

NUISANCE_STEP = 1e-4
"""Of differences in a nuisance, in units of its scale."""

STEEPEST = 1e12
"""Slope, in sizes of the noise over deviations of what is known, beyond which a simulation bursts: in its square
nothing is left of what is known."""

BURST = 1e30
"""Simulated number, in its SI unit, beyond which an integration has burst; its square would overflow."""


def over(trials: Sequence[Trial], function: Callable[[int], T]) -> list[T]:
    """``function(index)`` for every trial, several at a time."""
    return list(side_by_side(function, range(len(trials))))


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
    exact : bool
        All slopes were worked out here.
    """

    trials: tuple[Trial, ...]
    model: Model
    point: Array
    nuisances: tuple[Array, ...]
    simulated: tuple[Array, ...]
    residuals: tuple[Array, ...]
    slopes: tuple[Slopes, ...] = ()
    exact: bool = False

    @cached_property
    def rss(self) -> float:
        """Sum of squared whitened residuals."""
        return float(sum(r @ r for r in self.residuals))

    @property
    def size(self) -> int:
        return sum(trial.size for trial in self.trials)

    @cached_property
    def parts(self) -> Array:
        """(t,) float, sum of squared whitened residuals of each trial, of which rounding leaves something always."""
        least = [float(np.sum(t.white_target**2)) * np.finfo(float).eps ** 2 for t in self.trials]
        return np.maximum([float(r @ r) for r in self.residuals], least)

    @cached_property
    def counted(self) -> Array:
        """(t,) float, samples of each trial that are independent of each other, by its residual's correlation."""
        return np.array(
            [
                sum(independent_samples(trial.by_channel(r)[:, c]) for c in range(len(trial.channels)))
                for trial, r in zip(self.trials, self.residuals, strict=True)
            ]
        )

    @property
    def independent(self) -> float:
        return float(self.counted.sum())

    @property
    def most_nuisances(self) -> int:
        return max((len(nuisance) for nuisance in self.nuisances), default=0)

    @property
    def weights(self) -> Array:
        """(t,) float by which squares of each trial count, its own misfit being the measure."""
        result: Array = self.counted / self.parts
        return result

    @property
    def penalty(self) -> float:
        """What the priors charge."""
        return float(self.point @ self.point) + sum(float(n @ n) for n in self.nuisances)

    @property
    def states(self) -> int:
        """Nuisances that act, of all recordings."""
        return sum(len(acting(trial, self.model)) for trial in self.trials)

    def only(self, index: int) -> JointFit:
        """One of the trials by itself."""
        one = slice(index, index + 1)
        return replace(
            self, trials=self.trials[one], nuisances=self.nuisances[one], simulated=self.simulated[one],
            residuals=self.residuals[one], slopes=self.slopes[one],
        )  # fmt: skip

    def cost(self, counted: Array) -> float:
        """Twice the negative log posterior, for given numbers of independent samples, (t,) float."""
        if not np.isfinite(self.rss):
            return np.inf
        sizes = np.array([trial.size for trial in self.trials])
        return float(counted @ np.log(self.parts / sizes)) + self.penalty


def together(fits: Sequence[JointFit]) -> JointFit:
    """Fits of different trials at one point, as one."""
    first = fits[0]
    return JointFit(
        tuple(t for f in fits for t in f.trials), first.model, first.point, tuple(n for f in fits for n in f.nuisances),
        tuple(s for f in fits for s in f.simulated), tuple(r for f in fits for r in f.residuals),
    )  # fmt: skip


def evaluate(
    trials: Sequence[Trial], model: Model, point: Array, nuisances: Sequence[Array], slopes: Sequence[Slopes] = ()
) -> JointFit:
    """Simulate every trial at a point."""
    return next(evaluate_all(trials, model, [(point, nuisances)], slopes))


def evaluate_all(
    trials: Sequence[Trial], model: Model, places: Sequence[Place], slopes: Sequence[Slopes] = ()
) -> Iterator[JointFit]:
    """Simulate every trial at several points and nuisances, all of a trial at once.

    What is left of the recordings is worked out one place after the other, as they are asked for.
    """
    sane = [bool(np.all(np.isfinite(np.concatenate([point, *nuisances])))) for point, nuisances in places]
    split = [model.split(point) for point, _ in places]

    def simulated(index: int) -> list[Array]:
        trial = trials[index]
        asked = [(*here, own[index]) for here, (_, own), good in zip(split, places, sane, strict=True) if good]
        found = iter(np.moveaxis(trial.runs(asked), -1, 0) if asked else ())
        return [next(found) if good else np.full_like(trial.target, np.nan) for good in sane]

    def left(trial: Trial, simulated: Array) -> tuple[Array, Array]:
        if not (simulated.max() < BURST and simulated.min() > -BURST):
            simulated = np.full_like(trial.target, np.nan)
        return simulated, trial.white_target - trial.whitened(simulated)

    def begun(index: int) -> tuple[list[Array], tuple[Array, Array]]:
        found = simulated(index)
        return found, left(trials[index], found[0])

    def further(place: int) -> list[tuple[Array, Array]]:
        return over(trials, lambda index: left(trials[index], first[index][0][place]))

    first = over(trials, begun)
    for place, (point, nuisances) in enumerate(places):
        pairs = further(place) if place else [pair for _, pair in first]
        yield JointFit(
            tuple(trials), model, point, tuple(nuisances), tuple(p[0] for p in pairs), tuple(p[1] for p in pairs),
            tuple(slopes),
        )  # fmt: skip


def differentiate(fit: JointFit, shared: bool = True) -> JointFit:
    """The same fit with its slopes by one-sided differences.

    Parameters
    ----------
    fit : JointFit
    shared : bool
        False leaves the model's coordinates where they are, and works out the nuisances' columns alone.
    """
    if fit.exact:
        return fit
    count = len(fit.model.unknowns) if shared else 0
    return replace(fit, slopes=differences(fit, range(count), range(fit.most_nuisances)), exact=shared)


def differences(fit: JointFit, coordinates: Collection[int], nuisances: Collection[int]) -> tuple[Slopes, ...]:
    """Slopes by some of the coordinates and nuisances, all others 0; of every trial."""
    model, point = fit.model, fit.point
    names = [unknown.name for unknown in model.unknowns]
    here = model.split(point)
    # robots are asked for by their values: one that has been split once is built once for all trials
    most = MOVED / np.maximum(np.sqrt(sum(np.sum(s.shared**2, axis=0) for s in fit.slopes)), 1e-300)
    asked_for = {trial.coarse for trial in fit.trials} if coordinates else set()
    moved = {
        c: _moved(model, point, here, np.minimum(c * model.steps(), most if c == 1.0 else np.inf)) for c in asked_for
    }

    def one(index: int) -> Slopes:
        trial, nuisance = fit.trials[index], fit.nuisances[index]
        centre = trial.whitened(fit.simulated[index])
        seen = [column for column in coordinates if trial.sees(names[column])]
        asked: list[Asked] = [(*moved[trial.coarse][column][1], nuisance) for column in seen]
        own_columns, width = [c for c in acting(trial, model) if c in nuisances], NUISANCE_STEP * trial.coarse
        for column in own_columns:
            sides = (1.0, -1.0) if trial.nuisances[column] in trial.even else (1.0,)
            for side in sides:
                aside = nuisance.copy()
                aside[column] += side * width
                asked.append((*here, aside))
        columns, own = np.zeros((len(centre), len(point))), np.zeros((len(centre), len(nuisance)))
        whitened = trial.whitened(trial.runs(asked)) if asked else np.zeros((len(centre), 0))
        slopes = (whitened[:, : len(seen)] - centre[:, None]) / [moved[trial.coarse][column][0] for column in seen]
        # where a step leaves what can be simulated, the fit stays along this coordinate
        columns[:, seen] = np.where(np.all(np.abs(slopes) < STEEPEST, axis=0), slopes, 0.0)
        found = iter(whitened[:, len(seen) :].T)
        for column in own_columns:
            ahead = next(found)
            even = trial.nuisances[column] in trial.even
            own[:, column] = (ahead - next(found)) / (2.0 * width) if even else (ahead - centre) / width
        return Slopes(columns, np.where(np.abs(own) < STEEPEST, own, 0.0))

    return tuple(over(fit.trials, one))


def _moved(model: Model, point: Array, here: Split, sizes: Array) -> list[tuple[float, Split]]:
    """Each coordinate's step, and what the model is after it."""
    found = []
    for column, size in enumerate(sizes):
        # towards the prior, so that a bound is not stepped over
        step = float(size if point[column] <= 0 else -size)
        found.append((step, model.with_one(here, column, float(point[column] + step))))
    return found


def acting(trial: Trial, model: Model) -> list[int]:
    """Nuisances that do something under a model."""
    return [
        column
        for column, name in enumerate(trial.nuisances)
        if name not in trial.idle or any(effect_id in model.held for effect_id in trial.idle[name])
    ]
