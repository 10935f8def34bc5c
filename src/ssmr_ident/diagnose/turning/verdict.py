"""What the evidence allows to be said: nothing missing, this or that effect, something unlisted, or not to be told."""

from __future__ import annotations

from dataclasses import asdict, dataclass
from typing import Any

import numpy as np

from ssmr_ident.diagnose.diagnosis import MISSING, NOTHING, UNDETERMINED
from ssmr_ident.diagnose.turning.candidates import UNLISTED
from ssmr_ident.diagnose.turning.engine import GAIN_LOOSE, LEFT, Outcome
from ssmr_ident.diagnose.turning.grip import FOREIGN_DB

GAIN = (6.0, GAIN_LOOSE)
"""Evidence over the baseline that an explanation needs, with and without calibration recordings."""
TIE, TIE_SHARE = 6.0, 0.05
"""Evidence within which explanations fit alike, and the share of the best one's: how many values of a spectrum are
independent where a model errs is a guess, and evidence is in proportion to it."""
MOST = 3  # that are named together
SHARE = 1.0 / 3.0
"""Of the misfit beyond chance that an explanation has to take away."""
TEMPER = 0.5
"""Of the evidence when it is turned into confidence: errors of the model go with each other from bin to bin."""


@dataclass(frozen=True)
class Finding:
    """One explanation: evidence over the baseline's, own error and rms residual [dB], and whether it was followed."""

    id: str
    gain: float
    tau_db: float
    rms_db: float


@dataclass(frozen=True)
class Findings:
    """What a decision rests on: numbers only."""

    calibrated: bool
    left: float
    tau_db: float
    rms_db: float
    chance_db: float
    tried: tuple[Finding, ...]

    def as_dict(self) -> dict[str, Any]:
        return asdict(self)

    @classmethod
    def from_dict(cls, content: dict[str, Any]) -> Findings:
        return cls(**{**content, "tried": tuple(Finding(**one) for one in content["tried"])})


@dataclass(frozen=True)
class Decision:
    """Verdict, names (best first, ties behind it), and the best one's confidence."""

    verdict: str
    named: tuple[str, ...]
    confidence: float
    reason: str


def findings_of(outcome: Outcome) -> Findings:
    base = outcome.baseline
    tried = tuple(
        Finding(one.id, float(one.evidence - base.evidence), float(one.target.tau_db), float(one.target.rms_db))
        for one in (*outcome.explanations, *outcome.screened)
    )
    return Findings(
        outcome.calibrated, float(base.target.left), float(base.target.tau_db), float(base.target.rms_db),
        float(base.target.chance_db), tried,
    )  # fmt: skip


def decide(found: Findings) -> Decision:
    """Turn numbers into a verdict."""
    ranked = sorted(found.tried, key=lambda one: one.gain, reverse=True)
    best = ranked[0] if ranked else None
    needed = GAIN[0] if found.calibrated else GAIN[1]
    something = found.calibrated and found.left > LEFT
    if best is None or (best.gain <= needed and not something):
        if not found.calibrated and found.tau_db > FOREIGN_DB:
            return Decision(UNDETERMINED, (), 0.0, "the baseline misses these spectra and no listed effect mends it")
        return Decision(NOTHING, (), 0.0, "")
    weights = np.exp(TEMPER * np.array([min(one.gain - best.gain, 0.0) for one in ranked]))
    confidence = float(weights[0] / (weights.sum() + np.exp(-TEMPER * max(best.gain, 0.0))))
    before, after = found.rms_db**2 - found.chance_db**2, best.rms_db**2 - found.chance_db**2
    taken = 1.0 - np.sqrt(max(after, 0.0) / max(before, 1e-9))
    if taken < SHARE and something:
        return Decision(MISSING, (UNLISTED,), confidence, "no listed effect takes a third of the change away")
    if not found.calibrated and best.tau_db > FOREIGN_DB:
        return Decision(UNDETERMINED, (), confidence, "whatever is added, the model stays far from these spectra")
    alike = [one.id for one in ranked if one.gain > best.gain - max(TIE, TIE_SHARE * best.gain)]
    alike.sort(key=lambda name: name == UNLISTED)  # only where every listed effect falls behind
    named = tuple(alike[:MOST])
    return Decision(MISSING, named, confidence, "")
