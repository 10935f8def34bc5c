"""From the table and the decision to the answer: names, numbers, sentences, files, and what figures are drawn from."""

from __future__ import annotations

import math
from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from ssmr_ident.compare.comparison import measure
from ssmr_ident.compare.network import band_of
from ssmr_ident.compare.prediction import Prediction
from ssmr_ident.core.parameter import FITTED, Estimate, ParameterSet, at_element
from ssmr_ident.diagnose.diagnosis import Conflict, Diagnosis, KindShare, Located, NamedEffect, PredictionQuality, Tried
from ssmr_ident.diagnose.evidence import Evidence
from ssmr_ident.diagnose.words import law, missing, nothing, told, undetermined
from ssmr_ident.diagnose.worth import overlays, worth
from ssmr_ident.doctor.decide import MISSING, NOTHING, UNDETERMINED, Decision
from ssmr_ident.doctor.fitted import Search
from ssmr_ident.doctor.further_body import mode_parameters, riders, shapes_told, with_further_bodies
from ssmr_ident.doctor.law_curve import law_curve
from ssmr_ident.doctor.next_recording import next_recording
from ssmr_ident.doctor.notes import notes_on, wandering_zeros
from ssmr_ident.doctor.rules import UNEVEN
from ssmr_ident.doctor.table import Row
from ssmr_ident.estimate.node import Member, effects_of
from ssmr_ident.estimate.values import Fit, Problem
from ssmr_ident.experiments.campaign import Campaign
from ssmr_ident.physics.effects import CATALOGUE

Array = np.ndarray

METRIC = "nrmse_percent"

CONFLICT = 2.0
"""Prior standard deviations from which a parameter counts as pulled away from what is known of it."""

EXACTLY = 1e-6
"""Prior standard deviation of a coordinate below which it stays."""

POINTS = 41
"""Of a curve."""


@dataclass(frozen=True, eq=False)
class Examined:
    """Everything that an answer is made of."""

    campaign: Campaign
    known: ParameterSet
    search: Search
    rows: tuple[Row, ...]
    decision: Decision
    fitted: Problem
    kept: Problem | None
    kept_by_us: bool
    notes: tuple[str, ...]


def answer(found: Examined) -> Diagnosis:
    """The diagnosis."""
    base = next(r for r in found.rows if not r.ids)
    decision = found.decision
    chosen = next((r for r in found.rows if decision.chosen is not None and r.name == decision.chosen.name), base)
    assert base.fit is not None
    assert chosen.fit is not None
    before, after = (predictions(found.fitted, f, found.known) for f in (base.fit, chosen.fit))
    training = worth(before, after if chosen is not base else before, names_of(found.fitted))
    heldout = PredictionQuality(math.nan, math.nan, math.nan)
    drawn = overlays([p.name for p in found.fitted.pieces], before, after, heldout=False)
    if found.kept is not None and base.kept is not None and chosen.kept is not None:
        kept = [predictions(found.kept, f, found.known) for f in (base.kept, chosen.kept)]
        heldout = worth(kept[0], kept[1] if chosen is not base else kept[0], names_of(found.kept))
        drawn = overlays([p.name for p in found.kept.pieces], kept[0], kept[1], heldout=True)
    decision = _checked(decision, training, heldout)
    named = decision.verdict == MISSING
    before_file = exported(base.fit, found.known)
    after_file = exported(chosen.fit, found.known) if named else before_file
    effects = named_effects(found, decision, chosen, after_file) if named else ()
    conflicts = conflicting(base.fit)
    names = {r.name for r in found.rows}
    fits = {r.name: r.fit for r in (*found.search.far, *found.rows) if r.fit is not None}
    rows = (*found.rows, *(r for r in found.search.far if r.name not in names))
    tried = tuple(Tried("+".join(r.ids) or "baseline", r.heldout, r.log_evidence, r.name) for r in rows)
    shown = training if math.isnan(heldout.before) else heldout
    slow = wandering_zeros(found.search.problem, chosen)
    if named:
        summary = missing(effects, shown, METRIC, conflicts)
    elif decision.verdict == NOTHING:
        summary = nothing(shown, METRIC, len(rows) - 1)
    else:
        event = "; ".join(slow)
        if not slow and base.left.uneven > UNEVEN:
            event = f"{base.left.loudest} holds what noise of no colour reads in it"
        summary = undetermined(shown, METRIC, [r.name for r in found.rows if r.ids], event)
    if shown is training:
        summary = summary.replace("recordings never fitted", "the recordings that were fitted")
    return Diagnosis(
        session=found.campaign.session.name,
        verdict=decision.verdict,
        located=() if decision.verdict == NOTHING else located(found.search.problem, base.fit),
        conflicts=conflicts,
        effects=effects,
        tried=tried,
        metric=METRIC,
        training=training,
        heldout=heldout,
        next_experiment=next_recording(found.search.problem, found.rows, decision, decision.verdict == UNDETERMINED),
        before=before_file,
        after=before_file if chosen.generic else after_file,  # a force of any shape has no place in a file
        summary=summary,
        notes=(*found.notes, *notes_on(found.search.problem, found.rows, decision, chosen, heldout)),
        evidence=Evidence(overlays=drawn),
        kinds=tuple(
            KindShare(s.kind, element_of(fits[s.row.name].node.members[0]), float(s.share), float(s.log_evidence))
            for s in decision.kinds
            if s.row.name in fits
        ),
    )


def _checked(decision: Decision, training: PredictionQuality, heldout: PredictionQuality) -> Decision:
    """No effect is named that makes the error on fitted recordings grow, or on kept ones by a fiftieth."""
    grows = training.after > training.before or heldout.after > 1.02 * heldout.before
    return replace(decision, verdict=UNDETERMINED) if decision.verdict == MISSING and grows else decision


def predictions(problem: Problem, fit: Fit, known: ParameterSet) -> list[Prediction]:
    """Every piece beside what a fit says of it."""
    return [
        Prediction(p.time, p.channels, p.units, p.y + p.foot, p.y + p.foot + rest, low_pass_hz=high, high_pass_hz=low)
        for p, rest in zip(problem.pieces, fit.residuals, strict=True)
        for low, high in [band_of(known, p.band)]
    ]


def errors(found: Sequence[Prediction]) -> Array:
    return np.array([measure(p)[0] for p in found])


def names_of(problem: Problem) -> tuple[str, ...]:
    return tuple(dict.fromkeys(p.name for p in problem.pieces))


def exported(fit: Fit, known: ParameterSet) -> ParameterSet:
    """The parameter set that a fit stands for."""
    node, values = fit.node, fit.node.values(fit.point)
    stds = np.sqrt(np.maximum(np.diag(fit.covariance), 0.0)) * np.abs(node.slopes(fit.point))
    of_baseline = np.sqrt(np.maximum(np.diag(baseline_covariance(fit, known)), 0.0))
    changes: dict[str, Estimate] = {}
    for k, c in enumerate(node.baseline):
        if c.std < EXACTLY:
            continue
        changes[c.name] = replace(known[c.name], value=float(values[k]), std=float(of_baseline[k]), source=FITTED)
    known = with_further_bodies(fit, known.updated(changes))
    place, scaled = {id(c): k for k, c in enumerate(node.coordinates)}, _scaled_by_mass(fit, known)
    blocks: dict[str, dict[str, Estimate]] = {}
    bodies = riders(fit)
    held = [m for m in node.members if m not in bodies]
    for effect, full in effects_of(node, fit.point).items():
        if effect in {m.id for m in bodies}:
            continue
        fitted = {c.name for m in held if m.id == effect for c in m.coordinates if c.std >= EXACTLY}
        units = {p.name: p.unit for p in CATALOGUE[effect].parameters}
        blocks[effect] = {
            n: Estimate(float(full[n]), None, units[n], "not fitted", fixed=True) for n in needed(effect, full, fitted)
        }
    for member in held:
        for c in member.coordinates if member.id in blocks and not member.tables else ():
            if c.std < EXACTLY:
                continue
            k = place[id(c)]
            std = math.hypot(stds[k], scaled * values[k] if c.unit.startswith("N") else 0.0)
            blocks[member.id][c.name] = Estimate(
                float(values[k]), std, c.unit, FITTED, at_bound=values[k] in (c.lower, c.upper)
            )
    elements = {m.id: m.element for m in held if m.element}
    return replace(known, effects={at_element(i, elements.get(i, "")): block for i, block in blocks.items()})


def needed(effect: str, values: Mapping[str, float], fitted: Collection[str]) -> list[str]:
    """Parameters of an effect from which a file is read back as it is: the fitted ones, and those others that the
    catalogue does not set as they are by itself."""
    names = {name for name in values if name in fitted}
    while True:
        given = CATALOGUE[effect].begun({name: values[name] for name in names})
        missing_yet = {name for name, value in values.items() if given[name] != value} - names
        if not missing_yet:
            return [name for name in values if name in names]
        names |= missing_yet


def baseline_covariance(fit: Fit, known: ParameterSet) -> Array:
    """Covariance of the baseline's parameters in their units, (k, k) float.

    Where no force was measured a rig's mass scales all and stays: what is not known of it is not known of damping and
    stiffness either.
    """
    node, count = fit.node, len(fit.node.baseline)
    slopes, values = node.slopes(fit.point)[:count], node.values(fit.point)[:count]
    covariance = fit.covariance[:count, :count] * np.outer(slopes, slopes)
    return np.asarray(covariance + _scaled_by_mass(fit, known) ** 2 * np.outer(values, values))


def _scaled_by_mass(fit: Fit, known: ParameterSet) -> float:
    """Relative standard deviation that all forces have from the mass, where no force was measured; else 0."""
    first = fit.node.baseline[0]
    mass = known[first.name]
    alone = len(fit.node.layout.bodies) == 1 and first.std < EXACTLY
    return mass.std / float(mass.value) if alone and mass.std and not mass.fixed else 0.0


def named_effects(found: Examined, decision: Decision, chosen: Row, after: ParameterSet) -> tuple[NamedEffect, ...]:
    """What was chosen, first of it what explains most alone."""
    assert chosen.fit is not None
    problem, named = found.search.problem, []
    alone = {r.ids: r.log_evidence for r in reversed(found.rows) if len(r.ids) == 1 and not r.generic}
    for member in sorted(chosen.fit.node.members, key=lambda m: -alone.get((m.id,), -math.inf)):
        effect = member.id if decision.listed else "unlisted"
        further = member in riders(chosen.fit)
        block = {} if member.tables else after.effects.get(at_element(member.id, member.element), {})
        values = mode_parameters(chosen.fit, member) if further else dict(block)
        if effect == "unlisted":
            values = {name: e for name, e in values.items() if not e.fixed}
        drawn = curve(chosen.fit, member)
        text = law(effect, values) if values else "F = f(s, v), drawn" if drawn else ""
        kind = member.kind.replace("_", " ")
        sentence = told(effect, values) if values else f"Something of the kind {kind} acts that no listed law makes."
        if further:
            sentence = f"A body that the file has not moves on {member.element}. {shapes_told(after)}"
        values = values | _riding_mass(values, after) | _cubic_of_sine(values, after)
        named.append(
            NamedEffect(
                effect, sentence, text, values, min(decision.confidence, 1.0), decision.ties, member.form,
                kind=member.kind, element=element_of(member), curve=drawn or law_curve(problem, chosen.fit, member),
            )
        )  # fmt: skip
    return tuple({e.id: e for e in reversed(named)}.values())[::-1]


def _riding_mass(values: Mapping[str, Estimate], after: ParameterSet) -> dict[str, Estimate]:
    """What rides on a spring of its own, in the unit of the rig's mass."""
    share = values.get("rider_share")
    if share is None:
        return {}
    key = "inertia_kg_m2" if "inertia_kg_m2" in after else "mass_kg"
    mass = float(after[key].value)
    std = None if share.std is None else share.std * mass
    return {key: Estimate(share.value * mass, std, after[key].unit, "rider_share of the mass")}


def _cubic_of_sine(values: Mapping[str, Estimate], after: ParameterSet) -> dict[str, Estimate]:
    """The cubic with which a pendulum's sine begins: that of a test which swings no farther."""
    share = values.get("sine_share")
    if share is None:
        return {}
    spring = after["stiffness_N_m_rad"]
    third = -float(spring.value) / 6.0
    parts = (share.std or 0.0) * third, share.value * (spring.std or 0.0) / 6.0
    std = math.hypot(*parts) if any(parts) else None
    return {"k3_N_m3": Estimate(share.value * third, std, "N/m^3", "of the sine's series, -p K/6")}


def element_of(member: Member) -> str:
    if member.kind == "sensor_chain":
        return f"sensor.{member.channel}" if member.channel else "sensor.acceleration" if member.linear else "sensor"
    return member.element or ("body" if member.kind == "extra_motion" else "spring")


def curve(fit: Fit, member: Member) -> Mapping[str, Any] | None:
    """The force over deflection that a static generic member has taken, with its standard deviation."""
    tables = member.tables
    if tables is None or not tables.by_position.shape[1]:
        return None
    count = tables.by_position.shape[1]
    first = [id(c) for c in fit.node.coordinates].index(id(member.coordinates[0]))
    grid = np.linspace(-0.9, 0.9, POINTS)
    cells = np.linspace(-1.0, 1.0, len(tables.by_position))
    shapes = np.column_stack([np.interp(grid, cells, column) for column in tables.by_position.T])
    own = slice(first, first + count)
    scales = fit.node.slopes(fit.point)[own]
    force = shapes @ fit.node.values(fit.point)[own]
    spread = np.sqrt(np.einsum("gi,ij,gj->g", shapes * scales, fit.covariance[own, own], shapes * scales))
    stiffness = fit.node.values(fit.point)[len(fit.node.layout.bodies) + 1 + 2 * fit.node.site]
    return {
        "variable": "displacement [m]",
        "points": (grid * tables.reach).tolist(),
        "force": (force + stiffness * grid * tables.reach).tolist(),
        "std": spread.tolist(),
    }


def conflicting(fit: Fit) -> tuple[Conflict, ...]:
    """What the baseline's fit pulls away from what is known of it."""
    found = []
    for c, at in zip(fit.node.baseline, fit.point, strict=False):
        if c.std > 0.5 or c.std < EXACTLY:
            continue
        sigmas = (float(at) - c.mean) / c.std
        if abs(sigmas) > CONFLICT:
            found.append(Conflict(c.name, c.value(c.mean), c.value(float(at)), sigmas, c.unit))
    return tuple(sorted(found, key=lambda c: -abs(c.sigmas)))


def located(problem: Problem, fit: Fit) -> tuple[Located, ...]:
    """Recordings and channels by their share of the misfit, with the time and band that hold most of it."""
    places = []
    for piece, rest in zip(problem.pieces, fit.residuals, strict=True):
        counted = piece.counted(rest - rest.mean(axis=0))
        for c, name in enumerate(piece.channels):
            own = counted[:, c]
            power = np.cumsum(own**2)
            share = float(power[-1]) / float(piece.white[c]) ** 2
            moments = np.linspace(piece.time[0], piece.time[-1], len(own))
            time = np.interp([0.05, 0.95], power / max(power[-1], 1e-300), moments)
            spectrum = np.cumsum(np.abs(np.fft.rfft(own)) ** 2)
            grid = piece.counted_from + np.fft.rfftfreq(len(own), 1.0 / piece.counted_rate)
            band = np.interp([0.1, 0.9], spectrum / max(spectrum[-1], 1e-300), grid)
            places.append((share, piece.name, name, time, band))
    total = sum(p[0] for p in places)
    found = []
    for share, recording, channel, time, band in sorted(places, key=lambda p: -p[0])[:4]:
        part = share / max(total, 1e-300)
        words = (
            f"{100 * part:.0f} % of the misfit is in {channel} of {recording}, {time[0]:.3g} to {time[1]:.3g} s, "
            f"{band[0]:.3g} to {band[1]:.3g} Hz"
        )
        found.append(Located(recording, channel, (time[0], time[1]), (band[0], band[1]), "", part, words))
    return tuple(found)
