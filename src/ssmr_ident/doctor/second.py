"""A second effect beside named ones, and two that stand exchanged one by one."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import replace

from ssmr_ident.doctor.decide import FRICTION
from ssmr_ident.doctor.fitted import (
    BEGUN,
    FULL,
    SHORT,
    Progress,
    Search,
    again,
    beside,
    best_paths,
    carried,
    joined,
    offered_back,
)
from ssmr_ident.doctor.kinds import kinds
from ssmr_ident.doctor.laws import FORMS, Proposal, proposals
from ssmr_ident.doctor.named import begun, named, named_along
from ssmr_ident.doctor.rules import OVER_NOISE, SECOND, TIE
from ssmr_ident.doctor.table import grain, log_evidence
from ssmr_ident.estimate.exact import polish
from ssmr_ident.estimate.generic import STATIC, memory, static
from ssmr_ident.estimate.motion import motion
from ssmr_ident.estimate.two_modes import riding
from ssmr_ident.estimate.values import Fit, Start

FULL_KINDS = 4
"""Members that get a full fit, those that a short one has brought farthest."""

PAIRS = 3
"""Pairs, the most promising along the motion of any shape, that are fitted at once."""

FIRSTS = 2
"""Named effects, the best ones, beside which a second is looked for."""


def second(search: Search, say: Progress) -> None:
    """A second effect beside the best named ones; beside the best alone, where nothing adds to that or is better."""
    tried: set[tuple[str, ...]] = set()
    while len(tried) < FIRSTS and not search.late:
        rows = search.rows()
        firsts = [r for r in rows if len(r.ids) == 1 and not r.generic and r.ids not in tried]
        if not firsts or rows[0].log_evidence < SECOND:
            return
        row = firsts[0]
        assert row.fit is not None
        tried.add(row.ids)
        adds = _beside(search, say, row.fit)
        offered_back(search)
        if not adds and search.rows()[0].log_evidence < row.log_evidence + TIE:
            return


def paired(search: Search, say: Progress) -> None:
    """Two laws at once, along the motion of a shape that is certainly better than any one law."""
    problem, rows = search.problem, search.rows()
    single = max((r.log_evidence for r in rows if len(r.ids) == 1 and not r.generic), default=-math.inf)
    shape = next((r for r in rows if len(r.ids) == 1 and r.generic), None)
    if search.late or shape is None or shape.fit is None or shape.log_evidence < single + max(SECOND, grain(rows)):
        return
    found = shape.fit
    paths, _ = best_paths(problem, found)
    offers: dict[frozenset[str], Proposal] = {}
    firsts = {o.node.members[-1].id: o for o in reversed(proposals(problem, found, paths))}
    for first in firsts.values():
        led = replace(found, node=first.node, point=first.start.point, nuisances=carried(first.node, found))
        for offer in proposals(problem, led, paths, first.node.members):
            names = frozenset(m.id for m in offer.node.members)
            if names not in offers or offer.promise > offers[names].promise:
                offers[names] = offer
    best, pairs = sorted(offers.values(), key=lambda o: -o.promise)[:PAIRS], []
    for index, offer in enumerate(best):
        say("two laws at once", index, len(best))
        if search.late:
            search.untried.append(offer.node.name)
            continue
        pairs.append(search.add(again(problem, begun(problem, offer, found), FULL)))
    if pairs:  # along a motion that two laws follow, either is asked for again
        pair = min(pairs, key=lambda f: f.cost)
        for member in pair.node.members:
            named(search, say, pair, [member])


def exchanged(search: Search, say: Progress) -> None:
    """Other laws in place of the first of two, which was chosen before the second was known; where one of them is
    better, others in place of the second."""
    pair = _best_pair(search)
    if pair is None:
        return
    named(search, say, pair, pair.node.members[1:])
    offered_back(search)
    found = _best_pair(search)
    laws = [m.id for m in pair.node.members]
    for law in (m for m in (found.node.members if found else ()) if m.id not in laws and m.law is not None):
        single = [r.fit for r in search.rows() if r.ids == (law.id,) and not r.generic]
        if single and single[0] is not None:
            _beside(search, say, single[0])
            offered_back(search)


def in_other_formulas(search: Search, say: Progress) -> None:
    """The laws of the best named model in the other formulas of their effects: of one law where any shape is better or
    more than noise is left, of two always, for what one leaves the other takes."""
    rows = search.rows()
    best = next((r for r in rows if r.ids and not r.generic), None)
    if best is None or best.fit is None:
        return
    if len(best.ids) == 1 and best.over < OVER_NOISE and rows[0].log_evidence < best.log_evidence + TIE:
        return
    found = best.fit
    paths, names = motion(search.problem, found), {f.node.name for f in search.fits}
    for law in (m for m in found.node.members if m.law is not None):
        beside = [m for m in found.node.members if m is not law]
        forms = [form for form in FORMS if form.effect == law.id]
        for index, offer in enumerate(proposals(search.problem, found, paths, beside, forms)):
            if offer.node.name in names:
                continue
            if search.late:
                search.untried.append(offer.node.name)
                continue
            say("other formulas", index, len(forms))
            search.add(again(search.problem, begun(search.problem, offer, found), FULL))


def _best_pair(search: Search) -> Fit | None:
    """Two named effects, where these are certainly better than any model with fewer."""
    rows = search.rows()
    pair = next((r for r in rows if len(r.ids) == 2 and not r.generic), None)
    fewer = max(r.log_evidence for r in rows if len(r.ids) < 2)
    return pair.fit if pair is not None and pair.log_evidence > fewer + max(SECOND, grain(rows)) else None


def _beside(search: Search, say: Progress, first: Fit) -> bool:
    """Every kind in any shape beside a named effect, and named ones along the best of these; whether any may stand."""
    law, problem = first.node.members[0], search.problem
    paths = motion(problem, first)
    offers = [*kinds(problem, paths), *(own.member for own in riding(problem))]
    own = [m for m in offers if m.tables and m.kind == law.kind]
    own += [static(problem, paths, law.variable)] if law.variable else []
    if law.id == FRICTION:
        own += [memory(problem, paths)] if law.kind == STATIC else [static(problem, paths, "v")]
    shaped = [search.add(beside(problem, first, m, FULL)) for m in own]
    if law.id == FRICTION:  # and without it: other shapes have friction in them
        pair = search.add(beside(problem, first, static(problem, paths, smooth=True), FULL))
        alone = pair.node.without(law)
        search.add(polish(problem, alone, Start(joined(alone, pair), carried(alone, pair)), FULL))
    short = []
    others = [m for m in offers if not (m.tables and m.kind == law.kind)]
    for index, member in enumerate(others):
        say("second effects", index, len(others))
        if search.late:
            search.untried.append(f"{first.node.name} + {member.name}")
            continue
        short.append(beside(problem, first, member, BEGUN if member.tables else SHORT))
    short = [again(problem, f, SHORT) for f in sorted(short, key=lambda f: f.cost)[:FULL_KINDS]]
    if not _may_stand(search, first, [*shaped, *short]):
        return False
    full = [
        search.add(polish(problem, fit.node, Start(fit.point, fit.nuisances), FULL))
        for fit in sorted(short, key=lambda f: f.cost)[:2]
    ]
    if not search.late:
        named_along(search, say, [law], [f for f in (*full, *shaped, first) if law in f.node.members])
    return True


def _may_stand(search: Search, first: Fit, pairs: Sequence[Fit]) -> bool:
    """Whether any law beside a first one may be certainly better than the best one alone: it takes what a member of its
    kind in any shape does at the most, and has one parameter at the least."""
    samples, rows = search.problem.samples, search.rows()
    single = max(log_evidence(r.fit, samples) for r in rows if len(r.ids) == 1 and not r.generic and r.fit is not None)
    least = min((f.cost - f.promised for f in pairs), default=math.inf)
    most = -0.5 * least - 0.5 * (first.dof + 1.0) * math.log(samples)
    return most > single + max(SECOND, grain(rows))
