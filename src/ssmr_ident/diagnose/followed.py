"""Fits beside what they predict of the recordings that were kept back."""

from __future__ import annotations

from collections.abc import Sequence

from ssmr_ident.compare.recorded import follow
from ssmr_ident.diagnose.weigh import Explanation
from ssmr_ident.identify.fitting.descent import descend
from ssmr_ident.identify.fitting.joint import JointFit, evaluate
from ssmr_ident.identify.trials import Trial

FURTHER = 3
"""Gauss-Newton steps once recordings that were kept back are fitted as well."""


def explained(kept: Sequence[Trial], fit: JointFit, near: JointFit | None = None) -> Explanation:
    """A fit beside what it predicts of the recordings that were kept back.

    ``near`` is another model's prediction of them, whose nuisances are a start as well.
    """
    return Explanation(fit, follow(kept, fit.model, fit.point, None if near is None else near.nuisances, fit))


def on_all(explanation: Explanation) -> JointFit:
    """A model on what was fitted and on what was kept back, all of it fitted."""
    fit, kept = explanation.fit, explanation.kept
    whole = evaluate((*fit.trials, *kept.trials), fit.model, fit.point, (*fit.nuisances, *kept.nuisances))
    return descend(whole, FURTHER)
