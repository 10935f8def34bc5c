"""What a diagnosis says: verdict, what was left out, how sure, and what it is worth on recordings never fitted."""

from __future__ import annotations

import math
import textwrap
from collections.abc import Mapping
from dataclasses import asdict, dataclass, field, replace
from typing import TYPE_CHECKING, Any

from ssmr_ident.core.frame import frame
from ssmr_ident.core.parameter import Estimate, ParameterSet
from ssmr_ident.core.shown import Shown
from ssmr_ident.diagnose.evidence import Evidence

if TYPE_CHECKING:
    import pandas as pd

SCHEMA = "ssmr-ident/diagnosis/1"
MISSING, NOTHING, UNDETERMINED = "missing_physics", "nothing_missing", "undetermined"
WIDTH = 110
"""Letters in a line of the printed diagnosis."""
UNIT = {"nrmse_percent": "%", "log_psd_db": "dB"}


@dataclass(frozen=True)
class Located:
    """Where the misfit sits, one place.

    Parameters
    ----------
    recording, channel : str
    time_s, band_hz : (float, float)
        The recording's own time.
    region : str
        Of the state space, as a condition (``|s| > 1.2 mm``); empty where none orders the residual.
    share : float
        Of the session's misfit, 0 … 1.
    sentence : str
        The same in words, with numbers.
    """

    recording: str
    channel: str
    time_s: tuple[float, float]
    band_hz: tuple[float, float]
    region: str
    share: float
    sentence: str = ""


@dataclass(frozen=True)
class Conflict:
    """A parameter that a fit pulls away from what is known of it; ``sigmas`` is signed."""

    parameter: str
    prior: float
    fitted: float
    sigmas: float
    unit: str = ""


@dataclass(frozen=True)
class NamedEffect:
    """Physics that was left out.

    Parameters
    ----------
    id : str
        Of the catalogue, or ``unlisted``.
    sentence, equation : str
        What it does, for a reader who is no specialist; the law with its formula (plain text).
    parameters : mapping of str to Estimate
    confidence : float
        Posterior share among the explanations tried, 0 … 1.
    indistinguishable_from : tuple of str
        Ids that fit this data as well.
    form : str
        Which formula of this physics fits best, where more than one was tried.
    kind, element : str
        Of the seven kinds, and where it acts; empty where that was not asked.
    curve : mapping or None
        ``variable``, ``points``, ``force``, ``std`` of a force whose shape is drawn.
    """

    id: str
    sentence: str
    equation: str
    parameters: Mapping[str, Estimate]
    confidence: float
    indistinguishable_from: tuple[str, ...] = ()
    form: str = ""
    kind: str = ""
    element: str = ""
    curve: Mapping[str, Any] | None = None

    @property
    def acting(self) -> dict[str, Estimate]:
        """Its parameters without terms set to zero, and without what the recordings were not asked for."""
        return {n: e for n, e in self.parameters.items() if e.std is not None or not (e.fixed or e.value == 0)}


@dataclass(frozen=True)
class KindShare:
    """What a kind of physics takes of the misfit at its best, alone: answered also where no law is.

    ``share`` is of the misfit in squares, 0 … 1; ``log_evidence`` is natural, the baseline's being 0.
    """

    kind: str
    element: str
    share: float
    log_evidence: float


@dataclass(frozen=True)
class Tried:
    """An explanation (ids joined by ``+``; ``baseline`` for none) and how it fared.

    ``heldout_metric`` is in the unit of the fit's metric; ``log_evidence`` is natural, the baseline's being 0; ``name``
    has formulas and places, where there are several of one id.
    """

    id: str
    heldout_metric: float
    log_evidence: float
    name: str = ""


@dataclass(frozen=True)
class PredictionQuality:
    """Mean of the metric over recordings: of the baseline, with the effects added, and what noise alone leaves.

    ``improvement`` is the 95 % interval of before − after over recordings.
    """

    before: float
    after: float
    noise_floor: float
    recordings: tuple[str, ...] = ()
    improvement: tuple[float, float] | None = None


@dataclass(frozen=True, eq=False)
class Diagnosis(Shown):
    """The answer of ``ident diagnose``.

    Parameters
    ----------
    session, verdict : str
    located, conflicts, effects, tried : tuples
        Most important first.
    metric : str
        ``nrmse_percent`` or ``log_psd_db``.
    training, heldout : PredictionQuality
    next_experiment : str
        What to record next, empty where nothing is left to tell apart.
    before, after : ParameterSet
        The baseline at its best, and with the effects (equal where nothing is missing).
    summary : str
        The verdict in one sentence.
    notes : tuple of str
        What limits the answer, in sentences: recordings kept back, clipped channels, weak spots.
    evidence : Evidence
        What the figures are drawn from.
    kinds : tuple of KindShare
        Largest first; empty where that was not asked, or nothing is missing.
    """

    session: str
    verdict: str
    located: tuple[Located, ...]
    conflicts: tuple[Conflict, ...]
    effects: tuple[NamedEffect, ...]
    tried: tuple[Tried, ...]
    metric: str
    training: PredictionQuality
    heldout: PredictionQuality
    next_experiment: str
    before: ParameterSet
    after: ParameterSet
    summary: str
    notes: tuple[str, ...] = ()
    evidence: Evidence = field(default_factory=Evidence)
    kinds: tuple[KindShare, ...] = ()

    def to_frame(self) -> pd.DataFrame:
        """A row an explanation that was tried, the baseline among them: ``id``, ``named`` (part of the answer),
        ``confidence`` (NaN where it is not), ``log_evidence`` and ``heldout_metric`` as in ``Tried``.

        The numbers that the answer comes to are ``after.to_frame()``.
        """
        sure = {effect.id: effect.confidence for effect in self.effects}
        rows = [
            {"id": t.id, "named": set(t.id.split("+")) <= sure.keys(), "confidence": sure.get(t.id, math.nan),
             "log_evidence": t.log_evidence, "heldout_metric": t.heldout_metric}
            for t in self.tried
        ]  # fmt: skip
        columns = ("id", "named", "confidence", "log_evidence", "heldout_metric")
        return frame(rows, columns, session=self.session, verdict=self.verdict, metric=self.metric)

    def as_dict(self) -> dict[str, Any]:
        """The contract's diagnosis.yaml; key order is the file's."""
        return {
            "schema": SCHEMA,
            "session": self.session,
            "verdict": self.verdict,
            "summary": self.summary,
            **({"kinds": [asdict(kind) for kind in self.kinds]} if self.kinds else {}),
            "located": [
                {"recording": p.recording, "channel": p.channel, "time_s": [float(t) for t in p.time_s],
                 "band_hz": [float(f) for f in p.band_hz], "region": p.region, "share_of_misfit": float(p.share),
                 "sentence": p.sentence}
                for p in self.located
            ],
            "parameters_in_conflict": [
                {"parameter": c.parameter, "prior": c.prior, "fitted": c.fitted, "sigmas": c.sigmas, "unit": c.unit}
                for c in self.conflicts
            ],
            "effects": [
                {"id": e.id, **_placed(e), "sentence": e.sentence, "equation": e.equation, "form": e.form,
                 "parameters": {name: _plain(estimate) for name, estimate in e.parameters.items()},
                 "confidence": float(e.confidence), "indistinguishable_from": list(e.indistinguishable_from)}
                for e in self.effects
            ],
            "explanations_tried": [
                {"id": t.id, "heldout_metric": t.heldout_metric, "log_evidence": t.log_evidence} for t in self.tried
            ],
            "fit": {"metric": self.metric, "training": _worth(self.training), "heldout": _worth(self.heldout)},
            "next_experiment": self.next_experiment,
            "notes": list(self.notes),
        }  # fmt: skip

    def without_evidence(self) -> Diagnosis:
        """For keeping many of them."""
        return replace(self, evidence=Evidence())

    def __str__(self) -> str:
        unit = UNIT[self.metric]
        lines = [f"{self.session}: {self.verdict.replace('_', ' ')}", f"  {self.summary}"]
        for effect in self.effects:
            tie = f"; fits as well: {', '.join(effect.indistinguishable_from)}" if effect.indistinguishable_from else ""
            lines.append(f"  {effect.id}  (confidence {effect.confidence:.2f}{tie})  {effect.equation}".rstrip())
            lines += [f"      {name} = {estimate}" for name, estimate in effect.acting.items()]
        for name, worth in (("fitted", self.training), ("held out", self.heldout)):
            if math.isnan(worth.before):
                continue  # nothing could be kept back, which a note says
            lines.append(
                f"  {name:<9} before {worth.before:.3g} {unit}, after {worth.after:.3g} {unit}, "
                f"noise floor {worth.noise_floor:.3g} {unit}"
            )
        for kind in self.kinds[:3]:
            name = kind.kind.replace("_", " ")
            lines.append(f"  kind: {name} at {kind.element} takes {100 * kind.share:.0f} % of the misfit")
        lines += [f"  where: {place.sentence}" for place in self.located[:3] if place.sentence]
        for c in self.conflicts[:5]:
            lines.append(f"  moved: {c.parameter} {c.prior:.4g} -> {c.fitted:.4g} {c.unit} ({c.sigmas:+.1f} std)")
        lines += [f"  note: {note}" for note in self.notes]
        if self.next_experiment:
            lines.append(f"  next: {self.next_experiment}")
        return "\n".join(part for line in lines for part in _folded(line))


def _folded(line: str) -> list[str]:
    """A line of at most ``WIDTH`` letters, and what goes on below it."""
    indent = len(line) - len(line.lstrip())
    return textwrap.wrap(line, WIDTH, subsequent_indent=" " * (indent + 4), break_long_words=False) or [line]


def _placed(effect: NamedEffect) -> dict[str, Any]:
    found = {"kind": effect.kind, "element": effect.element, "curve": effect.curve}
    return {name: value for name, value in found.items() if value}


def _worth(worth: PredictionQuality) -> dict[str, Any]:
    if math.isnan(worth.before):
        return {"before": None, "after": None, "noise_floor": None}
    plain: dict[str, Any] = {"before": worth.before, "after": worth.after, "noise_floor": worth.noise_floor}
    if worth.recordings:
        plain["recordings"] = list(worth.recordings)
    if worth.improvement is not None:
        plain["improvement_95"] = list(worth.improvement)
    return plain


def _plain(estimate: Estimate) -> dict[str, Any]:
    return {"value": float(estimate.value), "std": estimate.std, "unit": estimate.unit}
