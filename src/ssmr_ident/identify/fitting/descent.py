"""Damped Gauss-Newton over all recordings of a session together, with slopes that are corrected between differences."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import replace

import numpy as np

from ssmr_ident.core.simd import WIDTH
from ssmr_ident.identify.fitting.curvature import Curvature
from ssmr_ident.identify.fitting.joint import JointFit, Slopes, differentiate, evaluate, evaluate_all, over

Array = np.ndarray
Differentiated = Callable[[JointFit, bool], JointFit]
"""``joint.differentiate``, or what stands in for it."""

DAMPINGS = (0.0, 1e-4, 1e-3, 0.01, 0.1, 1.0, 10.0, 100.0, 1e3)
"""Shares by which the curvature is raised in steps that are tried (Marquardt 1963)."""

SETTLED = 0.1
"""Fall of the cost (twice a log-likelihood) at which a fit is at rest."""

SECANTS = 3
"""Steps with corrected slopes after one with exact ones: each costs two simulations in place of thirty."""

AHEAD = WIDTH
"""Dampings that are simulated together where that costs hardly more than one."""

SLOW = 1e-4
"""The same per independent sample: where a model leaves structure, its optimum is flat beyond what that tells."""


LOUD = 2.0
"""Variance over the noise's from which a recording counts as unexplained: what is left there is large."""


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

    if not slides(fit):
        return fit
    own, simulated, residuals = zip(*over(fit.trials, one), strict=True)
    return JointFit(fit.trials, fit.model, fit.point, own, simulated, residuals, fit.slopes)


def corrected(before: JointFit, after: JointFit) -> JointFit:
    """``after`` with the slopes of ``before`` made to say what the step between the two really did.

    The least change that does, in units of the coordinates' own effect (Broyden 1965). It costs nothing, and saves
    most of the differences on the way to the optimum.
    """
    move = after.point - before.point
    moved = bool(move.any())
    found = []
    rows = zip(before.slopes, before.nuisances, after.nuisances, before.residuals, after.residuals, strict=True)
    for slopes, own_before, own_after, residual, new in rows:
        own = own_after - own_before
        missed = residual - new - (slopes.shared @ move if moved else 0.0) - slopes.own @ own
        size = np.sum(slopes.shared**2, axis=0) * move if moved else move, np.sum(slopes.own**2, axis=0) * own
        length = float(size[0] @ move + size[1] @ own)
        if length > 0.0 and np.all(np.isfinite(missed)):
            slopes = Slopes(
                slopes.shared + np.outer(missed, size[0] / length) if moved else slopes.shared,
                slopes.own + np.outer(missed, size[1] / length),
            )
        found.append(slopes)
    return replace(after, slopes=tuple(found), exact=False)


def descend(
    fit: JointFit,
    iterations: int,
    settled: float = SETTLED,
    shared: bool = True,
    plain: bool = False,
    temper: float = 1.0,
    secants: int = SECANTS,
    slopes: Differentiated = differentiate,
) -> JointFit:
    """Damped Gauss-Newton.

    Parameters
    ----------
    fit : JointFit
        Where to begin.
    iterations : int
    settled : float
        Fall of the cost at which the fit is at rest.
    shared : bool
        False moves the nuisances alone.
    plain : bool
        Squares in units of the noise, in place of n ln(RSS): what a recording leaves then draws the fit all the more,
        where it would count for little. For a model that can explain all recordings and is still far from them.
    temper : float
        Variance of what counts as noise in plain squares, in that of the recordings' white noise: what is known of the
        parameters then holds until a model begins to follow what moves.
    secants : int
        Steps with corrected slopes after each with exact ones.
    slopes : callable
        ``slopes(fit, shared)``: the same fit with its slopes.
    """
    rung = 0
    for _ in range(iterations if np.isfinite(fit.rss) else 0):
        fit = slopes(search_again(fit), shared)
        counted = fit.counted
        enough = max(settled, SLOW * float(counted.sum()))
        first = True
        for _ in range(1 + secants):
            after, rung = best_step(fit, counted, rung, shared, plain, temper)
            gain = _cost(fit, counted, plain, temper) - _cost(after, counted, plain, temper)
            if gain < enough:
                break
            fit, first = corrected(fit, after), False
        if gain > 0.0:
            fit = after
        if first:
            break
    return fit


def ahead(fit: JointFit) -> JointFit:
    """Where an undamped step in plain squares leads, lower or not: damping keeps a fit from moving along what the
    recordings hardly tell."""
    fit = differentiate(fit)
    move, own = Curvature.of(fit, np.ones(len(fit.trials))).step(0.0)
    nuisances = [n + o for n, o in zip(fit.nuisances, own, strict=True)]
    return evaluate(fit.trials, fit.model, fit.point + move, nuisances)


def slides(fit: JointFit) -> bool:
    """Whether contacts slide in any recording, whose nuisances no descent finds."""
    return any(t.searched for t in fit.trials)


def chatters(fit: JointFit) -> bool:
    """Whether contacts slide in recordings of which much is left."""
    left = fit.parts / [t.size for t in fit.trials]
    return any(t.searched and size > LOUD for t, size in zip(fit.trials, left, strict=True))


def _cost(fit: JointFit, counted: Array, plain: bool, temper: float) -> float:
    return fit.rss / temper + fit.penalty if plain and np.isfinite(fit.rss) else fit.cost(counted)


def best_step(
    fit: JointFit, counted: Array, rung: int, shared: bool, plain: bool, temper: float = 1.0
) -> tuple[JointFit, int]:
    """The lowest cost over dampings about the last one; a simulation costs a thirtieth of the slopes.

    Dampings are tried from a rung below the last one up until the cost rises again after it has fallen below where it
    was; where the lowest of them is the best, smaller ones too.
    """
    best, lowest = fit, _cost(fit, counted, plain, temper)
    first = chosen = max(rung - 1, 0)
    weights = np.full(len(counted), 1.0 / temper) if plain else counted / fit.parts
    curvature = Curvature.of(fit, weights, shared)
    ahead = AHEAD if all(trial.abreast for trial in fit.trials) else 1

    def tried(candidates: Sequence[int]) -> Iterator[tuple[int, JointFit]]:
        for begin in range(0, len(candidates), ahead):
            together = candidates[begin : begin + ahead]
            moves = curvature.steps([DAMPINGS[candidate] for candidate in together], shared)
            places = [
                (fit.point + move, [n + o for n, o in zip(fit.nuisances, own, strict=True)]) for move, own in moves
            ]
            yield from zip(together, evaluate_all(fit.trials, fit.model, places, fit.slopes), strict=True)

    def improves(candidate: int, trial: JointFit) -> bool:
        nonlocal best, chosen, lowest
        cost = _cost(trial, counted, plain, temper)
        if not cost < lowest:
            return False
        best, chosen, lowest = trial, candidate, cost
        return True

    for candidate, trial in tried(range(first, len(DAMPINGS))):
        if not improves(candidate, trial) and best is not fit:
            break
    if chosen == first:
        for candidate, trial in tried(range(first)[::-1]):
            if not improves(candidate, trial):
                break
    return best, chosen
