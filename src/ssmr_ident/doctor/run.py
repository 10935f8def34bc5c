"""A rig's diagnosis from its campaign: search, held-out recordings, decision, answer."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import replace

import numpy as np
from threadpoolctl import threadpool_limits

from ssmr_ident.compare.network import NO_GROUND
from ssmr_ident.core.errors import InputError
from ssmr_ident.core.parameter import ParameterSet
from ssmr_ident.diagnose.arranged import arranged
from ssmr_ident.diagnose.diagnosis import Diagnosis
from ssmr_ident.diagnose.setup import keep_back
from ssmr_ident.doctor.decide import MISSING, Decision, decide
from ssmr_ident.doctor.fitted import FAR_OFF, SHORT
from ssmr_ident.doctor.held import held_fit, innovations, interleaved, with_motion
from ssmr_ident.doctor.left import left
from ssmr_ident.doctor.networks import also_at
from ssmr_ident.doctor.result import Examined, answer, errors, predictions
from ssmr_ident.doctor.search import searched
from ssmr_ident.doctor.table import Row
from ssmr_ident.estimate.exact import polish
from ssmr_ident.estimate.finer import finer
from ssmr_ident.estimate.held_force import held
from ssmr_ident.estimate.model_error import under_model_error
from ssmr_ident.estimate.network import network_problem
from ssmr_ident.estimate.problem import problem_of
from ssmr_ident.estimate.stretches import in_stretches
from ssmr_ident.estimate.values import Fit, Problem, Start
from ssmr_ident.experiments import EXPERIMENTS
from ssmr_ident.experiments.campaign import Campaign, Measurement
from ssmr_ident.physics.network import NETWORK

Array = np.ndarray
Progress = Callable[[str, int, int], None]


SHOWN = 6
"""Rows of the table that are held against what was kept back."""


def diagnose(
    campaign: Campaign,
    parameters: ParameterSet | None = None,
    seed: int = 0,
    progress: Progress | None = None,
    budget: float = math.inf,
) -> Diagnosis:
    """Locate, name and prove what the baseline of a rig or a network leaves out.

    Parameters
    ----------
    campaign : Campaign
        With ``baseline: sdof`` or ``network``.
    parameters : ParameterSet, optional
        What is known beforehand, in place of the session's own file.
    seed : int
        Of chance; nothing here uses it yet, and the answer does not depend on it.
    progress : callable, optional
    budget : float [s]
        After which nothing new is tried; the answer names what was not.

    Raises
    ------
    InputError
        No rig, an experiment that no rig has, or nothing to fit.
    """
    known = campaign.parameters if parameters is None else parameters
    with threadpool_limits(1, user_api="blas"):
        return answer(examined(campaign, known, progress, budget))


def examined(campaign: Campaign, known: ParameterSet, progress: Progress | None, budget: float) -> Examined:
    """The table and the decision."""
    _checked(campaign)
    campaign = arranged(campaign)  # sums round differently in another order
    targets, heldout, by_us = roles(campaign)
    alone = campaign.session.baseline != NETWORK
    fitted = problem_of(targets, known) if alone else network_problem(targets, known)
    notes: list[str] = []
    if heldout:
        kept: Problem | None = problem_of(heldout, known, fitted) if alone else network_problem(heldout, known)
        if by_us:
            names = ", ".join(m.name for m in heldout)
            notes.append(f"the session holds nothing back, so {names} did not enter the fits that decided")
    else:
        fitted, kept = interleaved(fitted)
        if kept is None:
            notes.append("too little motion to keep any of it back: no error on unseen data is given")
        else:
            spans = ", ".join(f"{p.time[0]:.4g} to {p.time[-1]:.4g} s" for p in kept.pieces)
            notes.append(f"{targets[0].name} is the only recording: {spans} were kept back, with starts of their own")
    if alone and any("acceleration_2" in m.recording for m in campaign.measurements):
        notes.append("acceleration_2 was not compared: a rig of one mass moves as one, a network has several bodies")
    search = searched(fitted, budget, progress)
    if search.problem.held:
        kept = held(kept) if kept is not None else None
        notes.append("the recordings follow a force that is held from one value of the log to the next: it is taken so")
    if heldout and kept is not None:
        kept = with_motion(kept, search.problem)
        if kept is None:
            notes.append(f"nothing moves in {', '.join(m.name for m in heldout)}: no error on unseen data is given")
    horizon = search.problem.horizon
    if math.isfinite(horizon):
        kept = in_stretches(kept, horizon) if kept is not None else None
        notes.append(
            f"the motion is chaotic: after {horizon:.2g} periods a start no longer tells where it is, so that the "
            "recordings were fitted in stretches of that length, each with a start of its own"
        )
    rows = tuple(_with_left(r, search.problem) if len(r.ids) != 1 and not r.generic else r for r in search.table())
    rows, decision = _decided(rows, search.problem, kept, known)
    problem, rows, decision = _in_small_steps(rows, decision, search.problem, kept, known)
    rows, decision = _with_intervals(rows, decision, problem)
    if not alone:
        notes += _of_network(fitted, rows, decision)
    if search.untried:
        notes.append(f"not tried within the budget: {', '.join(search.untried)}")
    return Examined(campaign, known, search, rows, decision, search.problem, kept, by_us, tuple(notes))


def _of_network(problem: Problem, rows: Sequence[Row], decision: Decision) -> list[str]:
    notes = ["one effect was looked for, at every spring, body and sensor; a second beside it was not"]
    if not problem.layout.grounded:
        notes.append(NO_GROUND)
    others = also_at(rows, decision.chosen) if decision.chosen is not None else ()
    if others and decision.verdict == MISSING:
        notes.append(f"the same at {' or '.join(others)} fits these recordings as well")
    return notes


def _checked(campaign: Campaign) -> None:
    baseline = campaign.session.baseline
    for m in campaign.measurements:
        if not m.experiment.fitted_under(baseline):
            possible = [name for name, kind in EXPERIMENTS.items() if kind.fitted_under(baseline)]
            raise InputError(
                f"{campaign.session.folder / 'session.yaml'}: {m.name}",
                f"a {m.entry.experiment} cannot be diagnosed with baseline {campaign.session.baseline}",
                f"Make a session of its own of it; here: {', '.join(possible)}",
            )


def roles(campaign: Campaign) -> tuple[list[Measurement], list[Measurement], bool]:
    """Recordings to fit, those kept back, and whether that was our choice."""
    targets = [m for m in campaign.measurements if m.entry.role != "heldout"]
    heldout = [m for m in campaign.measurements if m.entry.role == "heldout"]
    if not targets:
        raise InputError(
            f"{campaign.session.folder}/session.yaml: recordings",
            "all are heldout, so nothing may be fitted",
            "Give at least one recording role: target",
        )
    if heldout or len(targets) == 1:
        return targets, heldout, False
    return (*keep_back(targets), True)


def _with_left(row: Row, problem: Problem) -> Row:
    assert row.fit is not None
    return replace(row, left=left(problem, row.fit))


def _decided(
    rows: tuple[Row, ...], problem: Problem, kept: Problem | None, known: ParameterSet
) -> tuple[tuple[Row, ...], Decision]:
    """The decision, once what is named, and what that is held against, has predicted what was kept back."""
    asked: set[str] = set()
    near: Fit | None = None
    while True:
        decision = decide(rows)
        chosen = decision.chosen
        shown = [r for k, r in enumerate(rows) if k < SHOWN or not r.ids or r is chosen or _alone_of(r, chosen)]
        wanted = [r.name for r in shown if r.name not in asked] if kept is not None else []
        if kept is None or not wanted:
            return rows, decision
        asked.update(wanted)
        found = []
        for row in rows:
            found.append(_held(row, problem, kept, known, near) if row.name in wanted else row)
            near = found[-1].kept or near
        near = min((r.kept for r in found if r.kept is not None), key=lambda f: f.cost, default=None)
        rows = tuple(_held_nearer(r, problem, kept, known, near) if r.name in wanted else r for r in found)


def _in_small_steps(
    rows: tuple[Row, ...], decision: Decision, problem: Problem, kept: Problem | None, known: ParameterSet
) -> tuple[Problem, tuple[Row, ...], Decision]:
    """What was chosen, fitted and held against what was kept back once more in smaller steps; as it was where it then
    leaves one size of the noise more, for it has lost its way."""
    chosen = decision.chosen
    small = finer(problem)
    if chosen is None or chosen.fit is None or not chosen.fit.node.beside or small is problem:
        return problem, rows, decision
    fit = polish(small, chosen.fit.node, Start(chosen.fit.point, chosen.fit.nuisances), SHORT)
    if not fit.cost < chosen.fit.cost + problem.samples:
        return problem, rows, decision
    new = replace(chosen, fit=fit)
    if kept is not None and chosen.kept is not None:
        new = _held(new, small, finer(kept), known, chosen.kept)
    return small, *_in_place_of(chosen, new, rows, decision)


def _with_intervals(rows: tuple[Row, ...], decision: Decision, problem: Problem) -> tuple[tuple[Row, ...], Decision]:
    """What was chosen, its deviations by what it leaves."""
    chosen = decision.chosen
    if chosen is None or chosen.fit is None:
        return rows, decision
    return _in_place_of(chosen, replace(chosen, fit=under_model_error(problem, chosen.fit)), rows, decision)


def _in_place_of(chosen: Row, new: Row, rows: tuple[Row, ...], decision: Decision) -> tuple[tuple[Row, ...], Decision]:
    return tuple(new if r is chosen else r for r in rows), replace(decision, chosen=new)


def _held(row: Row, problem: Problem, kept: Problem, known: ParameterSet, near: Fit | None) -> Row:
    """A row with its error on what was kept back."""
    held = held_fit(kept, row.fit, near) if row.fit is not None else None
    if held is None:
        return row
    heldout = float(np.mean(errors(predictions(kept, held, known))))
    return replace(row, kept=held, heldout=heldout, innovations=innovations(kept, held, problem))


def _held_nearer(row: Row, problem: Problem, kept: Problem, known: ParameterSet, near: Fit | None) -> Row:
    """A row with its error once more from the starts of the best, where it is far off: it may have been caught."""
    if row.kept is None or near is None or row.kept.cost < FAR_OFF * near.cost:
        return row
    again = _held(row, problem, kept, known, near)
    return again if again.kept is not None and again.kept.cost < row.kept.cost else row


def _alone_of(row: Row, chosen: Row | None) -> bool:
    """Whether a row is one law of a pair that was chosen."""
    return chosen is not None and len(row.ids) == 1 < len(chosen.ids) and row.ids[0] in chosen.ids and not row.generic
