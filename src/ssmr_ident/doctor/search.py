"""The search: generic members of every kind, named laws, second effects; then the table on every sample."""

from __future__ import annotations

import math
import time
from dataclasses import replace

from ssmr_ident.doctor.every_sample import ended, on_every_sample
from ssmr_ident.doctor.fitted import (
    SHORT,
    Progress,
    Search,
    again,
    beside,
    finished,
    offered_back,
    shapes_again,
    with_own_noise,
)
from ssmr_ident.doctor.kinds import kinds
from ssmr_ident.doctor.named import named_along
from ssmr_ident.doctor.networks import members_of_network
from ssmr_ident.doctor.second import FULL_KINDS, exchanged, in_other_formulas, paired, second
from ssmr_ident.estimate.baseline import BOTH_WHITE, on_few_samples
from ssmr_ident.estimate.exact import polish
from ssmr_ident.estimate.held_force import held, is_held
from ssmr_ident.estimate.network import paths_of
from ssmr_ident.estimate.noise import left_white
from ssmr_ident.estimate.two_modes import riding
from ssmr_ident.estimate.values import Problem
from ssmr_ident.physics.network import ONE


def searched(problem: Problem, budget: float = math.inf, progress: Progress | None = None) -> Search:
    """Fit the baseline and what may be beside it.

    Parameters
    ----------
    problem : Problem
    budget : float [s]
        Once it is spent nothing new is begun; what was not tried is named.
    progress : callable, optional
    """
    say = progress or (lambda stage, done, total: None)
    whole = problem
    say("fitting the baseline", 0, 1)
    problem, base, begins, share = on_few_samples(whole)
    search = Search(problem, time.monotonic() + budget)
    search.add(base)
    paths = paths_of(problem, base.node, base.point)
    alone = problem.layout == ONE
    say("fitting the baseline", 1, 1)
    members = kinds(problem, paths) if alone else members_of_network(problem, base, paths)
    short = []
    for index, member in enumerate(members):
        say("any shape of every kind", index, len(members))
        if search.late:
            search.untried.append(member.name)
            continue
        short.append(beside(problem, base, member, SHORT))
    short += [polish(problem, *own.start(base, paths), SHORT) for own in riding(problem)] if alone else []
    best = {f.node.name: f for f in sorted(short, key=lambda f: -f.cost)}  # of several starts of one
    for rank, fit in enumerate(sorted(best.values(), key=lambda f: f.cost)):
        search.add(finished(search, fit, base, paths) if rank < FULL_KINDS and not search.late else fit)
    if alone:
        shapes_again(search)
    offered_back(search)
    search = with_own_noise(search, BOTH_WHITE) if problem.drifts else _with_white(search)
    named_along(search, say)
    offered_back(search)
    search = with_own_noise(search)
    if alone:
        second(search, say)
        paired(search, say)
    offered_back(search)
    exchanged(search, say)
    if alone:
        in_other_formulas(search, say)
        offered_back(search)
    if problem.samples < whole.samples:
        search = on_every_sample(search, whole, begins, share, say)
    else:
        ended(search)
    named_best = next((r.fit for r in search.rows() if r.ids and not r.generic), None)
    if named_best is not None and not whole.held and is_held(search.problem, named_best) and not search.late:
        return searched(held(whole), search.until - time.monotonic(), progress)
    return search


def _with_white(search: Search) -> Search:
    """Everything again under the white noise that the best fit leaves."""
    best = search.rows()[0].fit
    assert best is not None
    problem = left_white(search.problem, best)
    return replace(search, problem=problem, fits=[again(problem, f, SHORT) for f in search.fits], offered=set())
