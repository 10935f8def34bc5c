"""Figures of a diagnosis with captions that need no special knowledge: proof, explanations, parameters moved."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from ssmr_ident.core.parameter import Estimate, ParameterSet
from ssmr_ident.diagnose.diagnosis import MISSING, NOTHING, UNIT, Conflict, Diagnosis
from ssmr_ident.diagnose.evidence import Overlay
from ssmr_ident.report.figures_diagnosis import (
    evidence_panel,
    evidence_text,
    metric_panel,
    moved_panel,
    overlay_panel,
    readable,
)
from ssmr_ident.report.html import Picture, drawing
from ssmr_ident.report.numbers import number

SHOWN_OVERLAYS, SHOWN_TRIED, SHOWN_MOVED = 6, 10, 10
"""As many of each as a reader looks at; tables and diagnosis.yaml hold the rest."""


def after_name(diagnosis: Diagnosis) -> str:
    """What the model with physics added is called; empty where none was added."""
    if diagnosis.verdict == NOTHING or not diagnosis.effects:
        return ""
    return "with the physics added" if diagnosis.verdict == MISSING else "with the likeliest candidate"


def before_name(diagnosis: Diagnosis) -> str:
    """What the baseline at its best is called."""
    return "model before" if after_name(diagnosis) else "model"


def proof(diagnosis: Diagnosis) -> tuple[Picture, ...]:
    """Overlays on held-out recordings; on fitted ones where nothing was held out."""
    unit, after = UNIT[diagnosis.metric], after_name(diagnosis)
    held = [o for o in diagnosis.evidence.overlays if o.heldout]
    shown = _across_recordings(held or list(diagnosis.evidence.overlays))[:SHOWN_OVERLAYS]
    if not shown:
        return ()
    drawings = []
    for index, o in enumerate(shown, 1):
        first, second, floor = (f"{number(v)} {unit}" for v in o.metric)
        distance = f"{first} before, {second} {after}" if after else first
        alt = f"{o.recording}, {o.channel}: recorded and simulated over time; distance {distance}, noise alone {floor}."
        drawings.append(drawing(overlay_panel(o, after), alt, f"overlay-{index}"))
    caption = "These recordings were never used for fitting. " if held else "None was held out: these were fitted. "
    if after:
        caption += f"Grey: recorded. Orange: what the model said before. Blue: the same {after}. "
    else:
        caption += "Grey: recorded. Blue: what the model says. "
    caption += (
        "Below each, what is left over when the model is taken off the recording; a perfect model would leave only "
        f"noise. Of a long recording, the part that {'differs' if after else 'moves'} most is drawn."
    )
    return (Picture(tuple(drawings), caption, "Recorded and simulated"),)


def _across_recordings(overlays: Sequence[Overlay]) -> list[Overlay]:
    """The first channel of each recording, then the second of each, and so on."""
    seen: dict[str, int] = {}
    ranked = []
    for o in overlays:
        seen[o.recording] = seen.get(o.recording, 0) + 1
        ranked.append((seen[o.recording], o))
    return [o for _, o in sorted(ranked, key=lambda pair: pair[0])]


def explained(diagnosis: Diagnosis) -> tuple[Picture, ...]:
    """Evidence and held-out distance of the best explanations."""
    ranked = sorted(diagnosis.tried, key=lambda t: -t.log_evidence)
    shown = ranked[:SHOWN_TRIED] + [t for t in ranked[SHOWN_TRIED:] if t.id == "baseline"]
    if not shown:
        return ()
    answer = {e.id for e in diagnosis.effects} if after_name(diagnosis) else {"baseline"}
    chosen = next((t.id for t in shown if set(t.id.split("+")) == answer), "")
    tied = {id for e in diagnosis.effects for id in e.indistinguishable_from}
    best = ", ".join(f"{readable(t.id)} {evidence_text(t.log_evidence)}" for t in shown[:3])
    floor, unit = diagnosis.heldout.noise_floor, UNIT[diagnosis.metric]
    alt = f"Distance from held-out recordings for each explanation; noise alone gives {number(floor)} {unit}."
    drawings = (
        drawing(evidence_panel(shown, chosen, tied), f"Log evidence of the likeliest: {best}.", "evidence"),
        drawing(metric_panel(shown, chosen, tied, floor, unit), alt, "heldout-distance"),
    )
    caption = (
        "Each bar is a complete fit. First, the evidence: how much likelier the recordings are under this explanation "
        "than under the model as it was (0), with a price for every constant added; each 2.3 is a factor of ten. "
        "Second, the distance from recordings never fitted: shorter is better, and the dashed line is what noise "
        "alone would leave. Blue: the answer."
    )
    caption += " Light blue: explains the recordings as well." if tied else ""
    return (Picture(drawings, caption, "Explanations against each other"),)


def moved(diagnosis: Diagnosis) -> tuple[Picture, ...]:
    """Parameters that had been pulled away from what is known of them."""
    shown = sorted(diagnosis.conflicts, key=lambda c: -abs(c.sigmas))[:SHOWN_MOVED]
    if not shown:
        return ()
    after = after_name(diagnosis)
    back = [_sigmas_after(c, diagnosis) if after else None for c in shown]
    alt = "; ".join(f"{c.parameter} moved by {number(c.sigmas, 2)} standard deviations" for c in shown[:5])
    caption = (
        "How far the fit pulled each constant from what was known of it. Shaded: within two standard deviations, where "
        "fit and knowledge agree."
    )
    if after:
        caption += (
            " A long orange bar is a constant that stood in for missing physics; blue: where it comes to rest now."
        )
    return (Picture((drawing(moved_panel(shown, back, after), f"{alt}.", "moved"),), caption),)


def scalar(parameters: ParameterSet, name: str) -> Estimate | None:
    """What a set knows of a scalar, which may be a component of an array (``accelerometer.position_m.z``)."""
    estimate = parameters.get(name)
    if estimate is not None:
        return estimate if isinstance(estimate.value, int | float) else None
    whole, _, axis = name.rpartition(".")
    estimate = parameters.get(whole)
    if estimate is None or np.ndim(estimate.value) != 1 or axis not in ("x", "y", "z"):
        return None
    return replace(estimate, value=float(np.asarray(estimate.value)["xyz".index(axis)]))


def known_std(conflict: Conflict) -> float | None:
    """Standard deviation of what was known, from how far the fit moved."""
    return abs((conflict.fitted - conflict.prior) / conflict.sigmas) if conflict.sigmas else None


def _sigmas_after(conflict: Conflict, diagnosis: Diagnosis) -> float | None:
    estimate, std = scalar(diagnosis.after, conflict.parameter), known_std(conflict)
    return (float(estimate.value) - conflict.prior) / std if estimate is not None and std else None
