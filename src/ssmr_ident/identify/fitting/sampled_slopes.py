"""Slopes of a rough cost: a plane through the residuals of many points about a fit, in place of differences.

Which wheel lets go first makes kinks along every parameter alone, and at a kink a difference tells one side. A cloud of
points changes all parameters at once; the plane through what they leave averages kinks and chatter out.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from ssmr_ident.identify.fitting.descent import best_step, search_again
from ssmr_ident.identify.fitting.joint import BURST, JointFit, Slopes, over

Array = np.ndarray

WIDTHS = (0.06, 0.04, 0.02)
"""Standard deviations of the cloud, in those of what is known beforehand: one after the other."""

STEPS = 4
"""Steps at each width, as long as they gain."""

POINTS = 3
"""Points for each coordinate."""

SEED = 20120510


def averaged(fit: JointFit, width: float, random: np.random.Generator) -> JointFit:
    """A fit with the slopes of a plane through a cloud of points.

    Parameters
    ----------
    fit : JointFit
    width : float
        Standard deviation of the cloud, scaled coordinates; of a recording's own nuisances a tenth of that.
    random : Generator
    """
    names = [unknown.name for unknown in fit.model.unknowns]
    points = width * random.standard_normal((POINTS * len(names), len(names)))
    own = [0.1 * width * random.standard_normal((len(points), len(n))) for n in fit.nuisances]

    def one(index: int) -> Slopes:
        trial, nuisance = fit.trials[index], fit.nuisances[index]
        seen = np.array([trial.sees(name) for name in names])
        centre, rows, moves = trial.whitened(fit.simulated[index]), [], []
        moved = points * seen
        asked = [
            (*fit.model.split(fit.point + move), nuisance + aside)
            for move, aside in zip(moved, own[index], strict=True)
        ]
        for move, aside, white in zip(moved, own[index], trial.whitened(trial.runs(asked)).T, strict=True):
            change = white - centre
            if np.all(np.abs(change) < BURST):
                rows.append(change)
                moves.append(np.concatenate([[1.0], move[seen], aside]))
        shared, beside = np.zeros((len(centre), len(names))), np.zeros((len(centre), len(nuisance)))
        if len(rows) > seen.sum() + len(nuisance) + 1:
            plane = np.linalg.lstsq(np.array(moves), np.array(rows), rcond=None)[0]
            shared[:, seen] = plane[1 : 1 + seen.sum()].T
            beside = plane[1 + seen.sum() :].T
        return Slopes(shared, beside)

    return replace(fit, slopes=tuple(over(fit.trials, one)), exact=False)


def settled(fit: JointFit) -> JointFit:
    """A fit led on by clouds of less and less width, by plain squares."""
    random = np.random.default_rng(SEED)
    counted = fit.counted
    for width in WIDTHS:
        for _ in range(STEPS):
            before = search_again(fit)
            after, _ = best_step(averaged(before, width, random), counted, 0, True, plain=True)
            gain = before.rss + before.penalty - after.rss - after.penalty
            fit = after if gain > 0.0 else before
            if not gain > 0.01 * fit.rss:
                break
    return fit
