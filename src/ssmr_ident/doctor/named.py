"""Named laws, begun along the motion of a fit that follows it well."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import replace

from ssmr_ident.doctor.fitted import (
    BEGUN,
    FAR_OFF,
    NEAR_NOISE,
    SHORT,
    Progress,
    Search,
    best_paths,
    carried,
    finished,
    joined,
    over,
)
from ssmr_ident.doctor.laws import Proposal, proposals, simpler
from ssmr_ident.doctor.networks import laws_in_network
from ssmr_ident.doctor.rules import SECOND
from ssmr_ident.estimate.exact import polish
from ssmr_ident.estimate.latent_force import network_paths
from ssmr_ident.estimate.node import Member
from ssmr_ident.estimate.shooting import shot
from ssmr_ident.estimate.values import Fit, Problem, Start
from ssmr_ident.physics.network import ONE

TRIED_LAWS, FULL_LAWS = 7, 3
"""Named laws that get a short fit, most promising first, two formulas of one effect at the most; and a full one."""

LOST = 3
"""Of these, the most promising that are begun by multiple shooting where a short fit stays far above the fit along
whose motion they promise most."""


def named_along(search: Search, say: Progress, beside: Sequence[Member] = (), begun: Sequence[Fit] = ()) -> None:
    """Named laws along the best motion, and again where one of them follows it better than what they began from."""
    near = min(begun or search.fits, key=lambda f: f.cost)
    while not search.late:
        named(search, say, near, beside)
        best = min((f for f in search.fits if set(beside) <= set(f.node.members)), key=lambda f: f.cost, default=near)
        if best.cost > near.cost - 2.0 * SECOND:
            return
        near = best


def named(search: Search, say: Progress, best: Fit, beside: Sequence[Member] = ()) -> None:
    """Named laws beside given members, begun along the motion of a fit that follows it well."""
    problem, short = search.problem, []
    base = next(f for f in search.fits if not f.node.members)
    recorded = over(best, problem) <= NEAR_NOISE
    if problem.layout == ONE:
        paths, recorded = best_paths(problem, best)
        offers = proposals(problem, best, paths, beside)
    else:
        paths = network_paths(problem, best.node, best.point)
        offers = [replace(o, start=replace(o.start, paths=tuple(paths))) for o in laws_in_network(problem, search.fits)]
    if not recorded:  # along another motion promises are worth little
        offers = sorted(offers, key=lambda offer: _scored(problem, offer, best))
    offers = _varied(offers)
    for index, offer in enumerate(offers):
        say("named laws", index, len(offers))
        if search.late:
            search.untried.append(offer.node.name)
            continue
        near = begun(problem, offer, best, from_afar=index < LOST)
        short.append((near, offer.start.point))
        for node in simpler(near.node):
            less = polish(problem, node, Start(joined(node, near), carried(node, near)), SHORT)
            short.append((less, less.point))
    for rank, (near, point) in enumerate(sorted(short, key=lambda s: s[0].cost)):
        whole = rank < FULL_LAWS and not search.late
        search.add(finished(search, near, base, paths, point) if whole else near)


def begun(problem: Problem, offer: Proposal, best: Fit, from_afar: bool = True) -> Fit:
    """A proposal's short fit; by multiple shooting too, where that stays far above the fit along whose motion it is."""
    near = polish(problem, offer.node, Start(offer.start.point, carried(offer.node, best)), SHORT)
    if not from_afar or near.cost <= FAR_OFF * best.cost:
        return near
    far = polish(problem, offer.node, shot(problem, offer.node, offer.start), SHORT)
    return min(near, far, key=lambda f: f.cost)


def _scored(problem: Problem, offer: Proposal, best: Fit) -> float:
    """Cost after the first steps, with Schwarz's price of an offer's parameters."""
    first = polish(problem, offer.node, Start(offer.start.point, carried(offer.node, best)), BEGUN)
    return first.cost + len(offer.node.members[-1].coordinates) * math.log(problem.samples)


def _varied(offers: Sequence[Proposal]) -> list[Proposal]:
    """The most promising, of each effect two formulas at the most."""
    chosen: list[Proposal] = []
    for offer in offers:
        effect = offer.node.members[-1].id
        if sum(o.node.members[-1].id == effect for o in chosen) < 2 and len(chosen) < TRIED_LAWS:
            chosen.append(offer)
    return chosen
