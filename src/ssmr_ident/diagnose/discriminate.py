"""The next experiment: which recording would tell apart explanations that fit alike, by simulating all of them."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from ssmr_ident.diagnose.deciding import advice, best_of, chance_of_deciding
from ssmr_ident.diagnose.experiments import Experiment, experiments
from ssmr_ident.diagnose.setup import Setup
from ssmr_ident.diagnose.words import readable
from ssmr_ident.identify.fitting.joint import BURST, JointFit, differentiate, evaluate
from ssmr_ident.identify.fitting.scatter import covariance

Array = np.ndarray

RIVALS = 2
"""That are simulated."""


def next_experiment(
    setup: Setup, best: JointFit, rivals: Sequence[JointFit], evidence: Sequence[float] = (0.0, 0.0, 0.0)
) -> str:
    """What to record next, in one sentence with the chance that it decides; empty without rivals.

    Parameters
    ----------
    setup : Setup
    best : JointFit
        What is taken for true.
    rivals : sequence of JointFit
        Fits of other models to the same recordings; the first two are simulated.
    evidence : sequence of float
        Log evidence of the best and of the rivals so far.
    """
    rivals = [rival if _complete(rival) else differentiate(rival) for rival in rivals[:RIVALS]]
    if not rivals:
        return ""
    choices = experiments(setup, best)
    # min() would pass over a simulation that fails
    rough = [float(np.min([_differ(one, best, rival) for rival in rivals])) for one in choices]
    if not np.any(np.isfinite(rough)):
        return ""
    kind = choices[int(np.nanargmax(rough))].index
    # slopes are worked out anew for the variants of one recording alone, the one that shows most
    chosen = [one for one, far in zip(choices, rough, strict=True) if one.index == kind and np.isfinite(far)]
    apart = np.column_stack([_apart(chosen, best, rival) for rival in rivals])
    known = np.array(evidence[: 1 + len(rivals)])
    chances = np.array([chance_of_deciding(known, _both_ways(row)) for row in apart])
    first = best_of(chances, np.array([one.change for one in chosen]))
    names = (_name(best), *(_name(rival) for rival in rivals))
    return advice(chosen[first].words, names, float(chances[first]))


def _both_ways(distances: Array) -> Array:
    """Between the best and each rival either way; two rivals are at least as near as the nearer one is to the best."""
    every = np.append(np.inf, distances)
    return np.minimum(every[:, None], every[None, :])


def _complete(fit: JointFit) -> bool:
    return bool(fit.slopes) and all(slopes.shared.shape[1] == len(fit.point) for slopes in fit.slopes)


def _differ(experiment: Experiment, best: JointFit, rival: JointFit) -> float:
    """Distance of two predictions, each with its own start as it would grow; nan where one fails."""
    rest = _difference(experiment, best, rival)
    return float(np.sqrt(best.independent / best.rss * (rest @ rest)))


def _difference(experiment: Experiment, best: JointFit, rival: JointFit) -> Array:
    trial = experiment.trial
    first, second = (
        trial.whitened(trial.run(*fit.model.split(fit.point), experiment.growth * fit.nuisances[experiment.index]))
        for fit in (best, rival)
    )
    difference = first - second
    # an integration that has burst predicts nothing, and its square would overflow
    return difference if np.all(np.abs(difference) < BURST) else np.full_like(difference, np.nan)


def _apart(chosen: Sequence[Experiment], best: JointFit, rival: JointFit) -> list[float]:
    """Distances in noise standard deviations that a rival cannot make up within what is known of it."""
    weight = best.independent / best.rss
    nuisances = [one.growth * rival.nuisances[one.index] for one in chosen]
    ahead = differentiate(evaluate([one.trial for one in chosen], rival.model, rival.point, nuisances))
    known = _precision(covariance(rival))
    found = []
    for experiment, slopes in zip(chosen, ahead.slopes, strict=True):
        difference = _difference(experiment, best, rival)
        columns = np.hstack([slopes.shared, slopes.own])
        # parameters stay within what the recordings left open of them; a new recording's start is open
        held = np.eye(columns.shape[1])
        held[: len(known), : len(known)] = known
        move = np.linalg.solve(weight * columns.T @ columns + held, weight * columns.T @ difference)
        rest = difference - columns @ move
        found.append(float(np.sqrt(weight * (rest @ rest) + move @ held @ move)))
    return found


def _precision(covariance: Array) -> Array:
    """Inverse of a covariance, (p, p), which rounding must not make negative along what is hardly known.

    >>> off = _precision(np.array([[1.0, 1.0], [1.0, 1.0 - 1e-15]]))
    >>> bool(np.array([1.0, -1.0]) @ off @ np.array([1.0, -1.0]) > 0.0)
    True
    """
    size, along = np.linalg.eigh(covariance)
    return (along / np.maximum(size, np.finfo(float).eps * size[-1])) @ along.T


def _name(fit: JointFit) -> str:
    return " with ".join(map(readable, fit.model.ids)) or "no further physics"
