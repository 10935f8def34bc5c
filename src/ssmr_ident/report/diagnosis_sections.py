"""What stands below the first screen: one section per question that a reader asks next."""

from __future__ import annotations

import math
import re
from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from ssmr_ident.core.parameter import Estimate, ParameterSet
from ssmr_ident.core.rotary import both_names, unit_ending
from ssmr_ident.diagnose.diagnosis import MISSING, NOTHING, UNIT, Conflict, Diagnosis, NamedEffect
from ssmr_ident.physics.effects import CATALOGUE
from ssmr_ident.physics.network import layout_of
from ssmr_ident.physics.robot import robot_from_parameters
from ssmr_ident.report.diagnosis_charts import after_name, curve_charts, overlay_charts
from ssmr_ident.report.diagnosis_places import places
from ssmr_ident.report.field_words import explanation_words, is_rig, kind_words, place_words
from ssmr_ident.report.figures_diagnosis import evidence_text, readable
from ssmr_ident.report.html import Cell, Formula, Number, Picture, Section, Table, drawing
from ssmr_ident.report.mathml import symbol
from ssmr_ident.report.network_figure import network_figure
from ssmr_ident.report.numbers import NONE, alike, interval, measured, number, share
from ssmr_ident.report.numbers import unit as printed
from ssmr_ident.report.robot_figure import NAMES, parts_of, robot_figure

_BY_ITS_SYMBOL = re.compile(r"^[A-Za-z]\w*: ")
"""Which stands before the meaning in the catalogue, and on the page beside it."""

SHOWN_TRIED = 15
"""As many explanations as a reader looks at."""


def sections(diagnosis: Diagnosis) -> tuple[Section, ...]:
    """All sections that have something to say, in reading order."""
    made = (
        _network(diagnosis),
        _robot(diagnosis),
        _proof(diagnosis),
        _effects(diagnosis),
        _where(diagnosis),
        _which(diagnosis),
        _moved(diagnosis),
        Section("What limits this answer", points=diagnosis.notes),
    )
    return tuple(s for s in made if s.paragraphs or s.points or s.tables or s.figures or s.charts)


def _network(diagnosis: Diagnosis) -> Section:
    """A network with what the answer is about in colour; a body that was found stands in the drawing."""
    if not diagnosis.before.between:
        return Section("")
    marked = tuple(e.element for e in diagnosis.effects)
    new = tuple(name for name in diagnosis.after.between if name not in diagnosis.before.between)
    named = " and ".join(place_words(name, diagnosis.after) for name in dict.fromkeys((*marked, *new)))
    caption = f"The network; {named} in colour." if named else "The network."
    drawn = network_figure(layout_of(diagnosis.after), (*marked, *new))
    item = drawing(drawn, f"Bodies and springs. {caption}", "network")
    return Section("The network", figures=(Picture((item,), caption),))


def _robot(diagnosis: Diagnosis) -> Section:
    """A robot of which the file says where its contacts are, with the part that the answer is about in colour."""
    marked = parts_of(tuple(part for e in diagnosis.effects for part in e.id.split("+")))
    if is_rig(diagnosis.before) or "contact_points_m" not in diagnosis.before or not marked:
        return Section("")
    names = " and ".join(NAMES[part] for part in marked)
    caption = f"The robot to scale; {names} in colour, a cross at the centre of mass, a square at the accelerometer."
    drawn = robot_figure(robot_from_parameters(diagnosis.after), marked)
    return Section("The robot", figures=(Picture((drawing(drawn, caption, "robot"),), caption),))


def turning(diagnosis: Diagnosis) -> bool:
    """Whether it is of a rotary rig."""
    return diagnosis.before.rotary


def quantity(effect: str, name: str) -> str:
    """A parameter's name without the unit that it ends in.

    >>> quantity("dry_friction", "F_c_N"), quantity("nonlinear_stiffness", "k3_N_m_rad3")
    ('F_c', 'k3')
    """
    parameters = CATALOGUE[effect].parameters if effect in CATALOGUE else ()
    units = {named: unit for p in parameters for named, unit in both_names(p.name, p.unit).items()}
    return name.removesuffix(unit_ending(units.get(name, "1")))


def _effects(diagnosis: Diagnosis) -> Section:
    rows: list[tuple[Cell, ...]] = []
    several = len(diagnosis.effects) > 1
    for effect in diagnosis.effects:
        known = CATALOGUE.get(effect.id)
        meanings = (
            {named: _BY_ITS_SYMBOL.sub("", p.meaning) for p in known.parameters for named in both_names(p.name, p.unit)}
            if known
            else {}
        )
        turns = turning(diagnosis) and effect.kind != "sensor_chain"
        for name, estimate in effect.acting.items():
            first: tuple[Cell, ...] = (readable(effect.id),) if several else ()
            named = Formula(symbol(quantity(effect.id, name), turns))
            rows.append((*first, named, *_estimated(estimate), meanings.get(name) or NONE))
    header = (*(("effect",) if several else ()), "parameter", "value ± std", "95 % interval", "unit", "meaning")
    title = "What was added" if diagnosis.verdict == MISSING else "What it could be"
    text = [] if diagnosis.verdict == MISSING else [_sentence(effect) for effect in diagnosis.effects]
    caption = ""
    if any(estimate.std is None for effect in diagnosis.effects for estimate in effect.acting.values()):
        caption = "No interval stands where the fit leaves structure behind, so that one would promise too much."
    tables = (Table(caption, header, tuple(rows)),) if rows else ()
    return Section(title, tuple(text), tables, charts=curve_charts(diagnosis))


def _sentence(effect: NamedEffect) -> str:
    share_ = f"{share(effect.confidence)} of the probability among the explanations tried"
    return f"{readable(effect.id).capitalize()}: {effect.sentence.rstrip('.')}; {share_}."


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
    """Every recording's error, and the charts that the first screen has no room for."""
    unit = UNIT[diagnosis.metric]
    measure = {
        "%": "Error: the size of what is left over, in per cent of the size of the recording itself.",
        "dB": "Error: the root mean square difference between the levels of two spectra, 1 to 50 Hz.",
    }[unit]
    # Without physics added there is one model, and one column for it.
    columns = (f"before [{unit}]", f"after [{unit}]") if after_name(diagnosis) else (f"model [{unit}]",)
    header = ("recording", "role", *columns, f"noise alone [{unit}]")
    single = {o.recording: o for o in diagnosis.evidence.overlays}
    values = [diagnosis.training, *((diagnosis.heldout,) if len(diagnosis.heldout.recordings) > 1 else ())]
    words = [("mean", "fitted"), ("mean", "never fitted")][: len(values)]
    measured_ = [(w.before, w.after, w.noise_floor) for w in values]
    if len(single) > 1 or not diagnosis.heldout.recordings:
        words += [(o.recording, "never fitted" if o.heldout else "fitted") for o in single.values()]
        measured_ += [o.metric for o in single.values()]
    cells = _metrics(measured_, diagnosis)
    rows: list[tuple[Cell, ...]] = [(*name, *row) for name, row in zip(words, cells, strict=True)]
    return Section("Recording by recording", (), (Table(measure, header, tuple(rows)),),
                   charts=overlay_charts(diagnosis)[1:])  # fmt: skip


def _metrics(values: Sequence[tuple[float, float, float]], diagnosis: Diagnosis) -> list[list[Number]]:
    """Rows of before, after, noise floor, all to the same decimal; without ``after`` where nothing was added."""
    kept = slice(None) if after_name(diagnosis) else slice(None, None, 2)
    texts = alike([value for row in values for value in row])
    cells = [Number(text, value) for text, value in zip(texts, (v for row in values for v in row), strict=True)]
    return [cells[k : k + 3][kept] for k in range(0, len(cells), 3)]


def _where(diagnosis: Diagnosis) -> Section:
    rows: list[tuple[Cell, ...]] = []
    regions = any(place.region for place in diagnosis.located)
    for place in diagnosis.located:
        seen: tuple[Cell, ...] = (place.region or NONE,) if regions else ()
        rows.append(
            (
                place.recording,
                place.channel,
                Number(interval(*place.time_s), place.time_s[0]),
                Number(interval(*place.band_hz), place.band_hz[0]),
                *seen,
                Number(number(100 * place.share), place.share, place.share),
            )
        )
    where = ("where in the motion",) if regions else ()
    header = ("recording", "channel", "time [s]", "band [Hz]", *where, "share of the misfit [%]")
    tables = (Table("Largest first.", header, tuple(rows)),) if rows else ()
    title = "Where a misfit was looked for" if diagnosis.verdict == NOTHING else "Where the misfit sits"
    return Section(title, (), tables, places(diagnosis))


def _which(diagnosis: Diagnosis) -> Section:
    unit = UNIT[diagnosis.metric]
    tried = sorted(diagnosis.tried, key=lambda t: -t.log_evidence)
    ranked = tried[:SHOWN_TRIED] + [t for t in tried[SHOWN_TRIED:] if t.id == "baseline"]
    distances = alike([t.heldout_metric for t in ranked])
    largest = max((t.log_evidence for t in ranked if math.isfinite(t.log_evidence)), default=0.0)
    rows = tuple(
        (explanation_words(t.name, t.id),
         Number(evidence_text(t.log_evidence), t.log_evidence, _part(t.log_evidence, largest)),
         Number(text, t.heldout_metric))
        for t, text in zip(ranked, distances, strict=True)
    )  # fmt: skip
    header = ("explanation", "log evidence above the baseline [–]", f"error, never fitted [{unit}]")
    caption = (
        "Each was fitted in full, as a listed law or as its kind in any shape. Log evidence weighs the fit against the "
        "number of parameters; three more is twenty times likelier."
    )
    if len(ranked) < len(tried):
        caption += f" The {len(tried) - len(ranked)} least likely stand in diagnosis.yaml."
    kinds = tuple(
        (kind_words(k.kind), place_words(k.element, diagnosis.after), Number(number(100 * k.share), k.share, k.share))
        for k in diagnosis.kinds
    )
    tables = (
        *((Table("What each kind of physics in any shape takes of the misfit, alone.",
                 ("kind", "at", "share of the misfit [%]"), kinds),) if kinds else ()),
        *((Table(caption, header, rows),) if rows else ()),
    )  # fmt: skip
    return Section("Explanations against each other", (), tables)


def _part(value: float, largest: float) -> float:
    return min(max(value / largest, 0.0), 1.0) if math.isfinite(value) and largest > 0 else 0.0


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
    title = "Parameters that stood in for it" if diagnosis.verdict == MISSING else "Parameters against what was known"
    return Section(title, (), (Table(caption, header, tuple(rows)),) if rows else ())


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


def _after(conflict: Conflict, diagnosis: Diagnosis) -> Number:
    after = scalar(diagnosis.after, conflict.parameter)
    if after is None:
        return Number(NONE, math.nan)
    return Number(measured(float(after.value), after.std), float(after.value))
