"""How much the recordings say for one explanation against another.

Two models are compared by how well each predicts every recording at its best, in n ln(RSS) with n independent samples,
by what each asks of the priors, and by how many parameters it has (Schwarz 1978). n is counted in the residual of the
best one: what the best explanation leaves behind is what all are measured by, so a difference smaller than its own
error decides nothing.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from ssmr_ident.diagnose.coloured import told_by
from ssmr_ident.identify.fitting.joint import JointFit
from ssmr_ident.physics.effects import CATALOGUE

UNLISTED = CATALOGUE["unlisted"]

TIE = math.log(20.0)
"""Difference in log evidence (odds of 20 to 1) up to which explanations count as alike."""

CERTAIN = math.log(1e3)
"""Log evidence that an effect needs over the baseline, beside Schwarz's penalty: with a dozen effects looked at, each
with two or three parameters, noise alone gets there in fewer than 1 of 1000 sessions:
docs/theory/robot_diagnosis.md."""


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


def log_evidence(explanation: Explanation, best: Explanation) -> float:
    """Up to a constant, in units of the best one's independent samples; kept recordings count as well.

    A state that recordings have under one explanation alone, as that of a mast at its release, takes half a unit by
    chance (Akaike 1974).
    """
    return from_recordings(explanation, best) - 0.5 * (asked(explanation) + _states(explanation))


def asked(explanation: Explanation) -> float:
    """Of the priors: squared deviations of the baseline's parameters from what is known of them, summed."""
    return _asked(explanation.fit)


def _asked(fit: JointFit) -> float:
    return float(np.sum(fit.point[: len(fit.model.physics)] ** 2))


def from_recordings(explanation: Explanation, best: Explanation) -> float:
    """Log evidence but for what the priors say."""
    return _from_samples(explanation, best.fit.counted, best.kept.counted)


def _from_samples(explanation: Explanation, counted: np.ndarray, further: np.ndarray) -> float:
    samples = float(counted.sum() + further.sum())
    told = float(counted @ np.log(explanation.fit.parts)) + float(further @ np.log(explanation.kept.parts))
    return -0.5 * (told + _parameters(explanation.fit) * math.log(samples)) - _choice(explanation.fit)


def _parameters(fit: JointFit) -> int:
    """Those of its effects; one that has none to fit counts as one."""
    own = {c.effect for c in fit.model.free}
    return len(fit.model.free) + sum(name not in own for name in fit.model.held)


def surplus(leader: Explanation, before: Explanation) -> float:
    """Log evidence of one explanation over another, noise being as coloured as what the first one leaves."""
    counted, further = told_by(leader.fit, before.fit), told_by(leader.kept, before.kept)
    told = _from_samples(leader, counted, further) - _from_samples(before, counted, further)
    return told - 0.5 * (asked(leader) - asked(before) + _states(leader) - _states(before))


def _choice(fit: JointFit) -> float:
    """Log of the number of laws that one of no list was chosen from, each as likely before."""
    if UNLISTED.id not in fit.model.ids:
        return 0.0
    return math.log(len(UNLISTED.probes) + (len(UNLISTED.rig_probes) if fit.model.on_rig else 0))


def all_fitted(one: JointFit, other: JointFit) -> float:
    """Log evidence of one fit over another of the same recordings, none of them kept back."""
    counted = one.counted
    told = (
        float(counted @ np.log(other.parts / one.parts)) - (_asked(one) - _asked(other)) - (one.states - other.states)
    )
    told -= (_parameters(one) - _parameters(other)) * math.log(float(counted.sum()))
    return 0.5 * told - (_choice(one) - _choice(other))


def _states(explanation: Explanation) -> int:
    return explanation.fit.states + explanation.kept.states


def evidences(explanations: Sequence[Explanation]) -> dict[str, float]:
    """Log evidence by id, the baseline's being 0."""
    best = min(explanations, key=lambda e: float(np.mean(np.log(e.fit.parts))))
    found = {e.id: log_evidence(e, best) for e in explanations}
    reference = found.get("baseline", min(found.values()))
    return {name: value - reference for name, value in found.items()}


def shares(found: Mapping[str, float]) -> dict[str, float]:
    """Posterior shares for equal prior odds."""
    top = max(found.values())
    weights = {name: math.exp(max(value - top, -700.0)) for name, value in found.items()}
    total = sum(weights.values())
    return {name: weight / total for name, weight in weights.items()}
