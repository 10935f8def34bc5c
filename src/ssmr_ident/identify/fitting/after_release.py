"""Pulls fitted over growing parts of a slide, from the moment at which the robot lets go.

A robot that slides swings on its tires, and constant friction does not damp that. Over a long slide a swing that is a
period off fits better than one a quarter off, as in a decay: the cost has a valley for every period, and kinks beside.
Over the first few swings there is but one valley; what is found there is near enough for twice as many, and so on.
Which parameters set the beat does not matter: most of them do, a little each.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from ssmr_ident.identify.fitting.descent import descend
from ssmr_ident.identify.fitting.joint import JointFit, evaluate
from ssmr_ident.identify.trials.trial import Trial

SHARES = (1 / 32, 1 / 16, 1 / 8, 1 / 4, 1 / 2)
"""Of the time for which a robot slides, one after the other: a slide of 30 periods begins with one of them."""

STEPS, LAST = 3, 6
"""Gauss-Newton steps on each, and on the whole."""


def first_part(trial: Trial, share: float) -> Trial:
    """A pull of which what comes after a share of its slide does not count; others as they are."""
    if trial.slides_from is None:
        return trial
    first, last = trial.slides_from, float(trial.times[-1])
    inside = (trial.times <= first + share * (last - first))[:, None]
    return replace(trial, counts=inside if trial.counts is None else trial.counts & inside)


def fit_past_release(fit: JointFit) -> JointFit:
    """A fit over longer and longer parts of its slides by plain squares, then over all.

    Parameters
    ----------
    fit : JointFit
        Where to begin.
    """
    if all(trial.slides_from is None for trial in fit.trials):
        return fit
    point, own = fit.point, fit.nuisances
    for share in SHARES:
        begun = evaluate([first_part(trial, share) for trial in fit.trials], fit.model, point, own)
        if not np.isfinite(begun.rss):
            return fit
        part = descend(begun, STEPS, plain=True)
        point, own = part.point, part.nuisances
    return descend(evaluate(fit.trials, fit.model, point, own), LAST, plain=True)
