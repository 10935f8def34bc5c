"""The page of a diagnosis: what, where, how sure, how much better and what next on the first screen; then the rest."""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence
from pathlib import Path

from ssmr_ident.core.atomic import make_folder, write_text
from ssmr_ident.diagnose.deciding import NONE_LIKELY
from ssmr_ident.diagnose.diagnosis import MISSING, NOTHING, UNDETERMINED, UNIT, Diagnosis, NamedEffect
from ssmr_ident.report.diagnosis_charts import after_name, overlay_charts
from ssmr_ident.report.diagnosis_sections import quantity, sections, turning
from ssmr_ident.report.field_words import UNLISTED, effect_words, place_words
from ssmr_ident.report.field_words import sentence as said
from ssmr_ident.report.figures_diagnosis import readable
from ssmr_ident.report.html import Bar, Fact, Page, Verdict, file_hashes, render_page, write_page
from ssmr_ident.report.mathml import symbol, typeset
from ssmr_ident.report.numbers import alike, interval, measured, number, share

FIGURES = "figures"

NEAR = 1.6
"""Times the noise floor up to which an answer leaves nothing to look for."""


def write_report(diagnosis: Diagnosis, path: Path, command: str, seed: int, files: Sequence[Path]) -> Path:
    """Write the page and, in a folder ``figures`` beside it, each of its drawings as SVG.

    Parameters
    ----------
    diagnosis : Diagnosis
    path : Path
        Of the page.
    command : str
        The call that made it.
    seed : int
    files : sequence of Path
        What was read; printed with its SHA-256.
    """
    page = diagnosis_page(diagnosis, command, seed, file_hashes(files))
    drawings = [item for section in page.sections for figure in section.figures for item in figure.drawings]
    if drawings:
        make_folder(Path(path).parent / FIGURES)
    for item in drawings:
        write_text(Path(path).parent / FIGURES / f"{item.name}.svg", item.svg)
    return write_page(path, page)


def render_report(diagnosis: Diagnosis, command: str, seed: int, files: Sequence[Path] = ()) -> str:
    """The page as one HTML text."""
    return render_page(diagnosis_page(diagnosis, command, seed, file_hashes(files)))


def diagnosis_page(
    diagnosis: Diagnosis, command: str, seed: int | None = None, files: tuple[tuple[str, str], ...] = ()
) -> Page:
    """The page as a value.

    Parameters
    ----------
    diagnosis : Diagnosis
    command : str
    seed : int or None
    files : tuple of (str, str)
        Name and SHA-256.
    """
    spent = diagnosis.evidence.seconds
    remarks = (("Time", ", ".join(f"{name} {number(value, 2)} s" for name, value in spent.items())),) if spent else ()
    return Page(
        f"Diagnosis of {diagnosis.session}",
        (),
        sections(diagnosis),
        command,
        files,
        verdict=verdict(diagnosis),
        seed=seed,
        remarks=remarks,
    )


def verdict(diagnosis: Diagnosis) -> Verdict:
    """What stands first."""
    names = " and ".join(effect_words(effect) for effect in diagnosis.effects)
    if diagnosis.verdict == MISSING:
        label, tone = f"Missing: {names}", "found"
        sentence = " ".join(said(effect, diagnosis.before) for effect in diagnosis.effects)
    elif diagnosis.verdict == NOTHING:
        label, tone = "Nothing is missing", "clear"
        sentence = "What the model leaves over on recordings that it has not seen is noise."
    else:
        label, tone = "Undetermined: these recordings cannot name it", "open"
        sentence = "More than noise is left over, and no explanation stands clear of the others."
        if names:
            sentence = f"More than noise is left over. The likeliest explanation is {names}; it is not certain."
        elif diagnosis.tried and all(one.id == "baseline" for one in diagnosis.tried):
            sentence = diagnosis.summary  # nothing was tried beside it, and that says why
    facts = (_better(diagnosis), _where(diagnosis), _sure(diagnosis), _next(diagnosis))
    known = [e for e in diagnosis.effects if e.parameters or e.curve] if tone == "found" else []
    law = tuple(_law(effect, turning(diagnosis)) for effect in known)
    charts = overlay_charts(diagnosis)
    return Verdict(label, tone, sentence, facts, law, charts[0] if charts else None)


def _law(effect: NamedEffect, turns: bool) -> str:
    """The formula, and what was measured of it; three values at most, the table below holds all."""
    turns = turns and effect.kind != "sensor_chain"
    values = [
        f"<span>{symbol(quantity(effect.id, name), turns)} = {measured(float(e.value), e.std, e.unit)}</span>"
        for name, e in effect.acting.items()
        if isinstance(e.value, int | float) and e.std is not None
    ]
    return f'{typeset(effect.equation, turns)} &ensp;<span class="values">{", ".join(values[:3])}</span>'


def _better(diagnosis: Diagnosis) -> Fact:
    """Before, after and noise on recordings never fitted."""
    unit, after = UNIT[diagnosis.metric], after_name(diagnosis)
    held = not math.isnan(diagnosis.heldout.before)
    quality = diagnosis.heldout if held else diagnosis.training
    values = [quality.before, *([quality.after] if after else []), quality.noise_floor]
    largest = max(values)
    texts = alike(values) if largest < 100 * min(values) else [number(value) for value in values]
    names = (("before", "after", "noise") if after else ("model", "noise"), ("before", "after", "floor"))
    roles = names[1] if after else ("after", "floor")
    bars = tuple(
        Bar(name, f"{text} {unit}", value / largest if math.isfinite(value) and largest > 0 else 0.0, role)
        for name, text, value, role in zip(names[0], texts, values, roles, strict=True)
    )
    count = len(quality.recordings)
    on = f"{count} recording{'s' if count > 1 else ''} never fitted" if count else "recordings never fitted"
    label = f"Error on {on}" if held else "Error on the recordings that were fitted"
    better = interval(*quality.improvement) if after and quality.improvement else ""
    note = f"lower by {better} {'points' if unit == '%' else unit} (95 % interval)" if better else ""
    return Fact(label, f"{texts[0]} → {texts[1]} {unit}" if after else f"{texts[0]} {unit}", note, bars)


def _where(diagnosis: Diagnosis) -> Fact:
    if diagnosis.verdict == NOTHING:
        return Fact("Where", "Nowhere", "no recording, channel, time or band stands out of the noise")
    place = diagnosis.located[0] if diagnosis.located else None
    acting = [e.element for e in diagnosis.effects if e.element] or [k.element for k in diagnosis.kinds[:1]]
    elements = dict.fromkeys(place_words(element, diagnosis.after) for element in acting)
    if place is None:
        spread = "the misfit is spread over recordings and channels"
        return Fact("Where", _parts(elements), "") if elements else Fact("Where", "Not told", spread)
    most = f"{number(100 * place.share, 2)} % of the misfit"
    seen = f"{place.channel.replace('_', ' ')} of {place.recording}"
    when = place.region or (interval(*place.time_s, "s") if all(map(math.isfinite, place.time_s)) else "")
    after = f", {when}" if when else ""
    if elements:
        return Fact("Where", _parts(elements), f"{most}: {seen}{after}")
    return Fact("Where", seen, f"{most}{after}")


def _parts(elements: Iterable[str]) -> str:
    named = " and the ".join(elements)
    return f"The {named}"


def _sure(diagnosis: Diagnosis) -> Fact:
    tried = sum(t.id != "baseline" for t in diagnosis.tried)
    among = f"among {tried} explanations tried" if tried > 1 else "against nothing missing" if tried else ""
    ties = [readable(id) for e in diagnosis.effects for id in e.indistinguishable_from]
    if diagnosis.verdict == NOTHING:
        return Fact("How sure", f"None of {tried}", "explanations tried is borne out by the recordings")
    if diagnosis.verdict != MISSING:
        candidates = list(dict.fromkeys([*(readable(e.id) for e in diagnosis.effects), *ties]))
        if not candidates:
            return Fact("How sure", "No name", f"{among}, none is certain" if among else "none is certain")
        return Fact("How sure", f"{len(candidates)} candidates", ", ".join(candidates))
    least = min(diagnosis.effects, key=lambda e: e.confidence)
    if least.id == UNLISTED:
        gained = max((t.log_evidence for t in diagnosis.tried), default=0.0)
        something = share(1.0 / (1.0 + math.exp(-min(max(gained, 0.0), 700.0))))
        return Fact("How sure", something, "that something is missing; no listed law is its name")
    return Fact("How sure", share(least.confidence), f"fits as well: {', '.join(ties)}" if ties else among)


def _next(diagnosis: Diagnosis) -> Fact:
    """The advice of the diagnosis; where it has none, whether anything is left to look for."""
    if diagnosis.next_experiment:
        hopeless = diagnosis.next_experiment.startswith(NONE_LIKELY)
        return Fact("Record next", "Nothing decides" if hopeless else "One recording", diagnosis.next_experiment)
    quality = diagnosis.training if math.isnan(diagnosis.heldout.before) else diagnosis.heldout
    if diagnosis.verdict == UNDETERMINED:
        return Fact("Record next", "See below", "what limits this answer stands at the end of the page")
    left = quality.after if diagnosis.verdict == MISSING else quality.before
    if left <= NEAR * quality.noise_floor:
        return Fact("Record next", "Nothing more", "for motions of this size the model is complete: use after.yaml")
    over = f"{number(left / quality.noise_floor, 2)} times the noise is left" if quality.noise_floor > 0 else ""
    return Fact("Record next", "Nothing more", f"the name is settled; {over}, for its formula is not quite the world's")
