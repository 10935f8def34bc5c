"""The search: generic members of every kind, named laws, second effects; then the table on every sample."""

from __future__ import annotations

import math
import time
from collections import Counter
from collections.abc import Sequence
from dataclasses import replace

from ssmr_ident.doctor.fitted import (
    BEGUN,
    ENDED,
    FAR_OFF,
    FULL,
    SHORT,
    Progress,
    Search,
    again,
    beside,
    carried,
    finished,
    further,
    offered_back,
    offered_up,
    shapes_again,
)
from ssmr_ident.doctor.kinds import kinds
from ssmr_ident.doctor.named import named_along
from ssmr_ident.doctor.networks import members_of_network
from ssmr_ident.doctor.rules import FORMULA, SECOND, TIE
from ssmr_ident.doctor.second import FULL_KINDS, exchanged, in_other_formulas, paired, second
from ssmr_ident.doctor.table import Row, grain
from ssmr_ident.estimate.baseline import baseline_fit
from ssmr_ident.estimate.coarser import coarser
from ssmr_ident.estimate.exact import polish
from ssmr_ident.estimate.network import paths_of
from ssmr_ident.estimate.noise import left_white, own_noise
from ssmr_ident.estimate.shooting import shot
from ssmr_ident.estimate.stretches import in_stretches, predictable, sampled
from ssmr_ident.estimate.values import Fit, Problem, Start, with_noises
from ssmr_ident.physics.network import ONE

NEAR = 200.0
"""Log evidence below the best one, on every sample, up to which a model is fitted to every sample; so is what leaves
``FORMULA`` of the misfit at the most, for means over several samples are a little off themselves."""


ROUNDS = 4
"""Fits, one after the other, by which a model that may still be the best goes to its end."""


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
    problem, begins = sampled(coarser(whole))
    search = Search(problem, time.monotonic() + budget)
    say("fitting the baseline", 0, 1)
    base = search.add(baseline_fit(problem))
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
    best = {f.node.name: f for f in sorted(short, key=lambda f: -f.cost)}  # of several starts of one
    for rank, fit in enumerate(sorted(best.values(), key=lambda f: f.cost)):
        search.add(finished(search, fit, base, paths) if rank < FULL_KINDS and not search.late else fit)
    if alone:
        shapes_again(search)
    offered_back(search)
    search = _with_white(search)
    named_along(search, say)
    offered_back(search)
    search = _with_own_noise(search)
    if alone:
        second(search, say)
        paired(search, say)
    offered_back(search)
    exchanged(search, say)
    if alone:
        in_other_formulas(search, say)
        offered_back(search)
    if problem is not whole:
        return _in_full(search, whole, begins, say)
    _ended(search)
    return search


def _with_white(search: Search) -> Search:
    """Everything again under the white noise that the best fit leaves."""
    best = search.rows()[0].fit
    assert best is not None
    problem = left_white(search.problem, best)
    return replace(search, problem=problem, fits=[again(problem, f, SHORT) for f in search.fits], offered=set())


def _with_own_noise(search: Search) -> Search:
    """Everything again under the noise that the best fit leaves, from where it was."""
    best = search.rows()[0].fit
    assert best is not None
    problem = with_noises(search.problem, own_noise(search.problem, best))
    near = FAR_OFF * best.cost
    fits = [
        polish(problem, f.node, Start(f.point, f.nuisances), SHORT if f.cost < near or not f.node.members else 0)
        for f in search.fits
        if math.isfinite(f.cost)
    ]
    new = replace(search, problem=problem, fits=fits, offered=set())
    offered_back(new)
    return new


def _in_full(search: Search, whole: Problem, begins: Sequence[int], say: Progress) -> Search:
    """The table again on every sample: what comes near the best, and of each kind the best single member."""
    rows = search.rows()
    best = rows[0].fit
    assert best is not None
    share = search.problem.samples / whole.samples
    base = next(f for f in search.fits if not f.node.members)
    reach = best.cost + max(2.0 * NEAR * share, FORMULA * (base.cost - best.cost))
    near = [r for r in rows if r.fit is not None and r.fit.cost < reach]
    if not _pairs_matter(rows, FORMULA * (base.cost - best.cost)):
        near = [r for r in near if len(r.ids) < 2]
    kept = near + [r for r in rows if r not in near and _judges(r, rows, near)]
    whole = in_stretches(whole, predictable(search.problem, best))
    chaotic = math.isfinite(whole.horizon)
    if chaotic:  # what a start does to the motion is no longer linear: the best one's states begin all others
        paths = paths_of(whole, best.node, best.point)
        found = polish(whole, best.node, shot(whole, best.node, Start(best.point, paths=tuple(paths))), FULL)
    else:
        found = polish(whole, best.node, _at_begins(best, begins), FULL)
    problem = left_white(whole, found)
    problem = with_noises(problem, own_noise(problem, found))
    new = replace(search, problem=problem, fits=[], offered=set(), far=[r for r in rows if r not in kept])
    for index, row in enumerate(kept):
        say("every sample", index, len(kept))
        assert row.fit is not None
        start = Start(row.fit.point, carried(row.fit.node, found)) if chaotic else _at_begins(row.fit, begins)
        start = Start(found.point, found.nuisances) if row.fit is best else start
        new.add(polish(problem, row.fit.node, start, BEGUN))
    _ended(new)
    offered_back(new, 1)
    offered_up(new)
    return new


def _ended(search: Search) -> None:
    """Models that may still come within a tie of the best go on until they have ended: those that promise half of what
    they lack, for valleys bend; in directions that the data hardly see too."""
    gone: Counter[str] = Counter()
    while not search.late:
        rows = search.rows()
        open_rows = [
            r
            for r in rows
            if r.fit is not None
            and r.fit.promised > ENDED
            and gone[r.name] < ROUNDS
            and r.log_evidence + r.fit.promised > _wanted(r, rows)
        ]
        if not open_rows:
            return
        fit = open_rows[0].fit
        assert fit is not None
        better = search.add(further(search.problem, fit))
        gone[fit.node.name] += 1 if better.cost < fit.cost - ENDED else ROUNDS


def _pairs_matter(rows: Sequence[Row], formula: float) -> bool:
    """Whether two named effects may stand, or something leaves too little beside any law to be its formula."""
    named = [r for r in rows if r.ids and not r.generic]
    law = max((r.log_evidence for r in named if len(r.ids) == 1), default=-math.inf)
    pair = max((r.log_evidence for r in named if len(r.ids) == 2), default=-math.inf)
    return pair > law + max(SECOND, grain(rows)) or rows[0].log_evidence > law + max(TIE, 0.5 * formula)


def _wanted(row: Row, rows: Sequence[Row]) -> float:
    """Log evidence from which a row matters: a tie with the best; of two named effects, what makes them stand."""
    tie = rows[0].log_evidence - TIE
    if len(row.ids) < 2 or row.generic:
        return tie
    single = max((r.log_evidence for r in rows if len(r.ids) == 1 and not r.generic), default=-math.inf)
    return max(tie, single + SECOND)


def _at_begins(fit: Fit, begins: Sequence[int]) -> Start:
    """A fit's point with its nuisances at the begins of the recordings."""
    return Start(fit.point, tuple(fit.nuisances[k] for k in begins))


def _judges(row: Row, rows: Sequence[Row], near: Sequence[Row]) -> bool:
    """Whether others are held against a row: the baseline, the best single member of its kind, and what a second effect
    has to beat."""
    if len(row.ids) < 2 and row is next((r for r in rows if r.kinds == row.kinds), None):
        return True
    pairs = [r for r in near if len(r.ids) == 2 and row.ids and r.ids[0] == row.ids[0]]
    return bool(pairs) and (row.generic or len(row.ids) == 1)
