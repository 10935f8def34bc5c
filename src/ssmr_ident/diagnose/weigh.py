"""Explanations, and how much recordings say for one against another."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from ssmr_ident.identify.fitting.joint import JointFit

CERTAIN = math.log(1e3)
"""Log evidence that an effect needs over the baseline, beside Schwarz's penalty: with a dozen effects looked at, each
with two or three parameters, noise alone gets there in fewer than 1 of 1000 sessions."""


@dataclass(frozen=True, eq=False)
class Explanation:
    """A model fitted to the targets and followed on what was kept back.

    Parameters
    ----------
    fit, kept : JointFit
    errors : (r,) float
        Per kept recording, whitened residual sum of squares over its samples.
    """

    fit: JointFit
    kept: JointFit

    @property
    def id(self) -> str:
        return "+".join(self.fit.model.ids) or "baseline"

    @property
    def errors(self) -> np.ndarray:
        return np.array([float(r @ r) / t.size for r, t in zip(self.kept.residuals, self.kept.trials, strict=True)])

    @property
    def heldout(self) -> float:
        """Whitened variance on what was kept back."""
        return self.kept.rss / self.kept.size


def from_recordings(explanation: Explanation, best: Explanation) -> float:
    """Log evidence but for what the priors say."""
    return _from_samples(explanation, best.fit.counted, best.kept.counted)


def _from_samples(explanation: Explanation, counted: np.ndarray, further: np.ndarray) -> float:
    samples = float(counted.sum() + further.sum())
    told = float(counted @ np.log(explanation.fit.parts)) + float(further @ np.log(explanation.kept.parts))
    return -0.5 * (told + _parameters(explanation.fit) * math.log(samples))


def _parameters(fit: JointFit) -> int:
    """Those of its effects; one that has none to fit counts as one."""
    own = {c.effect for c in fit.model.free}
    return len(fit.model.free) + sum(name not in own for name in fit.model.held)
