"""What stands below the verdict: one section per question that a reader asks."""

from __future__ import annotations

import math

from ssmr_ident.core.parameter import Estimate
from ssmr_ident.diagnose.diagnosis import MISSING, NOTHING, UNIT, Conflict, Diagnosis, NamedEffect, Worth
from ssmr_ident.report.diagnosis_pictures import after_name, explained, known_std, moved, proof
from ssmr_ident.report.diagnosis_places import places
from ssmr_ident.report.figures_diagnosis import readable
from ssmr_ident.report.html import Cell, Number, Section, Table
from ssmr_ident.report.numbers import NONE, alike, interval, measured, number
from ssmr_ident.report.numbers import unit as printed


def sections(diagnosis: Diagnosis) -> tuple[Section, ...]:
    """All sections that have something to say, in reading order."""
    made = (
        _effects(diagnosis),
        _proof(diagnosis),
        _where(diagnosis),
        _which(diagnosis),
        _moved(diagnosis),
        _next(diagnosis),
        Section("What limits this answer", diagnosis.notes),
    )
    return tuple(s for s in made if s.paragraphs or s.tables or s.figures)


def _effects(diagnosis: Diagnosis) -> Section:
    title = "What was left out" if diagnosis.verdict == MISSING else "What it could be"
    paragraphs: list[str] = []
    rows: list[tuple[Cell, ...]] = []
    for effect in diagnosis.effects:
        paragraphs.append(_described(effect))
        for name, estimate in effect.parameters.items():
            rows.append((readable(effect.id), name, *_estimated(estimate)))
    header = ("effect", "parameter", "value ± standard deviation", "95 % interval", "unit")
    caption = "Fitted parameters of the physics added; the interval is ±1.96 standard deviations."
    return Section(title, tuple(paragraphs), (Table(caption, header, tuple(rows)),) if rows else ())


def _described(effect: NamedEffect) -> str:
    text = f"{readable(effect.id).capitalize()}: {effect.sentence} Law: {effect.equation}."
    if effect.form:
        text += f" Formula that fits best: {effect.form}."
    text += f" Share of the probability among the explanations tried: {number(100 * effect.confidence)} %."
    if effect.indistinguishable_from:
        names = ", ".join(readable(id) for id in effect.indistinguishable_from)
        text += f" These recordings cannot tell it from: {names}."
    return text


def _estimated(estimate: Estimate) -> tuple[Cell, Cell, Cell]:
    unit = printed(estimate.unit) or NONE
    if not isinstance(estimate.value, int | float):
        return str(estimate.value), NONE, unit
    value, std = float(estimate.value), estimate.std
    if std is None:
        return Number(measured(value, None), value), Number(NONE, math.nan), unit
    text = measured(value, std) + (" (at its bound)" if estimate.at_bound else "")
    ends = interval(value - 1.96 * std, value + 1.96 * std)
    return Number(text, value), Number(ends, value - 1.96 * std), unit


def _proof(diagnosis: Diagnosis) -> Section:
    unit = UNIT[diagnosis.metric]
    measure = {
        "%": "The distance is the size of what is left over, in per cent of the size of the recording itself.",
        "dB": "The distance is the root mean square difference between the levels of two spectra, 1 to 50 Hz.",
    }[unit]
    rows = (_worth("fitted", diagnosis.training, unit), _worth("held out, never fitted", diagnosis.heldout, unit))
    header = (
        "recordings",
        f"before [{unit}]",
        f"after [{unit}]",
        f"noise alone [{unit}]",
        f"improvement, 95 % [{unit}]",
    )
    tables = [Table(f"{measure} Means over recordings.", header, rows)]  # fmt: skip
    single: dict[str, tuple[Cell, ...]] = {}
    for o in diagnosis.evidence.overlays:
        role = "held out" if o.heldout else "fitted"
        single[o.recording] = (o.recording, role, *_metrics(o.metric))
    if len(single) > 1:
        caption = "The same for each recording."
        header = ("recording", "role", f"before [{unit}]", f"after [{unit}]", f"noise alone [{unit}]")
        tables.append(Table(caption, header, tuple(single.values())))
    title = {
        MISSING: "Does it hold on recordings that were never fitted?",
        NOTHING: "Does the model hold on recordings that were never fitted?",
    }.get(diagnosis.verdict, "How far the model is from recordings that were never fitted")
    names = diagnosis.heldout.recordings
    text = (f"Kept back from the fit: {', '.join(names)}.",) if names else ()
    return Section(title, text, tuple(tables), proof(diagnosis))


def _worth(name: str, worth: Worth, unit: str) -> tuple[Cell, ...]:
    gain: Cell = Number(NONE, math.nan)
    if worth.improvement is not None:
        gain = Number(interval(*worth.improvement), worth.improvement[0])
    return (name, *_metrics((worth.before, worth.after, worth.noise_floor)), gain)


def _metrics(values: tuple[float, ...]) -> list[Number]:
    return [Number(text, value) for text, value in zip(alike(values), values, strict=True)]


def _where(diagnosis: Diagnosis) -> Section:
    rows: list[tuple[Cell, ...]] = []
    for place in diagnosis.located:
        rows.append(
            (
                place.recording,
                place.channel,
                Number(interval(*place.time_s), place.time_s[0]),
                Number(interval(*place.band_hz), place.band_hz[0]),
                place.region or NONE,
                Number(number(100 * place.share), place.share),
            )
        )
    header = ("recording", "channel", "time [s]", "band [Hz]", "where in the motion", "share of the misfit [%]")
    tables = (Table("Places in which the mismatch sits, largest first.", header, tuple(rows)),) if rows else ()
    sentences = tuple(place.sentence for place in diagnosis.located if place.sentence)
    quiet = diagnosis.verdict == NOTHING
    title = "Where a mismatch was looked for" if quiet else "Where the mismatch sits"
    if quiet and not sentences:
        sentences = ("No channel, time, band or state stands out of the noise.",) if diagnosis.evidence.maps else ()
    return Section(title, sentences, tables, places(diagnosis))


def _which(diagnosis: Diagnosis) -> Section:
    unit = UNIT[diagnosis.metric]
    distances = alike([t.heldout_metric for t in diagnosis.tried])
    rows = tuple(
        (readable(t.id), Number(number(t.log_evidence, 4), t.log_evidence), Number(text, t.heldout_metric))
        for t, text in zip(diagnosis.tried, distances, strict=True)
    )
    header = ("explanation", "log evidence above the baseline [–]", f"distance from held-out recordings [{unit}]")
    caption = "Every explanation that was fitted in full. Evidence: three more is twenty times likelier."
    tables = (Table(caption, header, rows),) if rows else ()
    return Section("Which explanations were tried", (), tables, explained(diagnosis))


def _moved(diagnosis: Diagnosis) -> Section:
    rows: list[tuple[Cell, ...]] = []
    for conflict in diagnosis.conflicts:
        row = (conflict.parameter, *_fitted(conflict, diagnosis), printed(conflict.unit) or NONE)
        rows.append((*row, Number(f"{conflict.sigmas:+.1f}".replace("-", "−"), conflict.sigmas)))
    header = ("parameter", "known", "model before", "with the physics added", "unit", "moved before [std]")
    caption = "Value ± standard deviation; moved: distance from what was known, in its standard deviations."
    title = (
        "What it had been hidden in" if diagnosis.verdict == MISSING else "Parameters against what was known of them"
    )
    tables = (Table(caption, header, tuple(rows)),) if rows else ()
    return Section(title, (), tables, moved(diagnosis))


def _fitted(conflict: Conflict, diagnosis: Diagnosis) -> tuple[Cell, Cell, Cell]:
    cells: list[Cell] = [Number(measured(conflict.prior, known_std(conflict)), conflict.prior)]
    before = diagnosis.before.get(conflict.parameter)
    cells.append(Number(measured(conflict.fitted, before.std if before else None), conflict.fitted))
    after = diagnosis.after.get(conflict.parameter)
    if after is None or not isinstance(after.value, int | float) or not after_name(diagnosis):
        cells.append(Number(NONE, math.nan))
    else:
        cells.append(Number(measured(float(after.value), after.std), float(after.value)))
    return cells[0], cells[1], cells[2]


def _next(diagnosis: Diagnosis) -> Section:
    return Section("What to record next", (diagnosis.next_experiment,) if diagnosis.next_experiment else ())
