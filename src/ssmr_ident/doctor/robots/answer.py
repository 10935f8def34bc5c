"""From what a search of a robot's recordings has fitted to the answer: table, outcome, diagnosis."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from ssmr_ident.core.parameter import ParameterSet
from ssmr_ident.diagnose.assemble import assembled
from ssmr_ident.diagnose.diagnosis import Diagnosis, KindShare
from ssmr_ident.diagnose.followed import explained
from ssmr_ident.diagnose.outcome import Outcome
from ssmr_ident.diagnose.setup import Setup
from ssmr_ident.diagnose.weigh import Explanation
from ssmr_ident.doctor.decays.linear import fit_linear
from ssmr_ident.doctor.decide import MISSING, Decision, held_against
from ssmr_ident.doctor.robots.found import Found, Search
from ssmr_ident.doctor.robots.members import BY_KIND, EXTRA, GEOMETRY, SENSOR
from ssmr_ident.doctor.rules import FORMULA
from ssmr_ident.doctor.table import Row
from ssmr_ident.identify.fitting.curvature import Curvature
from ssmr_ident.identify.fitting.descent import descend
from ssmr_ident.identify.fitting.joint import differentiate, evaluate
from ssmr_ident.physics.extended import OFFSET

Array = np.ndarray

ELEMENTS = {EXTRA: "body", GEOMETRY: "body", SENSOR: "sensor.acceleration"}
"""Where members of each kind act: on the body, on all axes of the accelerometer; of others, in every tire alike."""

APART = {"cable_compliance": "cable", "load_cell_drift": "sensor.force"}
"""Elements of effects that act elsewhere than the others of their kind."""

WEIGHED = (
    "Weigh the robot under each wheel: the four loads say where the centre of mass lies between the contacts; and "
    "measure from the accelerometer to the contacts, which a displaced centre of mass leaves as the file has it"
)

TEMPERED = 3
"""Steps of a fit whose noise is taken to be larger."""

GROWS = 1.02
"""Factor by which an error may grow that a displaced place, which the baseline has made good elsewhere, leaves as it
was; and one of pulls, no two of which slide alike."""

SHOWN = 2
"""Models that fit alike and are brought to the page at the most."""


def element_of(effect: str, setup: Setup) -> str:
    """Where an effect acts."""
    forces = all(trial.channels == ("force",) for trial in setup.fitted)
    if effect in APART or (forces and effect == "sensor_saturation"):
        return APART.get(effect, "sensor.force")
    return ELEMENTS.get(BY_KIND[effect], "tire")


def answered(
    setup: Setup, search: Search, rows: Sequence[tuple[Row, Found]], decision: Decision, known: ParameterSet, seed: int
) -> Diagnosis:
    """The diagnosis that a decision makes of a search."""
    found = assembled(outcome(setup, search, rows, decision), known, seed)
    # what takes any shape is made of several laws' terms, and is none of them
    shown = [e for e in found.effects if decision.listed or e.id == "unlisted"]
    kind = dict(zip(decision.chosen.ids, decision.chosen.kinds, strict=True)) if decision.chosen else {}
    named = tuple(replace(e, kind=kind.get(e.id, BY_KIND[e.id]), element=element_of(e.id, setup)) for e in shown)
    kinds = tuple(
        KindShare(s.kind, element_of(s.row.ids[0], setup), float(s.share), float(s.log_evidence))
        for s in decision.kinds
    )
    found = replace(found, effects=named, kinds=kinds)
    # what the file charges for displaced places is no share of a misfit
    return replace(told_as_places(found), kinds=()) if [e.id for e in named] == [OFFSET] else found


def told_as_places(found: Diagnosis) -> Diagnosis:
    """What does the same as a displaced centre of mass, and what to measure."""
    note = (
        "contacts and accelerometer that both lie as far to the other side of where the file has them do the same as a "
        "centre of mass that is displaced: recordings know one from the other only by what the file says of them"
    )
    return replace(found, notes=(*found.notes, note), next_experiment=WEIGHED)


def table(search: Search) -> list[tuple[Row, Found]]:
    """Every model in one unit: log evidence over the baseline, by what the best one leaves."""
    best = search.best
    temper = max(best.chi2 / search.samples, 1.0)
    if best.fit is not None:
        temper *= best.fit.size / best.fit.independent
    samples, base = search.samples / temper, search.baseline

    def row(found: Found) -> Row:
        count = sum(max(sum(c.effect == name for c in found.model.free), 1) for name in found.model.held)
        gain = 0.5 * (base.cost - found.cost) / temper - 0.5 * count * math.log(samples)
        names = tuple(m.id for m in found.members)
        if names == (OFFSET,):
            gain = _of_places(search, found, temper)
        forms = " + ".join(f"{m.id} ({m.form})" for m in found.members) or "baseline"
        generic = any(m.generic for m in found.members)
        kinds = tuple(m.kind for m in found.members)
        return Row(names, kinds, forms, generic, gain, found.chi2 / temper, samples, search.over(found))

    return told_apart([(row(found), found) for found in search.all])


def told_apart(table: list[tuple[Row, Found]]) -> list[tuple[Row, Found]]:
    """Without members of any shape that a law of their kind follows better than they do, for they do not hold it; and
    without pairs of which, where no such member is left, one effect takes what a formula of the other may leave:
    ``FORMULA`` of the baseline's misfit."""
    laws: dict[str, float] = {}
    for row in (r for r, _ in table if len(r.ids) == 1 and not r.generic):
        laws[row.kinds[0]] = min(laws.get(row.kinds[0], math.inf), row.chi2)
    table = [
        (r, f) for r, f in table if not (r.generic and len(r.ids) == 1 and r.chi2 > laws.get(r.kinds[0], math.inf))
    ]
    rows = [row for row, _ in table]
    formula = FORMULA * (next(r.chi2 for r in rows if not r.ids) - min(r.chi2 for r in rows if math.isfinite(r.chi2)))

    def stands(row: Row) -> bool:
        found = [held_against(row, k, rows) for k in (0, 1)] if len(row.ids) > 1 else []
        return all(
            any(r.generic for r in alone) or row.chi2 < min(r.chi2 for r in alone) - formula for alone in found if alone
        )

    return [(row, found) for row, found in table if stands(row)]


def _of_places(search: Search, found: Found, temper: float) -> float:
    """Log evidence of places that the file states: what priors charge is not tempered, and their price is by how much
    the recordings narrow them."""
    own = slice(len(found.model.physics), None)
    without, beside = (_tempered(search, one, temper) for one in (search.baseline, found))
    if without is None or beside is None:
        return -math.inf
    narrowed = float(np.linalg.slogdet(np.linalg.inv(beside[1])[own, own])[1])
    return 0.5 * (without[0] - beside[0]) + 0.5 * narrowed


def _tempered(search: Search, found: Found, temper: float) -> tuple[float, Array] | None:
    """Least cost of a model, and half of its curvature, where noise has ``temper`` times its variance."""
    if search.decays:
        fit = fit_linear(search.decays, found.model, found.point, temper=temper)
        return None if fit is None else (fit.cost, fit.information)
    assert found.fit is not None
    at = differentiate(descend(found.fit, TEMPERED, plain=True, temper=temper))
    curvature, _ = Curvature.of(at, np.full(len(at.trials), 1.0 / temper)).normal_equations()
    return at.rss / temper + at.penalty, curvature


def outcome(setup: Setup, search: Search, rows: Sequence[tuple[Row, Found]], decision: Decision) -> Outcome:
    """The decision as the page takes it: the baseline, what is named, and what it cannot be told apart from."""
    base = _shown(setup, search.baseline)
    tried, rivals, chosen, withdrawn = [base], [], base, ""
    if decision.verdict == MISSING and decision.chosen is not None:
        first = next(found for row, found in rows if row is decision.chosen)
        chosen = _shown(setup, first)
        ties = set(decision.ties)
        own = set(decision.chosen.ids)
        simulated = [(row, found) for row, found in rows if found.fit is not None]
        alike = [found for row, found in simulated if set(row.ids) - own and set(row.ids) - own <= ties]
        rivals = [_shown(setup, found) for found in alike[:SHOWN]]
        tried += [chosen, *rivals]
        of_decays = search.decays and set(decision.chosen.kinds) != {GEOMETRY}
        if _harms(chosen, base, 1.0 if of_decays else GROWS):
            rivals, chosen, withdrawn = [], base, chosen.id
    return Outcome(
        setup, base, tuple(tried), chosen, tuple(rivals), _evidence(rows, tried), search.looked_at, decision.confidence,
        withdrawn,
    )  # fmt: skip


def _harms(chosen: Explanation, base: Explanation, grows: float) -> bool:
    """Whether an answer predicts recordings, fitted or kept back, worse than the baseline, as they are compared: jolts
    of cables by their share, teeth by their sizes."""
    fitted, kept = chosen.fit.rss / base.fit.rss, chosen.kept.rss / base.kept.rss
    return not (fitted < grows**2 and kept < grows**2)


def _evidence(rows: Sequence[tuple[Row, Found]], tried: Sequence[Explanation]) -> dict[str, float]:
    best: dict[str, float] = {}
    for row, _ in rows:
        name = "+".join(row.ids) or "baseline"
        best[name] = max(best.get(name, -math.inf), row.log_evidence)
    return {e.id: best.get(e.id, 0.0) for e in tried}


def _shown(setup: Setup, found: Found) -> Explanation:
    """A model at full resolution, and followed on what was kept back."""
    assert found.fit is not None
    fit = descend(evaluate(setup.fitted, found.model, found.point, found.fit.nuisances), 1, plain=True)
    return explained(setup.kept, differentiate(fit))
