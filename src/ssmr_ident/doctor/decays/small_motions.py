"""What the ends of decays say of a robot: small motions are linear, whatever laws the large ones follow."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from ssmr_ident.doctor.decays.linear import LinearFit, fit_linear
from ssmr_ident.doctor.decays.recordings import Decay
from ssmr_ident.doctor.robots.cooled import TRUSTED
from ssmr_ident.doctor.rules import MORE_OVER
from ssmr_ident.identify.fitting.coordinates import Model
from ssmr_ident.physics.extended import LINEAR

Array = np.ndarray

ENDS = 0.1, 0.2, 0.4, 0.6
"""Shares of the shortest recording from which on it is looked at."""

FAR = 3.0
"""Standard deviations of what is known beyond which a fit is not the robot: what friction leaves of a motion as it
ends, a linear model follows by leaving all that is known."""


def annealed(decays: Sequence[Decay], model: Model) -> LinearFit | None:
    """The baseline from what is known: all that this leaves of the recordings counts as noise at first, then ever less,
    or the robot would leave what is known to follow what no robot does."""
    fit = fit_linear(decays, model, np.zeros(len(model.unknowns)), 0)
    temper = 0.0 if fit is None else fit.chi2 / sum(d.trial.size for d in decays)
    while fit is not None and temper > 1.0:
        fit = fit_linear(decays, model, fit.point, temper=temper)
        temper *= TRUSTED
    return None if fit is None else fit_linear(decays, model, fit.point)


def small_motions(decays: Sequence[Decay], model: Model) -> Array | None:
    """A linear model where the recordings' ends say it is, when motions have become so small that it leaves noise
    alone and is the robot that is known; None where it never is."""
    if not set(model.held) <= set(LINEAR):
        return None
    shortest = min(float(d.times[-1]) for d in decays)
    for share in ENDS:
        ends = [d.later(share * shortest) for d in decays]
        fit = annealed(ends, model)
        follows = fit is not None and fit.chi2 < MORE_OVER**2 * sum(d.trial.size for d in ends)
        if fit is not None and follows and np.abs(fit.point[: len(model.physics)]).max() < FAR:
            return fit.point
    return None
