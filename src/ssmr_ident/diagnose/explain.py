"""Refits with an effect added: first with the baseline's slopes as they were, then with all of them anew."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from ssmr_ident.diagnose.scan import Suspect
from ssmr_ident.identify.joint import JointFit, Slopes, descend, evaluate

Array = np.ndarray


@dataclass(frozen=True, eq=False)
class Explanation:
    """A model fitted to the recordings that are fitted."""

    fit: JointFit

    @property
    def ids(self) -> tuple[str, ...]:
        return self.fit.model.ids


def add(fit: JointFit, suspect: Suspect) -> JointFit:
    """The model with a suspect's effect, at its probe; nothing refitted yet."""
    model, begin = fit.model.with_effect(suspect.effect, suspect.at, suspect.sizes)
    held = {**model.held, suspect.effect: {**model.held[suspect.effect], **suspect.held}}
    model = replace(model, held=held)
    wide = tuple(
        Slopes(np.hstack([slopes.shared, np.zeros((len(slopes.shared), len(begin)))]), slopes.own)
        for slopes in fit.slopes
    )
    return evaluate(fit.trials, model, np.concatenate([fit.point, begin]), fit.nuisances, wide)


def refit(fit: JointFit, suspect: Suspect, independent: float, iterations: int) -> JointFit:
    """The model with a suspect's effect, refitted."""
    return descend(add(fit, suspect), iterations, "all", independent)


def without(fit: JointFit, effect_id: str) -> JointFit:
    """The same point with one effect taken out."""
    model, keep = fit.model.without_effect(effect_id)
    slopes = tuple(Slopes(s.shared[:, keep], s.own) for s in fit.slopes)
    return evaluate(fit.trials, model, fit.point[keep], fit.nuisances, slopes)
