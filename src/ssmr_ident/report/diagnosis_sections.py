"""What stands below the verdict: one section per question that a reader asks."""

from __future__ import annotations

import math
from collections.abc import Sequence

from ssmr_ident.core.parameter import Estimate
from ssmr_ident.diagnose.diagnosis import MISSING, NOTHING, UNIT, Conflict, Diagnosis, NamedEffect, PredictionQuality
from ssmr_ident.report.diagnosis_pictures import after_name, explained, known_std, moved, proof, scalar
from ssmr_ident.report.diagnosis_places import places
from ssmr_ident.report.figures_diagnosis import evidence_text, readable
from ssmr_ident.report.html import Cell, Number, Section, Table
from ssmr_ident.report.numbers import NONE, alike, interval, measured, number, share
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
        Section("What limits this answer", points=diagnosis.notes),
    )
    return tuple(s for s in made if s.paragraphs or s.points or s.tables or s.figures)


def _effects(diagnosis: Diagnosis) -> Section:
    title = "What was left out" if diagnosis.verdict == MISSING else "What it could be"
    paragraphs: list[str] = []
    rows: list[tuple[Cell, ...]] = []
    for effect in diagnosis.effects:
        paragraphs.append(_described(effect))
        for name, estimate in needed(effect).items():
            rows.append((readable(effect.id), name, *_estimated(estimate)))
    header = ("effect", "parameter", "value ± std", "95 % interval", "unit")
    caption = (
        "Fitted parameters of the physics added, ± their standard deviation; the interval is ±1.96 standard deviations."
    )
    if any(len(needed(effect)) < len(effect.parameters) for effect in diagnosis.effects):
        caption += " Terms that the recordings do not need are zero and not listed."
    if any(estimate.std is None for effect in diagnosis.effects for estimate in needed(effect).values()):
        caption += " None stands where the fit leaves structure behind, so that one would promise too much."
    return Section(title, tuple(paragraphs), (Table(caption, header, tuple(rows)),) if rows else ())


def needed(effect: NamedEffect) -> dict[str, Estimate]:
    """Its parameters without terms set to zero, as a search for an unlisted law leaves them."""

    def zero(estimate: Estimate) -> bool:
        return estimate.std is None and isinstance(estimate.value, int | float) and estimate.value == 0

    return {name: e for name, e in effect.parameters.items() if not zero(e)}


def _described(effect: NamedEffect) -> str:
    text = f"{readable(effect.id).capitalize()}: {effect.sentence} Law: {effect.equation}."
    if effect.form:
        text += f" Formula that fits best: {effect.form}."
    text += f" Share of the probability among the explanations tried: {share(effect.confidence)}."
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
    # Without physics added there is one model, and one column for it.
    columns = (f"before [{unit}]", f"after [{unit}]") if after_name(diagnosis) else (f"model [{unit}]",)
    columns = (*columns, f"noise alone [{unit}]")
    header = ("recordings", *columns)
    both = (diagnosis.training, diagnosis.heldout)
    metrics = _metrics([(w.before, w.after, w.noise_floor) for w in both], diagnosis)
    names = ("fitted", "held out, never fitted")
    rows: list[tuple[Cell, ...]] = [(name, *cells) for name, cells in zip(names, metrics, strict=True)]
    if diagnosis.heldout.improvement is not None and after_name(diagnosis):
        header = (*header, f"improvement, 95 % [{unit}]")
        rows = [(*row, _gain(w)) for row, w in zip(rows, both, strict=True)]
    tables = [Table(f"{measure} Means over recordings.", header, tuple(rows))]
    single = {o.recording: o for o in diagnosis.evidence.overlays}
    if len(single) > 1:
        metrics = _metrics([o.metric for o in single.values()], diagnosis)
        roles = ["held out" if o.heldout else "fitted" for o in single.values()]
        rows = [(*words, *cells) for *words, cells in zip(single, roles, metrics, strict=True)]
        tables.append(Table("The same for each recording.", ("recording", "role", *columns), tuple(rows)))
    title = {
        MISSING: "Does it hold on recordings that were never fitted?",
        NOTHING: "Does the model hold on recordings that were never fitted?",
    }.get(diagnosis.verdict, "How far the model is from recordings that were never fitted")
    kept = diagnosis.heldout.recordings
    text = (f"Kept back from the fit: {', '.join(kept)}.",) if kept else ()
    return Section(title, text, tuple(tables), proof(diagnosis))


def _gain(quality: PredictionQuality) -> Cell:
    if quality.improvement is None:
        return Number(NONE, math.nan)
    return Number(interval(*quality.improvement), quality.improvement[0])


def _metrics(values: Sequence[tuple[float, float, float]], diagnosis: Diagnosis) -> list[list[Number]]:
    """Rows of before, after, noise floor, all to the same decimal; without ``after`` where nothing was added."""
    kept = slice(None) if after_name(diagnosis) else slice(None, None, 2)
    texts = alike([value for row in values for value in row])
    cells = [Number(text, value) for text, value in zip(texts, (v for row in values for v in row), strict=True)]
    return [cells[k : k + 3][kept] for k in range(0, len(cells), 3)]


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
    opening: tuple[str, ...] = ()
    quiet = diagnosis.verdict == NOTHING
    title = "Where a mismatch was looked for" if quiet else "Where the mismatch sits"
    if quiet and not sentences:
        opening = ("No channel, time, band or state stands out of the noise.",) if diagnosis.evidence.maps else ()
    return Section(title, opening, tables, places(diagnosis), points=sentences)


def _which(diagnosis: Diagnosis) -> Section:
    unit = UNIT[diagnosis.metric]
    distances = alike([t.heldout_metric for t in diagnosis.tried])
    rows = tuple(
        (readable(t.id), Number(evidence_text(t.log_evidence), t.log_evidence), Number(text, t.heldout_metric))
        for t, text in zip(diagnosis.tried, distances, strict=True)
    )
    header = ("explanation", "log evidence above the baseline [–]", f"distance from held-out recordings [{unit}]")
    caption = "Every explanation that was fitted in full. Evidence: three more is twenty times likelier."
    tables = (Table(caption, header, rows),) if rows else ()
    return Section("Which explanations were tried", (), tables, explained(diagnosis))


def _moved(diagnosis: Diagnosis) -> Section:
    after = after_name(diagnosis)
    rows: list[tuple[Cell, ...]] = []
    for c in diagnosis.conflicts:
        before = scalar(diagnosis.before, c.parameter)
        row: list[Cell] = [c.parameter, Number(measured(c.prior, known_std(c)), c.prior)]
        row.append(Number(measured(c.fitted, before.std if before else None), c.fitted))
        if after:
            row.append(_after(c, diagnosis))
        rows.append((*row, printed(c.unit) or NONE, Number(f"{c.sigmas:+.1f}".replace("-", "−"), c.sigmas)))
    fitted = ("model before", after) if after else ("model",)
    header = ("parameter", "known", *fitted, "unit", f"moved{' before' if after else ''} [std]")
    caption = "Value ± standard deviation; moved: distance from what was known, in its standard deviations."
    title = (
        "What it had been hidden in" if diagnosis.verdict == MISSING else "Parameters against what was known of them"
    )
    return Section(title, (), (Table(caption, header, tuple(rows)),) if rows else (), moved(diagnosis))


def _after(conflict: Conflict, diagnosis: Diagnosis) -> Number:
    after = scalar(diagnosis.after, conflict.parameter)
    if after is None:
        return Number(NONE, math.nan)
    return Number(measured(float(after.value), after.std), float(after.value))


def _next(diagnosis: Diagnosis) -> Section:
    return Section("What to record next", (diagnosis.next_experiment,) if diagnosis.next_experiment else ())
