"""The search: generic members of every kind, named laws along the motion that the best of them has, second effects."""

from __future__ import annotations

import math
import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field, replace

import numpy as np

from ssmr_ident.doctor.decide import FRICTION
from ssmr_ident.doctor.laws import Proposal, proposals, simpler
from ssmr_ident.doctor.rules import FORMULA, HALVED, SECOND, TIE, UNIT
from ssmr_ident.doctor.table import Row, row_of
from ssmr_ident.estimate.coarser import coarser
from ssmr_ident.estimate.exact import polish
from ssmr_ident.estimate.generic import STATIC, branch, by_recording, changing, clip, delay, lag, memory, rider, static
from ssmr_ident.estimate.instrument import at_outputs
from ssmr_ident.estimate.motion import motion
from ssmr_ident.estimate.node import Member, Node
from ssmr_ident.estimate.noise import left_white, own_noise
from ssmr_ident.estimate.regression import regressed
from ssmr_ident.estimate.shooting import shot
from ssmr_ident.estimate.smoother import smoothed
from ssmr_ident.estimate.stretches import in_stretches, predictable, sampled
from ssmr_ident.estimate.values import Fit, Problem, Start, with_noises
from ssmr_ident.physics.effects import CATALOGUE

Array = np.ndarray
Progress = Callable[[str, int, int], None]

TRIED_LAWS, FULL_LAWS = 7, 3
"""Named laws that get a short fit, most promising first, two formulas of one effect at the most; and a full one."""

LOST = 3
"""Of these, the most promising that are begun by multiple shooting where a short fit stays far above the fit along
whose motion they promise most."""

BEGUN, SHORT, FULL = 2, 6, 25
"""Gauss-Newton steps: the fewest move the states at the begin, in which all is linear."""

OFFERED = 5
"""Fits, the best ones, that are offered back to what lies below them."""

OVER_NOISE_SECOND = 1.25
"""What a first effect leaves, in sizes of white noise, from which a second one is looked for."""

FULL_KINDS = 4
"""Members that get a full fit, those that a short one has brought farthest."""

FIRSTS = 2
"""Named effects, the best ones, beside which a second is looked for."""

NEAR = 200.0
"""Log evidence below the best one, on every sample, up to which a model is fitted to every sample; so is what leaves
``FORMULA`` of the misfit at the most, for means over several samples are a little off themselves."""

FAR_OFF = 2.0
"""Factor on the least cost beyond which a short fit is not followed where another explains everything."""

NEAR_NOISE = 1.5
"""Mean square of whitened residuals up to which nothing much is left to find."""


@dataclass(eq=False)
class Search:
    """What has been fitted, and under which noise; ``far`` is what was left behind on fewer samples."""

    problem: Problem
    until: float = math.inf
    fits: list[Fit] = field(default_factory=list)
    untried: list[str] = field(default_factory=list)
    far: list[Row] = field(default_factory=list)

    @property
    def late(self) -> bool:
        return time.monotonic() > self.until

    def rows(self) -> tuple[Row, ...]:
        base = next(f for f in self.fits if not f.node.members)
        zero = row_of(base, self.problem).log_evidence
        rows = [row_of(f, self.problem, zero) for f in self.fits if math.isfinite(f.cost)]
        return tuple(sorted(rows, key=lambda r: -r.log_evidence))

    def add(self, fit: Fit) -> Fit:
        """Keep the better of two fits of one node."""
        same = [f for f in self.fits if f.node.name == fit.node.name]
        if same and same[0].cost <= fit.cost:
            return same[0]
        self.fits = [f for f in self.fits if f not in same] + [fit]
        return fit


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
    paths = [smoothed(p, problem.frequency, problem.size) for p in problem.pieces]
    baseline = Node(problem.baseline)
    base = search.add(_from_paths(problem, baseline, regressed(problem, paths, baseline), paths))
    say("fitting the baseline", 1, 1)
    members = kinds(problem, paths)
    short = []
    for index, member in enumerate(members):
        say("any shape of every kind", index, len(members))
        if search.late:
            search.untried.append(member.name)
            continue
        node = base.node.with_member(member)
        short.append(polish(problem, node, Start(joined(node, base), carried(node, base)), SHORT))
    best = {f.node.name: f for f in sorted(short, key=lambda f: -f.cost)}  # of several starts of one
    for rank, fit in enumerate(sorted(best.values(), key=lambda f: f.cost)):
        search.add(_finished(search, fit, base, paths) if rank < FULL_KINDS and not search.late else fit)
    _offered_back(search)
    search = _with_white(search)
    _named_along(search, say)
    _offered_back(search)
    search = _with_own_noise(search)
    _second(search, say)
    _exchanged(search, say)
    return search if problem is whole else _in_full(search, whole, begins, say)


def kinds(problem: Problem, paths: Sequence[Array]) -> list[Member]:
    """Generic members of every kind that these recordings can show, and the links of the sensor chain."""
    f = problem.frequency
    found = [static(problem, paths), memory(problem, paths), changing(problem)]
    found.append(branch(problem, 0.5 / (2.0 * math.pi * f)))
    other = by_recording(problem)
    found += [other] if other else []
    found += [rider(problem, ratio * f) for ratio in (0.6, 1.5)]
    piece = problem.pieces[0]
    if any(p.driven for p in problem.pieces):
        found.append(delay(piece.step * piece.every, problem.begin))
    if 2 in piece.orders:
        most = min(0.5 * problem.bandwidth_hz, 0.4 * piece.rate)
        found += [lag(min(ratio * f, most), problem.bandwidth_hz) for ratio in (3.0, 12.0)]
    found += at_outputs(problem)
    ranges = {p.name: p for p in CATALOGUE["sensor_saturation"].parameters}
    for c, (name, unit) in enumerate(zip(piece.channels, piece.units, strict=True)):
        parameter = {
            "m/s^2": "range_m_s2",
            "m": "range_m",
            "m/s": "range_m_s",
            "rad": "range_rad",
            "rad/s": "range_rad_s",
        }
        if parameter[unit] in ranges:
            most = max(float(np.abs(p.y[:, c]).max()) for p in problem.pieces)
            found.append(clip(name, 0.95 * most, parameter[unit], unit))
    return found


def _from_paths(problem: Problem, node: Node, point: Array, paths: Sequence[Array]) -> Fit:
    return polish(problem, node, shot(problem, node, Start(point, paths=tuple(paths))), FULL)


def joined(node: Node, fit: Fit) -> Array:
    """A node's coordinates as another fit has them, at their usual values where it has them not."""
    old = {id(c): float(p) for c, p in zip(fit.node.coordinates, fit.point, strict=True)}
    usual = {"K_m_N_m": 0.1, "rider_share": 0.03, "delay_s": 0.3}
    return np.array([old.get(id(c), usual.get(c.name, c.mean)) for c in node.coordinates])


def carried(node: Node, fit: Fit) -> tuple[Array, ...]:
    """A fit's nuisances for a node with other linear states."""
    was, now, found = fit.node, node, []
    sizes = {"lag": 2, "branch": 1, "rider": 2}
    for nuisance in fit.nuisances:
        at, kept = 2, {}
        for member in (m for m in was.members if m.linear):
            kept[id(member)] = nuisance[at : at + sizes[member.linear]]
            at += sizes[member.linear]
        states = [nuisance[:2]]
        states += [kept.get(id(m), np.zeros(sizes[m.linear])) for m in now.members if m.linear]
        hidden = nuisance[was.linear_states : was.states]
        states.append(hidden if len(hidden) == now.hidden_states else np.zeros(now.hidden_states))
        found.append(np.concatenate([*states, nuisance[was.states :]]))
    return tuple(found)


def _finished(search: Search, near: Fit, base: Fit, paths: Sequence[Array], point: Array | None = None) -> Fit:
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
        point = regressed(problem, paths, near.node) if near.node.generic else joined(near.node, base)
    far = _from_paths(problem, near.node, point, paths)
    return far if far.cost < full.cost else full


def _offered_up(search: Search) -> None:
    """A model with a member of any shape that is worse than the one without, which it contains, begins again there."""
    for fit in [f for f in search.fits if len(f.node.members) > 1]:
        for member in (m for m in fit.node.members if m.tables):
            poorer = next((f for f in search.fits if f.node.name == fit.node.without(member).name), None)
            if poorer is not None and poorer.cost < fit.cost - UNIT:
                node = replace(poorer.node, members=(*poorer.node.members, member))
                search.add(polish(search.problem, node, Start(joined(node, poorer), carried(node, poorer)), SHORT))


def over(fit: Fit, problem: Problem) -> float:
    """Mean square of the whitened residuals: 1 for noise alone."""
    return fit.chi2 / max(problem.samples, 1)


def _offered_back(search: Search, count: int = OFFERED) -> None:
    """What the best models' fits have found is offered to the poorer ones with a member, or a part of its formula,
    dropped."""
    for fit in sorted(search.fits, key=lambda f: f.cost)[:count]:
        for member in fit.node.members:
            node = fit.node.without(member)
            poorer = next((f for f in search.fits if f.node.name == node.name), None)
            node = poorer.node if poorer else node
            found = polish(search.problem, node, Start(joined(node, fit), carried(node, fit)), SHORT)
            if poorer is None or found.cost < poorer.cost - UNIT:
                search.add(polish(search.problem, found.node, Start(found.point, found.nuisances), FULL))
        for node in simpler(fit.node):
            search.add(polish(search.problem, node, Start(joined(node, fit), carried(node, fit)), SHORT))


def _named_along(search: Search, say: Progress, beside: Sequence[Member] = (), begun: Sequence[Fit] = ()) -> None:
    """Named laws along the best motion, and again where one of them follows it better than what they began from."""
    near = min(begun or search.fits, key=lambda f: f.cost)
    while not search.late:
        _named(search, say, near, beside)
        best = min((f for f in search.fits if set(beside) <= set(f.node.members)), key=lambda f: f.cost, default=near)
        excess = max(near.cost - search.problem.samples, 0.0)
        if best.cost > near.cost - max(2.0 * SECOND, HALVED * excess):
            return
        near = best


def _named(search: Search, say: Progress, best: Fit, beside: Sequence[Member] = ()) -> None:
    """Named laws beside given members, begun along the motion of a fit that follows it well."""
    paths = motion(search.problem, best)
    problem, short = search.problem, []
    base = next(f for f in search.fits if not f.node.members)
    offers = proposals(problem, best, paths, beside)
    if over(best, problem) > NEAR_NOISE:  # along a motion that is not the recorded one promises are worth little
        offers = sorted(offers, key=lambda offer: _scored(problem, offer, best))
    offers = _varied(offers)
    for index, offer in enumerate(offers):
        say("named laws", index, len(offers))
        if search.late:
            search.untried.append(offer.node.name)
            continue
        near = polish(problem, offer.node, Start(offer.start.point, carried(offer.node, best)), SHORT)
        if near.cost > FAR_OFF * best.cost and index < LOST:
            far = polish(problem, offer.node, shot(problem, offer.node, offer.start), SHORT)
            near = min(near, far, key=lambda f: f.cost)
        short.append((near, offer.start.point))
        for node in simpler(near.node):
            less = polish(problem, node, Start(joined(node, near), carried(node, near)), SHORT)
            short.append((less, less.point))
    for rank, (near, point) in enumerate(sorted(short, key=lambda s: s[0].cost)):
        whole = rank < FULL_LAWS and not search.late
        search.add(_finished(search, near, base, paths, point) if whole else near)


def _scored(problem: Problem, offer: Proposal, best: Fit) -> float:
    """Cost after the first steps, with Schwarz's price of an offer's parameters."""
    begun = polish(problem, offer.node, Start(offer.start.point, carried(offer.node, best)), BEGUN)
    return begun.cost + len(offer.node.members[-1].coordinates) * math.log(problem.samples)


def _varied(offers: Sequence[Proposal]) -> list[Proposal]:
    """The most promising, of each effect two formulas at the most."""
    chosen: list[Proposal] = []
    for offer in offers:
        effect = offer.node.members[-1].id
        if sum(o.node.members[-1].id == effect for o in chosen) < 2 and len(chosen) < TRIED_LAWS:
            chosen.append(offer)
    return chosen


def _with_white(search: Search) -> Search:
    """Everything again under the white noise that the best fit leaves."""
    best = search.rows()[0].fit
    assert best is not None
    problem = left_white(search.problem, best)
    return replace(search, problem=problem, fits=[_again(problem, f, SHORT) for f in search.fits])


def _again(problem: Problem, fit: Fit, steps: int) -> Fit:
    return polish(problem, fit.node, Start(fit.point, fit.nuisances), steps)


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
    new = replace(search, problem=problem, fits=fits)
    _offered_back(new)
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
    kept = near + [r for r in rows if r not in near and _judges(r, rows, near)]
    whole = in_stretches(whole, predictable(search.problem, best))
    chaotic = math.isfinite(whole.horizon)
    if chaotic:  # what a start does to the motion is no longer linear: the best one's states begin all others
        paths = [smoothed(p, whole.frequency, whole.size) for p in whole.pieces]
        found = polish(whole, best.node, shot(whole, best.node, Start(best.point, paths=tuple(paths))), SHORT)
    else:
        found = polish(whole, best.node, _at_begins(best, begins), SHORT)
    problem = left_white(whole, found)
    problem = with_noises(problem, own_noise(problem, found))
    new = replace(search, problem=problem, fits=[], far=[r for r in rows if r not in kept])
    for index, row in enumerate(kept):
        say("every sample", index, len(kept))
        assert row.fit is not None
        start = Start(row.fit.point, carried(row.fit.node, found)) if chaotic else _at_begins(row.fit, begins)
        start = Start(found.point, found.nuisances) if row.fit is best else start
        new.add(polish(problem, row.fit.node, start, SHORT if row in near or not row.ids else BEGUN))
    for fit in sorted(new.fits, key=lambda f: f.cost)[:FIRSTS]:
        new.add(_again(problem, fit, FULL))
    _offered_back(new, 1)
    _offered_up(new)
    return new


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


def _second(search: Search, say: Progress) -> None:
    """A second effect beside the best named ones, where something in any shape is certainly better than these."""
    tried: set[tuple[str, ...]] = set()
    while len(tried) < FIRSTS and not search.late:
        rows = search.rows()
        firsts = [r for r in rows if len(r.ids) == 1 and not r.generic and r.ids not in tried]
        if not firsts or rows[0].log_evidence < SECOND:
            return
        row = firsts[0]
        assert row.fit is not None
        tried.add(row.ids)
        _beside(search, say, row.fit)
        _offered_back(search)
        best = search.rows()[0]
        if row.over < OVER_NOISE_SECOND or (not best.generic and best.over < OVER_NOISE_SECOND):
            return


def _exchanged(search: Search, say: Progress) -> None:
    """Other laws in place of the first of two, which was chosen before the second was known; where one of them is
    better, others in place of the second."""
    pair = _best_pair(search)
    if pair is None:
        return
    _named(search, say, pair, pair.node.members[1:])
    _offered_back(search)
    found = _best_pair(search)
    laws = [m.id for m in pair.node.members]
    for law in (m for m in (found.node.members if found else ()) if m.id not in laws and m.law is not None):
        single = [r.fit for r in search.rows() if r.ids == (law.id,) and not r.generic]
        if single and single[0] is not None:
            _beside(search, say, single[0])
            _offered_back(search)


def _best_pair(search: Search) -> Fit | None:
    """Two named effects, where these are certainly better than any model with fewer."""
    pair = next((r.fit for r in search.rows() if len(r.ids) == 2 and not r.generic), None)
    fewer = min(f.cost for f in search.fits if len(f.node.members) < 2)
    return pair if pair is not None and pair.cost < fewer - 2.0 * SECOND else None


def _beside(search: Search, say: Progress, first: Fit) -> None:
    """Every kind in any shape beside a named effect, and named ones along the best of these."""
    law, problem = first.node.members[0], search.problem
    paths = motion(problem, first)
    offers = kinds(problem, paths)
    own = [m for m in offers if m.tables and m.kind == law.kind]
    own += [static(problem, paths, law.variable)] if law.variable else []
    if law.id == FRICTION:
        own += [memory(problem, paths)] if law.kind == STATIC else [static(problem, paths, "v")]
    shaped = [search.add(_near(problem, first, m, FULL)) for m in own]
    alone, beside = row_of(first, problem), [row_of(f, problem) for f in shaped]
    better = [r for r in beside if r.log_evidence > alone.log_evidence + TIE]
    short = []
    others = [m for m in offers if not (m.tables and m.kind == law.kind)]
    for index, member in enumerate(others):
        say("second effects", index, len(others))
        if search.late:
            search.untried.append(f"{first.node.name} + {member.name}")
            continue
        short.append(_near(problem, first, member, BEGUN if member.tables else SHORT))
    short = [_again(problem, f, SHORT) for f in sorted(short, key=lambda f: f.cost)[:FULL_KINDS]]
    gain = max((row_of(f, problem).log_evidence - alone.log_evidence for f in short), default=0.0)
    if alone.over < OVER_NOISE_SECOND and not better and gain < UNIT:
        return
    full = [
        search.add(polish(problem, fit.node, Start(fit.point, fit.nuisances), FULL))
        for fit in sorted(short, key=lambda f: f.cost)[:2]
    ]
    if not search.late:
        _named_along(search, say, [law], [*full, *shaped, first])


def _near(problem: Problem, fit: Fit, member: Member, steps: int) -> Fit:
    node = fit.node.with_member(member)
    return polish(problem, node, Start(joined(node, fit), carried(node, fit)), steps)
