"""What a search has fitted, and how what one model has found is offered to its neighbours."""

from __future__ import annotations

import math
import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field, replace

import numpy as np

from ssmr_ident.doctor.laws import simpler
from ssmr_ident.doctor.rules import UNIT
from ssmr_ident.doctor.table import Row, log_evidence, row_of
from ssmr_ident.estimate.exact import polish
from ssmr_ident.estimate.motion import motion
from ssmr_ident.estimate.network import paths_of
from ssmr_ident.estimate.node import STATES_OF, Member, Node
from ssmr_ident.estimate.noise import LARGEST_ORDER, own_noise
from ssmr_ident.estimate.regression import regressed
from ssmr_ident.estimate.shooting import shot
from ssmr_ident.estimate.values import Fit, Problem, Start, Stop, with_noises
from ssmr_ident.physics.network import ONE

Array = np.ndarray
Progress = Callable[[str, int, int], None]
"""Called with what is being done, how much of it is done, and of how much."""

BEGUN, SHORT, FULL = 2, 6, 25
"""Gauss-Newton steps: the fewest move the states at the begin, in which all is linear."""

ENDED = 0.1
"""Fall of the cost that a straight line promises at the end of a fit: a parameter is then within a third of its
standard deviation of its best."""

OFFERED = 5
"""Fits, the best ones, that are offered back to what lies below them."""

FAR_OFF = 2.0
"""Factor on the least cost beyond which a short fit is not followed where another explains everything."""

NEAR_NOISE = 1.5
"""Mean square of whitened residuals up to which nothing much is left to find."""


@dataclass(eq=False)
class Search:
    """What has been fitted, and under which noise; ``far`` is what was left behind on fewer samples, as it would be on
    these; ``offered`` what was offered to its neighbours."""

    problem: Problem
    until: float = math.inf
    fits: list[Fit] = field(default_factory=list)
    untried: list[str] = field(default_factory=list)
    far: list[Row] = field(default_factory=list)
    offered: set[Fit] = field(default_factory=set)

    @property
    def late(self) -> bool:
        return time.monotonic() > self.until

    def rows(self) -> tuple[Row, ...]:
        base = next(f for f in self.fits if not f.node.members)
        zero = row_of(base, self.problem).log_evidence
        rows = [row_of(f, self.problem, zero) for f in self.fits if math.isfinite(f.cost)]
        return tuple(sorted(rows, key=lambda r: -r.log_evidence))

    def table(self) -> tuple[Row, ...]:
        """Rows, and of kinds without a single effect among them the best one that was left behind, without its fit."""
        rows = self.rows()
        behind = [replace(r, fit=None) for r in self.far if len(r.ids) == 1]
        alone = {r.kinds: r for r in (*reversed(behind), *reversed(rows)) if len(r.ids) == 1}
        return tuple(sorted({*rows, *alone.values()}, key=lambda r: -r.log_evidence))

    def add(self, fit: Fit) -> Fit:
        """Keep the better of two fits of one node."""
        same = [f for f in self.fits if f.node.name == fit.node.name]
        if same and same[0].cost <= fit.cost:
            return same[0]
        self.fits = [f for f in self.fits if f not in same] + [fit]
        return fit


def from_paths(problem: Problem, node: Node, point: Array, paths: Sequence[Array]) -> Fit:
    return polish(problem, node, shot(problem, node, Start(point, paths=tuple(paths))), FULL)


def joined(node: Node, fit: Fit) -> Array:
    """A node's coordinates as another fit has them, at their usual values where it has them not."""
    old = {id(c): float(p) for c, p in zip(fit.node.coordinates, fit.point, strict=True)}
    usual = {"K_m_N_m": 0.1, "rider_share": 0.03, "delay_s": 0.3}
    return np.array([old.get(id(c), usual.get(c.name, c.mean)) for c in node.coordinates])


def carried(node: Node, fit: Fit) -> tuple[Array, ...]:
    """A fit's nuisances for a node with other linear states."""
    was, now, found = fit.node, node, []
    for nuisance in fit.nuisances:
        at, kept = was.motion_states, {}
        for member in (m for m in was.members if m.linear):
            kept[id(member)] = nuisance[at : at + STATES_OF[member.linear]]
            at += STATES_OF[member.linear]
        states = [nuisance[: was.motion_states]]
        states += [kept.get(id(m), np.zeros(STATES_OF[m.linear])) for m in now.members if m.linear]
        hidden = nuisance[was.linear_states : was.states]
        states.append(hidden if len(hidden) == now.hidden_states else np.zeros(now.hidden_states))
        found.append(np.concatenate([*states, nuisance[was.states :]]))
    return tuple(found)


def again(problem: Problem, fit: Fit, steps: int) -> Fit:
    return polish(problem, fit.node, Start(fit.point, fit.nuisances), steps)


def best_paths(problem: Problem, fit: Fit) -> tuple[Sequence[Array], bool]:
    """Motion along which laws are asked for, and whether it is the recorded one: that of a fit that follows it; else
    that of logs which show where the mass is."""
    if over(fit, problem) <= NEAR_NOISE:
        return motion(problem, fit), True
    if all((piece.orders == 0).any() and not piece.based for piece in problem.pieces):
        return paths_of(problem, fit.node, fit.point), True
    return motion(problem, fit), False


def beside(problem: Problem, fit: Fit, member: Member, steps: int) -> Fit:
    """A fit with a member beside it; a shape, whose gain a straight line foretells, moves only where it gains
    evidence so."""
    node = fit.node.with_member(member)
    start = Start(joined(node, fit), carried(node, fit))
    if member.tables:
        still = polish(problem, node, start, 0)
        if log_evidence(still, problem.samples) + 0.5 * still.promised < log_evidence(fit, problem.samples):
            return still
    return polish(problem, node, start, steps)


def further(problem: Problem, fit: Fit) -> Fit:
    """A fit led on: by damped steps, and from where an undamped one leads, along which the data hardly see and damping
    keeps all from moving; damped steps then find back to the floor of a valley that bends."""
    found = again(problem, fit, SHORT) if fit.stop is Stop.STEPS else fit
    if found.ahead is None or found.promised <= ENDED:
        return found
    return min(found, polish(problem, found.node, found.ahead, SHORT), key=lambda f: f.cost)


def over(fit: Fit, problem: Problem) -> float:
    """Mean square of the whitened residuals: 1 for noise alone."""
    return fit.chi2 / max(problem.samples, 1)


def finished(search: Search, near: Fit, base: Fit, paths: Sequence[Array], point: Array | None = None) -> Fit:
    """A short fit to its end; by multiple shooting too, unless it or another one explains everything."""
    problem = search.problem
    least = min((f for f in search.fits), key=lambda f: f.cost)
    explained = over(least, problem) < NEAR_NOISE
    if explained and near.cost > FAR_OFF * least.cost:
        return near
    full = polish(problem, near.node, Start(near.point, near.nuisances), FULL)
    if over(full, problem) < NEAR_NOISE or explained:
        return full
    if point is None:
        plain = near.node.generic and problem.layout == ONE
        point = regressed(problem, paths, near.node) if plain else joined(near.node, base)
    far = from_paths(problem, near.node, point, paths)
    return far if far.cost < full.cost else full


def shapes_again(search: Search) -> None:
    """Shapes begin again along the motion of the best fit, which the recordings alone do not tell as well."""
    best = min(search.fits, key=lambda f: f.cost)
    paths = motion(search.problem, best)
    for fit in [f for f in search.fits if f is not best and f.node.generic and f.node.members[0].tables]:
        start = Start(regressed(search.problem, paths, fit.node), carried(fit.node, best))
        near = polish(search.problem, fit.node, start, SHORT)
        if near.cost < fit.cost:
            search.add(again(search.problem, near, FULL))


def offered_back(search: Search, count: int = OFFERED) -> None:
    """What the best models' fits, and the best two named effects', have found is offered to the poorer ones with a
    member, or a part of its formula, dropped."""
    ranked = sorted(search.fits, key=lambda f: f.cost)
    pairs = [f for f in ranked[count:] if len(f.node.members) > 1 and not f.node.generic]
    for fit in [f for f in ranked[:count] + pairs[:1] if f not in search.offered]:
        search.offered.add(fit)
        for member in fit.node.members:
            node = fit.node.without(member)
            poorer = next((f for f in search.fits if f.node.name == node.name), None)
            found = polish(search.problem, node, Start(joined(node, fit), carried(node, fit)), SHORT)
            if poorer is None or found.cost < poorer.cost - UNIT:
                search.add(polish(search.problem, found.node, Start(found.point, found.nuisances), FULL))
        for node in simpler(fit.node):
            search.add(polish(search.problem, node, Start(joined(node, fit), carried(node, fit)), SHORT))


def offered_up(search: Search) -> None:
    """A model with a member of any shape that is worse than the one without, which it contains, begins again there."""
    for fit in [f for f in search.fits if f.node.members]:
        for member in (m for m in fit.node.members if m.tables):
            poorer = next((f for f in search.fits if f.node.name == fit.node.without(member).name), None)
            if poorer is not None and poorer.cost < fit.cost - UNIT:
                node = replace(poorer.node, members=(*poorer.node.members, member))
                search.add(polish(search.problem, node, Start(joined(node, poorer), carried(node, poorer)), SHORT))


def with_own_noise(search: Search, largest_order: int = LARGEST_ORDER) -> Search:
    """Everything again under the noise that the best fit leaves, from where it was."""
    best = search.rows()[0].fit
    assert best is not None
    problem = with_noises(search.problem, own_noise(search.problem, best, largest_order))
    near = FAR_OFF * best.cost
    fits = [
        polish(problem, f.node, Start(f.point, f.nuisances), SHORT if f.cost < near or not f.node.members else 0)
        for f in search.fits
        if math.isfinite(f.cost)
    ]
    new = replace(search, problem=problem, fits=fits, offered=set())
    offered_back(new)
    return new
