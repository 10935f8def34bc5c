"""A diagnosis of free decays from their campaign: search, table, decision, answer."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import replace

import numpy as np
from threadpoolctl import threadpool_limits

from ssmr_ident.core.errors import InputError
from ssmr_ident.core.parameter import ParameterSet
from ssmr_ident.diagnose.arranged import arranged
from ssmr_ident.diagnose.assemble import assembled
from ssmr_ident.diagnose.diagnosis import Diagnosis, KindShare
from ssmr_ident.diagnose.engine import Outcome, informed
from ssmr_ident.diagnose.followed import explained
from ssmr_ident.diagnose.setup import Setup, set_up
from ssmr_ident.diagnose.weigh import Explanation
from ssmr_ident.doctor.decays.found import Found, Search
from ssmr_ident.doctor.decays.linear import fit_linear
from ssmr_ident.doctor.decays.members import EXTRA, GEOMETRY, KINDS, MEMORY, SENSOR, STATIC
from ssmr_ident.doctor.decays.recordings import Decay, decay_of
from ssmr_ident.doctor.decays.search import (
    FORMULA_OVER,
    MATTERS,
    NEAR,
    SECOND_OVER,
    promised_beside,
    searched,
    searched_in_turn,
)
from ssmr_ident.doctor.decide import MISSING, Decision, certain, decide
from ssmr_ident.doctor.rules import CERTAIN, HALVED, SECOND
from ssmr_ident.doctor.table import Row
from ssmr_ident.experiments.campaign import Campaign
from ssmr_ident.identify.body.builder import RobotBuilder
from ssmr_ident.identify.fitting.descent import descend
from ssmr_ident.identify.fitting.joint import differentiate, evaluate
from ssmr_ident.physics.extended import BRANCH, LINEAR, OFFSET
from ssmr_ident.physics.slots import effect_values

Progress = Callable[[str, int, int], None]

BASELINE = "rigid6"

ELEMENTS = {STATIC: "tire", MEMORY: "tire", EXTRA: "body", GEOMETRY: "body", SENSOR: "sensor.acceleration"}
"""Where members of each kind act: in every tire alike, on the body, on all axes of the accelerometer."""

GROWS = 1.02
"""Factor by which an error may grow that a displaced place, which the baseline has made good elsewhere, leaves as it
was."""

WEIGHED = (
    "Weigh the robot under each wheel: the four loads say where the centre of mass lies between the contacts; and "
    "measure from the accelerometer to the contacts, which a displaced centre of mass leaves as the file has it"
)

SHOWN = 2
"""Models that fit alike and are brought to the page at the most."""


def diagnose(
    campaign: Campaign,
    parameters: ParameterSet | None = None,
    seed: int = 0,
    progress: Progress | None = None,
) -> Diagnosis:
    """Locate, name and prove what the baseline of a robot's free responses leaves out.

    Parameters
    ----------
    campaign : Campaign
        Of free responses, with ``baseline: rigid6``.
    parameters : ParameterSet, optional
        What is known beforehand, in place of the session's own file.
    seed : int
        Of permutations.
    progress : callable, optional
    """
    if not of_free_responses(campaign):
        m = next((m for m in campaign.measurements if not m.experiment.free), campaign.measurements[0])
        raise InputError(
            f"{campaign.session.folder / 'session.yaml'}: {m.name}",
            f"this doctor takes free responses of a robot with baseline {BASELINE}; this is a {m.entry.experiment} "
            f"with baseline {campaign.session.baseline}",
            "Ask ident diagnose",
        )
    known = campaign.parameters if parameters is None else parameters
    with threadpool_limits(1, user_api="blas"):
        setup, decays = _prepared(campaign, known)
        search = searched(decays, setup.model, progress)
        rows = table(search)
        return _answer(setup, search, rows, decide([row for row, _ in rows]), known, seed)


def diagnose_certain(
    campaign: Campaign, known: ParameterSet, seed: int = 0, progress: Progress | None = None
) -> Diagnosis | None:
    """The diagnosis of free responses where an effect, or two, explains them and nothing beside it promises more.

    Returns
    -------
    Diagnosis or None
        None where nothing is missing, or what is leaves more than noise; where the file has effects already that are
        not linear, or some recordings only calibrate the others.
    """
    calibrated = any(m.entry.role == "calibration" for m in campaign.measurements)
    if calibrated or not set(effect_values(known)) <= set(LINEAR):
        return None
    setup, decays = _prepared(campaign, known)
    for search in searched_in_turn(decays, setup.model, progress):
        found = _certain(setup, search, known, seed)
        if found is not None:
            return found
    return None


def _certain(setup: Setup, search: Search, known: ParameterSet, seed: int) -> Diagnosis | None:
    """The answer that a search has so far; None where it may be another one."""
    rows = table(search)
    decision = decide([row for row, _ in rows])
    if decision.verdict != MISSING or not decision.listed or decision.chosen is None:
        return None
    chosen = next(found for row, found in rows if row is decision.chosen)
    linear = all(m.linear for m in chosen.members)
    if search.over(chosen) > (NEAR if linear else SECOND_OVER) or _imitates(search, chosen):
        return None
    if not alone(decision.chosen, [row for row, _ in rows]):
        return None
    if _more_is_promised(search, chosen):
        return None
    found = _answer(setup, search, rows, decision, known, seed)
    most = GROWS if set(decision.chosen.kinds) == {GEOMETRY} else MATTERS
    qualities = (found.training, found.heldout)
    falls = all(q.after < most * q.before for q in qualities)
    follows = linear or all(q.after < SECOND_OVER * q.noise_floor for q in qualities)
    return found if falls and follows else None


def _more_is_promised(search: Search, chosen: Found) -> bool:
    """Whether something beside a model is as good as certain and takes half of what that leaves beyond noise: what
    takes less is its formula, which need not be the world's."""
    assert chosen.fit is not None
    promised = promised_beside(search, chosen)
    share = 1.0 - math.exp(-promised / chosen.fit.independent)
    return promised > 2.0 * SECOND and share > HALVED * (1.0 - search.over(chosen) ** -2)


def alone(chosen: Row, rows: Sequence[Row]) -> bool:
    """Whether no other explanation comes within ``CERTAIN``; beside a displaced place, which has another measure, none
    is certain."""
    base = next(r for r in rows if not r.ids)
    others = [r for r in rows if r.ids and not r.generic and not set(chosen.ids) <= set(r.ids)]
    if set(chosen.kinds) == {GEOMETRY}:
        return not any(certain(r, base) for r in others)
    return all(r.log_evidence < chosen.log_evidence - CERTAIN for r in others)


def _imitates(search: Search, chosen: Found) -> bool:
    """Whether relaxation may stand for a friction or a loop that was not fitted in its place: beside another effect, or
    where no law was fitted and more than noise is left."""
    relaxes = any(m.id == BRANCH for m in chosen.members)
    compared = search.over(search.baseline) < NEAR or search.has_laws
    return relaxes and (len(chosen.members) > 1 or not (compared or search.over(chosen) < FORMULA_OVER))


def of_free_responses(campaign: Campaign) -> bool:
    """Whether a session holds nothing but free responses of a robot of six degrees of freedom."""
    return campaign.session.baseline == BASELINE and all(m.experiment.free for m in campaign.measurements)


def _prepared(campaign: Campaign, known: ParameterSet) -> tuple[Setup, list[Decay]]:
    setup = informed(set_up(arranged(replace(campaign, parameters=known)), known), known)
    builder = RobotBuilder.of(known)
    return setup, [decay_of(t, builder) for t in setup.fitted]


def _answer(
    setup: Setup, search: Search, rows: Sequence[tuple[Row, Found]], decision: Decision, known: ParameterSet, seed: int
) -> Diagnosis:
    found = assembled(outcome(setup, search, rows, decision), known, seed)
    # what takes any shape is made of several laws' terms, and is none of them
    shown = [e for e in found.effects if decision.listed or e.id == "unlisted"]
    named = tuple(replace(e, kind=KINDS[e.id], element=ELEMENTS[KINDS[e.id]]) for e in shown)
    kinds = tuple(KindShare(s.kind, ELEMENTS[s.kind], float(s.share), float(s.log_evidence)) for s in decision.kinds)
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
        if {m.kind for m in found.members} == {GEOMETRY}:
            gain = _of_places(search, found, temper)
        names = tuple(m.id for m in found.members)
        forms = " + ".join(f"{m.id} ({m.form})" for m in found.members) or "baseline"
        generic = any(m.generic for m in found.members)
        kinds = tuple(m.kind for m in found.members)
        return Row(names, kinds, forms, generic, gain, found.chi2 / temper, samples, search.over(found))

    return [(row(found), found) for found in search.all]


def _of_places(search: Search, found: Found, temper: float) -> float:
    """Log evidence of places that the file states: what priors charge is not tempered, and their price is by how much
    the recordings narrow them."""
    base, own = search.baseline, slice(len(found.model.physics), None)
    without = fit_linear(search.decays, base.model, base.point, temper=temper)
    beside = fit_linear(search.decays, found.model, found.point, temper=temper)
    if without is None or beside is None:
        return -math.inf
    narrowed = float(np.linalg.slogdet(np.linalg.inv(beside.information)[own, own])[1])
    return 0.5 * (without.cost - beside.cost) + 0.5 * narrowed


def outcome(setup: Setup, search: Search, rows: Sequence[tuple[Row, Found]], decision: Decision) -> Outcome:
    """The decision as the page takes it: the baseline, what is named, and what it cannot be told apart from."""
    base = _shown(setup, search.baseline)
    tried, rivals, chosen = [base], [], base
    if decision.verdict == MISSING and decision.chosen is not None:
        first = next(found for row, found in rows if row is decision.chosen)
        chosen = _shown(setup, first)
        ties = set(decision.ties)
        own = set(decision.chosen.ids)
        simulated = [(row, found) for row, found in rows if found.fit is not None]
        alike = [found for row, found in simulated if set(row.ids) - own and set(row.ids) - own <= ties]
        rivals = [_shown(setup, found) for found in alike[:SHOWN]]
        tried += [chosen, *rivals]
    return Outcome(setup, base, tuple(tried), chosen, tuple(rivals), _evidence(rows, tried), ())


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
