"""Refits with an effect added, and effects taken out again."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from ssmr_ident.diagnose.scan import Suspect
from ssmr_ident.identify.coordinates import Model
from ssmr_ident.identify.joint import JointFit, Slopes, evaluate

Array = np.ndarray

SHRINKING = (1.0, 0.3, 0.1)
"""Shares of a suspect's start that are tried."""


def with_suspect(fit: JointFit, suspect: Suspect, share: float = 1.0) -> tuple[Model, Array]:
    """The model with a suspect's effect, and a point of it at a share of the suspect's amplitude."""
    at = {name: value * (share if name in suspect.grown else 1.0) for name, value in suspect.at.items()}
    model, begin = fit.model.with_effect(suspect.effect, at, suspect.sizes)
    held = {**model.held, suspect.effect: {**model.held[suspect.effect], **suspect.held}}
    return replace(model, held=held), np.concatenate([fit.point, begin])


def begin_with(fit: JointFit, suspect: Suspect) -> tuple[Model, Array]:
    """A suspect's start, as large as it can be simulated.

    Not where it fits best unrefitted: that is next to nothing, where the baseline's optimum holds the fit.
    """
    for share in SHRINKING:
        model, point = with_suspect(fit, suspect, share)
        if np.isfinite(evaluate(fit.trials, model, point, fit.nuisances).rss):
            break
    return model, point


def without(fit: JointFit, effect_id: str) -> JointFit:
    """The same point with one effect taken out."""
    model, keep = fit.model.without_effect(effect_id)
    slopes = tuple(Slopes(s.shared[:, keep], s.own) for s in fit.slopes)
    return evaluate(fit.trials, model, fit.point[keep], fit.nuisances, slopes)
