"""The table again on every sample: what the decision may rest on."""

from __future__ import annotations

import math
from collections import Counter
from collections.abc import Sequence
from dataclasses import replace

from ssmr_ident.doctor.decide import held_against, without_both
from ssmr_ident.doctor.fitted import (
    BEGUN,
    ENDED,
    FULL,
    Progress,
    Search,
    carried,
    further,
    offered_back,
    offered_up,
    with_own_noise,
)
from ssmr_ident.doctor.rules import FORMULA, HALVED, SECOND, TIE
from ssmr_ident.doctor.table import Row
from ssmr_ident.estimate.earlier import earlier
from ssmr_ident.estimate.exact import polish
from ssmr_ident.estimate.network import paths_of
from ssmr_ident.estimate.noise import left_white, own_noise
from ssmr_ident.estimate.shooting import shot
from ssmr_ident.estimate.stretches import in_stretches, predictable
from ssmr_ident.estimate.values import Fit, Problem, Start, with_noises

NEAR = 200.0
"""Log evidence, on every sample, by which a model may come out better than some samples foretell: means over several of
them are a little off themselves."""

ROUNDS = 4
"""Fits, one after the other, by which a model that may still be the best goes to its end."""


def on_every_sample(search: Search, whole: Problem, begins: Sequence[int], share: float, say: Progress) -> Search:
    """The table on every sample, of what the decision may rest on.

    Parameters
    ----------
    search : Search
    whole : Problem
    begins : sequence of int
        The piece of the search's problem that is at the begin of each of the whole one's.
    share : float
        Of the motion, that the search looked at.
    say : callable
    """
    rows = search.rows()
    kept = decisive(rows, share, whole.samples)
    for best in (r.fit for r in rows if r.fit is not None):  # one may burst where only others were looked at
        stretched, found = _followed(search.problem, whole, best, begins)
        if math.isfinite(found.cost):
            break
    whole, chaotic = stretched, math.isfinite(stretched.horizon)
    problem = left_white(whole, found)
    problem = with_noises(problem, own_noise(problem, found))
    new = replace(search, problem=problem, fits=[], offered=set(), far=[])
    for index, row in enumerate(kept):
        say("every sample", index, len(kept))
        assert row.fit is not None
        if row.fit is best:
            start = Start(found.point, found.nuisances)
        elif chaotic:  # there the best one's states begin all others
            start = Start(row.fit.point, carried(row.fit.node, found))
        else:
            start = earlier(search.problem, row.fit, whole, begins)
        new.add(polish(problem, row.fit.node, start, BEGUN))
    new = _under_less_noise(new)
    ended(new)
    offered_back(new, 1)
    offered_up(new)
    new.far = _scaled([r for r in rows if r not in kept], rows, new.rows())
    return new


def _under_less_noise(search: Search) -> Search:
    """Again under the noise that the best leaves, where that is less than half of it in squares: the fit that it was
    taken from has lost its way."""
    for _ in range(ROUNDS):
        best = search.rows()[0].fit
        assert best is not None
        if best.left > HALVED * search.problem.samples:
            break
        search = with_own_noise(search)
    return search


def _followed(search: Problem, whole: Problem, fit: Fit, begins: Sequence[int]) -> tuple[Problem, Fit]:
    """A fit on every sample, in stretches that its motion can be foretold over."""
    whole = in_stretches(whole, predictable(search, fit))
    if math.isfinite(whole.horizon):  # what a start does to the motion is no longer linear
        paths = paths_of(whole, fit.node, fit.point)
        return whole, polish(whole, fit.node, shot(whole, fit.node, Start(fit.point, paths=tuple(paths))), FULL)
    return whole, polish(whole, fit.node, earlier(search, fit, whole, begins), FULL)


def decisive(rows: Sequence[Row], share: float, samples: float) -> list[Row]:
    """Rows of a table on a share of the motion on which the decision may rest on all of it, ``samples``: single effects
    near the best, or that may be its formula; pairs that may stand, and what these are held against. What a straight
    line promises a row counts for it, and not against others."""
    foretold = {id(r): _foretold(r, share, samples) for r in rows}

    def as_it_is(row: Row) -> float:
        return foretold[id(row)]

    def at_best(row: Row) -> float:
        return foretold[id(row)] + 0.5 * _promised(row) / share

    base = next(r for r in rows if not r.ids)
    single = [r for r in rows if len(r.ids) == 1]
    law = max((as_it_is(r) for r in single if not r.generic), default=-math.inf)
    formula = FORMULA * (base.chi2 - rows[0].chi2)
    near = [r for r in single if at_best(r) > as_it_is(rows[0]) - NEAR or r.chi2 < rows[0].chi2 + formula]

    def may_stand(row: Row) -> bool:
        against = [held_against(row, which, rows) for which in (0, 1)]
        apart = [without_both(row, own) for own in against]
        most = [(1.0 - 0.5 * FORMULA) * max(own, key=as_it_is).chi2 for own in apart if own]
        return (
            bool(against[0])
            and at_best(row) > law + SECOND - NEAR
            and row.chi2 - _promised(row) < min(most, default=math.inf)
        )

    named = [r for r in rows if len(r.ids) == 2 and not r.generic]
    standing = [r for r in named if may_stand(r)]
    best = max(standing, key=as_it_is, default=base)
    pairs = [r for r in named if set(r.ids) & set(best.ids) and at_best(r) > as_it_is(best) - NEAR]
    for pair in [r for r in standing if at_best(r) > as_it_is(best) - NEAR]:
        pairs.append(pair)
        for which in (0, 1):
            against = sorted(held_against(pair, which, rows), key=at_best)
            pairs += [*against[-2:], *sorted(against, key=lambda r: r.chi2 - _promised(r))[:1]]
    top = max((r for r in [*single, *standing] if not r.generic), key=as_it_is, default=base)
    if top.chi2 > rows[0].chi2 + 0.5 * formula:  # whether its effect is there in another formula
        pairs += [r for r in rows if r.generic and len(r.ids) == 2 and r.ids[:1] == top.ids[:1]]
    wanted = {id(r) for r in (base, rows[0], *near, *pairs)}
    return [r for r in rows if id(r) in wanted]


def _promised(row: Row) -> float:
    return row.fit.promised if row.fit is not None else 0.0


def _foretold(row: Row, share: float, samples: float) -> float:
    """A row's log evidence on every sample, if the rest of the motion is like the share that it was fitted to."""
    assert row.fit is not None
    return -0.5 * row.fit.cost / share - 0.5 * row.fit.dof * math.log(samples)


def _scaled(left_behind: Sequence[Row], were: Sequence[Row], now: Sequence[Row]) -> list[Row]:
    """Rows of one table in the scale of another one, by the baseline and the best of those that are in both."""
    names = {r.name for r in now}
    best = next(r for r in were if r.name in names)
    same = next(r for r in now if r.name == best.name)
    base, after = (next(r for r in rows if not r.ids) for rows in (were, now))
    scale = (same.chi2 - after.chi2) / (best.chi2 - base.chi2) if best.chi2 < base.chi2 else 1.0
    return [
        replace(
            row, log_evidence=same.log_evidence + scale * (row.log_evidence - best.log_evidence),
            chi2=same.chi2 + scale * (row.chi2 - best.chi2), samples=same.samples,
        )
        for row in left_behind
    ]  # fmt: skip


def ended(search: Search) -> None:
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


def _wanted(row: Row, rows: Sequence[Row]) -> float:
    """Log evidence from which a row matters: a tie with the best; of two named effects, what makes them stand."""
    tie = rows[0].log_evidence - TIE
    if len(row.ids) < 2 or row.generic:
        return tie
    single = max((r.log_evidence for r in rows if len(r.ids) == 1 and not r.generic), default=-math.inf)
    return max(tie, single + SECOND)
