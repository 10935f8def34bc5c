"""The next experiment: which recording would tell apart explanations that fit alike, by simulating all of them.

Two explanations that predict whitened signals a distance d apart, once everything that the rival may still move is
taken out, are told apart by the likelihood ratio with an error of 5 % either way when √n·d ≥ 2·1.645 over n
recordings. Source: Cox and Hinkley, Theoretical Statistics (1974), section 4.2 (Neyman-Pearson, normal means).
"""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np
from scipy.stats import norm

from ssmr_ident.diagnose.experiments import Experiment, experiments
from ssmr_ident.diagnose.setup import Setup
from ssmr_ident.identify.fitting.joint import BURST, JointFit, differentiate, evaluate
from ssmr_ident.identify.fitting.scatter import covariance

Array = np.ndarray

POWER = 0.95
NEEDED = 2.0 * float(norm.ppf(POWER))
"""Distance in noise standard deviations at which one recording suffices."""

MARGIN = 1.5
"""Times the distance that is needed: the mildest experiment that has it is proposed."""

RIVALS = 2
HOPELESS = 100
"""Repeats that nobody makes."""


def next_experiment(setup: Setup, best: JointFit, rivals: Sequence[JointFit]) -> str:
    """What to record next, in one sentence with numbers; empty without rivals.

    Parameters
    ----------
    setup : Setup
    best : JointFit
        What is taken for true.
    rivals : sequence of JointFit
        Fits of other models to the same recordings; the first two are simulated.
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
    nearest = apart.min(axis=1)
    counts = [repeats(float(d) / MARGIN) for d in nearest]
    first = min(range(len(chosen)), key=lambda k: (counts[k], chosen[k].change))
    return _sentence(chosen[first], _name(best), [_name(rival) for rival in rivals], apart[first].tolist())


def _complete(fit: JointFit) -> bool:
    return bool(fit.slopes) and all(slopes.shared.shape[1] == len(fit.point) for slopes in fit.slopes)


def repeats(distance: float) -> int:
    """Recordings that tell two explanations apart with 95 % power.

    >>> repeats(9.0), repeats(1.0)
    (1, 11)
    """
    return max(1, math.ceil((NEEDED / max(distance, 1e-6)) ** 2))


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


def _sentence(experiment: Experiment, best: str, rivals: Sequence[str], distances: Sequence[float]) -> str:
    count = repeats(min(distances))
    differ = " and ".join(f"{name} by {d:.2g}" for name, d in zip(rivals, distances, strict=True))
    tell = "recording then tells" if count == 1 else "recordings then tell"
    ending = f"{count} {tell} them apart with {100 * POWER:.0f} % power"
    if count > HOPELESS:
        ending = f"that would take {count} recordings: a sensor with less noise is needed"
    return f"{experiment.words}: {best} differs there from {differ} noise standard deviations; {ending}."


def _name(fit: JointFit) -> str:
    return " with ".join(fit.model.ids) or "the baseline"
