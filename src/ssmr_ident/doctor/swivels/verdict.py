"""What the evidence allows to be said: nothing missing, this or that effect, something unlisted, or not to be told."""

from __future__ import annotations

from dataclasses import asdict, dataclass
from typing import Any

import numpy as np

from ssmr_ident.diagnose.diagnosis import MISSING, NOTHING, UNDETERMINED
from ssmr_ident.doctor.swivels.candidates import UNLISTED
from ssmr_ident.doctor.swivels.ensemble import TAU_DB
from ssmr_ident.doctor.swivels.grip import FOREIGN_DB
from ssmr_ident.doctor.swivels.outcome import Outcome

GAIN = (6.0, 12.0)
"""Evidence over the baseline that an explanation needs, with calibration recordings, and where none hold it."""
LEFT = 20.0
"""What the model's own error may add to the baseline's log likelihood where nothing is missing (docs/theory)."""
TIE, TIE_SHARE = 6.0, 0.05
"""Evidence within which explanations fit alike, and the share of the best one's: how many values of a spectrum are
independent where a model errs is a guess, and evidence is in proportion to it."""
MOST = 3  # that are named together
SHARE = 1.0 / 3.0
"""Of the misfit beyond chance that an explanation has to take away."""
TEMPER = 0.5
"""Of the evidence when it is turned into confidence: errors of the model go with each other from bin to bin."""
CLOSE = 100.0
"""Evidence from which on recordings kept back that show nothing of an effect do not speak against it."""
QUIET_DB = TAU_DB[0]  # own error, as simulations are off anyway


@dataclass(frozen=True)
class Finding:
    """One explanation: evidence over the baseline's, own error and rms residual [dB], and log likelihood over the
    baseline's of recordings kept back (0 without any)."""

    id: str
    gain: float
    tau_db: float
    rms_db: float
    held: float = 0.0

    @property
    def total(self) -> float:
        return self.gain + self.held

    @property
    def predicts(self) -> bool:
        """Whether recordings kept back speak for it, or show nothing and all others much."""
        return self.held > 0.0 or (self.held > -GAIN[0] and self.gain > CLOSE)


@dataclass(frozen=True)
class Findings:
    """What a decision rests on: numbers only."""

    calibrated: bool
    left: float
    tau_db: float
    rms_db: float
    chance_db: float
    tried: tuple[Finding, ...]
    held_tau_db: float | None = None

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
        Finding(
            one.id, float(one.evidence - base.evidence), float(one.target.tau_db), float(one.target.rms_db),
            one.held.log_likelihood - base.held.log_likelihood if one.held and base.held else 0.0,
        )
        for one in (*outcome.explanations, *outcome.screened)
    )  # fmt: skip
    return Findings(
        outcome.calibrated, float(base.target.left), float(base.target.tau_db), float(base.target.rms_db),
        float(base.target.chance_db), tried, None if base.held is None else base.held.tau_db,
    )  # fmt: skip


def decide(found: Findings) -> Decision:
    """Turn numbers into a verdict."""
    ranked = sorted(found.tried, key=lambda one: one.total, reverse=True)
    best = ranked[0] if ranked else None
    needed = GAIN[0] if found.calibrated else GAIN[1]
    something = found.calibrated and found.left > LEFT
    if best is None or (best.gain <= needed and not something):
        if not found.calibrated and found.tau_db > FOREIGN_DB:
            return Decision(UNDETERMINED, (), 0.0, "the baseline misses these spectra and no listed effect mends it")
        return Decision(NOTHING, (), 0.0, "")
    weights = np.exp(TEMPER * np.array([one.total - best.total for one in ranked]))
    confidence = float(weights[0] / (weights.sum() + np.exp(-TEMPER * max(best.total, 0.0))))
    before, after = found.rms_db**2 - found.chance_db**2, best.rms_db**2 - found.chance_db**2
    taken = 1.0 - np.sqrt(max(after, 0.0) / max(before, 1e-9))
    if taken < SHARE and something:
        return Decision(MISSING, (UNLISTED,), confidence, "no listed effect takes a third of the change away")
    if not found.calibrated and best.tau_db > FOREIGN_DB:
        return Decision(UNDETERMINED, (), confidence, "whatever is added, the model stays far from these spectra")
    if found.held_tau_db is not None and not best.predicts:
        verdict = NOTHING if found.held_tau_db <= QUIET_DB else UNDETERMINED
        return Decision(verdict, (), 0.0, "what fits best does not predict the recordings kept back any better")
    alike = [one.id for one in ranked if one.total > best.total - max(TIE, TIE_SHARE * best.total)]
    alike.sort(key=lambda name: name == UNLISTED)  # only where every listed effect falls behind
    named = tuple(alike[:MOST])
    return Decision(MISSING, named, confidence, "")
