"""A diagnosis of free decays from their campaign: search, table, decision, answer."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import replace

from threadpoolctl import threadpool_limits

from ssmr_ident.core.parameter import ParameterSet
from ssmr_ident.diagnose.arranged import arranged
from ssmr_ident.diagnose.diagnosis import Diagnosis
from ssmr_ident.diagnose.setup import Setup, set_up
from ssmr_ident.doctor.decays.linear_members import simulated
from ssmr_ident.doctor.decays.recordings import Decay, decay_of
from ssmr_ident.doctor.decays.search import MATTERS, begun, completed, in_turn, promised_beside
from ssmr_ident.doctor.decide import MISSING, Decision, certain, decide
from ssmr_ident.doctor.robots.answer import GROWS, answered, table
from ssmr_ident.doctor.robots.calibrated import informed
from ssmr_ident.doctor.robots.found import Found, Search
from ssmr_ident.doctor.robots.members import GEOMETRY
from ssmr_ident.doctor.rules import CERTAIN, HALVED, MORE_OVER, SECOND
from ssmr_ident.doctor.table import Row
from ssmr_ident.experiments.campaign import Campaign
from ssmr_ident.identify.body.builder import RobotBuilder
from ssmr_ident.physics.extended import BRANCH, LINEAR
from ssmr_ident.physics.slots import effect_values

Progress = Callable[[str, int, int], None]

PREDICTS = 1.25
"""Error over the noise floor up to which an answer may be given before all others have been tried."""


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
        Of free responses, with ``baseline: rigid6``; see ``takes``.
    parameters : ParameterSet, optional
        What is known beforehand, in place of the session's own file.
    seed : int
        Of permutations.
    progress : callable, optional
    """
    known = campaign.parameters if parameters is None else parameters
    with threadpool_limits(1, user_api="blas"):
        setup, decays = _prepared(campaign, known)
        search = begun(decays, setup.model, progress)
        for _ in in_turn(search, progress):
            found = _certain(setup, search, known, seed)
            if found is not None:
                return found
        completed(search, progress)
        rows, decision = _decided(search)
        return answered(setup, search, rows, decision, known, seed)


def _decided(search: Search) -> tuple[list[tuple[Row, Found]], Decision]:
    """Table and decision, once what is chosen is simulated."""
    while True:
        rows = table(search)
        decision = decide([row for row, _ in rows])
        chosen = next((found for row, found in rows if row is decision.chosen), None)
        if chosen is None or chosen.fit is not None:
            return rows, decision
        simulated(search, chosen)


def _certain(setup: Setup, search: Search, known: ParameterSet, seed: int) -> Diagnosis | None:
    """The answer that a search has so far; None where it may be another one."""
    rows, decision = _decided(search)
    if decision.verdict != MISSING or not decision.listed or decision.chosen is None:
        return None
    chosen = next(found for row, found in rows if row is decision.chosen)
    if search.over(chosen) > MORE_OVER or _imitates(chosen):
        return None
    if not alone(decision.chosen, [row for row, _ in rows]):
        return None
    if _more_is_promised(search, chosen):
        return None
    found = answered(setup, search, rows, decision, known, seed)
    most = GROWS if set(decision.chosen.kinds) == {GEOMETRY} else MATTERS
    qualities = (found.training, found.heldout)
    predicts = all(q.after < min(most * q.before, PREDICTS * q.noise_floor) for q in qualities)
    return found if predicts else None


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


def _imitates(chosen: Found) -> bool:
    """Whether relaxation stands beside another effect, for it may be there for a friction or a loop that was not fitted
    in its place."""
    return len(chosen.members) > 1 and any(m.id == BRANCH for m in chosen.members)


def takes(campaign: Campaign, known: ParameterSet) -> bool:
    """Whether a session holds nothing but free responses of a robot of six degrees of freedom, whose file has no effect
    that is not linear."""
    free = all(m.experiment.free for m in campaign.measurements)
    return free and set(effect_values(known)) <= set(LINEAR)


def _prepared(campaign: Campaign, known: ParameterSet) -> tuple[Setup, list[Decay]]:
    setup = informed(set_up(arranged(replace(campaign, parameters=known)), known))
    builder = RobotBuilder.of(known)
    return setup, [decay_of(t, builder) for t in setup.fitted]
