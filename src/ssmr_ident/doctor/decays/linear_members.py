"""Members that are linear in motion: fitted in closed form from all of their starts, offered to their neighbours."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from ssmr_ident.doctor.decays.laws import LAST, NEAR, exact, loudest
from ssmr_ident.doctor.decays.linear import fit_linear
from ssmr_ident.doctor.decays.recordings import thinned
from ssmr_ident.doctor.robots.found import Found, Search, cost_of
from ssmr_ident.doctor.robots.members import Member, members
from ssmr_ident.identify.fitting.descent import descend
from ssmr_ident.identify.fitting.joint import evaluate

THIN_S, EVERY = 1.5, 2
"""Of the loudest decay of each kind, what starts of linear members are chosen on: its first part, every so many
blocks."""

TRIED, CLOSER, FULL = 3, 6, 12
"""Steps of every start of a linear member, of the chosen ones, and of the best on whole recordings."""

CHOSEN, LAST_ONES = 3, 2
"""Starts of a linear member that go on, and of these to whole recordings."""

RACE, AHEAD, AT_REST, NEARLY = 20, 10.0, 1.0, 20.0
"""Steps of linear models by the simulator, at the most; times the last gain that is still to be had; gain of the cost
at which a model is at rest, and what it may lie above the least."""

OFFERED = 2
"""Models, the best ones, that are offered to those below them."""


def members_beside(search: Search, first: Found) -> list[Member]:
    """All members beside a fit, from nought where that follows the recordings."""
    assert first.fit is not None
    follows = search.over(first) < NEAR
    return [m.from_nothing() if first.members or follows else m for m in members(first.fit)]


def from_all_starts(search: Search, first: Found, ways: Sequence[Member]) -> Found | None:
    """A linear member from all of its starts, beside a fit and beside what is known."""
    thin = [thinned(search.decays[index], THIN_S, EVERY) for index in loudest(search.decays)]
    count = len(first.model.physics)
    starts = [first.point, np.concatenate([np.zeros(count), first.point[count:]])]
    tried = [
        (way, fit)
        for way in ways
        for start in starts
        if (fit := fit_linear(thin, way.model, np.concatenate([start, way.own]), TRIED)) is not None
    ]
    led = [
        (way, fit)
        for way, begun in sorted(tried, key=lambda pair: pair[1].cost)[:CHOSEN]
        if (fit := fit_linear(thin, way.model, begun.point, CLOSER)) is not None
    ]
    whole = [
        (way, fit)
        for way, begun in sorted(led, key=lambda pair: pair[1].cost)[:LAST_ONES]
        if (fit := fit_linear(search.decays, way.model, begun.point, FULL)) is not None
    ]
    if not whole:
        return None
    way, fit = min(whole, key=lambda pair: pair[1].cost)
    return Found((*first.members, way), fit, None)


def simulated(search: Search, found: Found) -> Found:
    """A linear model by the simulator, in which the states at the release are fewer: begun from the model without its
    last member where that follows the recordings better."""
    if found.fit is not None:
        return found
    assert found.linear is not None
    fit = exact(search.decays, found.linear)
    poorer = next((f.fit for f in search.all if f.members == found.members[:-1]), None)
    if poorer is not None and cost_of(poorer) < cost_of(fit):
        own = found.point[len(poorer.point) :], found.members[-1].own
        begun = [
            evaluate(poorer.trials, found.model, np.concatenate([poorer.point, at]), poorer.nuisances) for at in own
        ]
        fit = min(fit, descend(min(begun, key=cost_of), LAST, plain=True), key=cost_of)
    new = led_on(replace(found, fit=fit))
    search.put(found, new)
    return new


def within_reach(now: float, before: float, least: float) -> bool:
    """Whether a cost may still come near the least one, by what its last step has gained."""
    return now - AHEAD * (before - now) < least + NEARLY


def led_on(found: Found) -> Found:
    """One step further by differences."""
    assert found.fit is not None
    fit = descend(found.fit, 1, plain=True)
    return replace(found, fit=fit, gained=found.cost - cost_of(fit))


def raced(search: Search) -> None:
    """Linear models that may still be the best, by what their last step has gained, a step at a time."""
    for _ in range(RACE):
        least = search.best.cost
        going = [f for f in search.all if f.fit is not None and all(m.linear for m in f.members) and f.gained > AT_REST]
        going = [f for f in going if within_reach(f.cost, f.cost + f.gained, least)]
        if not going:
            return
        for found in going:
            search.put(found, led_on(found))


def offered_back(search: Search) -> None:
    """What the best have found without their members, offered to the baseline."""
    base = search.baseline
    assert base.linear is not None
    count = len(base.point)
    for found in sorted(search.found, key=lambda f: f.cost)[:OFFERED]:
        fit = fit_linear(search.decays, base.model, found.point[:count])
        if fit is not None and fit.cost < base.linear.cost - 1.0:
            base = Found((), fit, exact(search.decays, fit))
    search.baseline = base


def offered_down(search: Search) -> None:
    """What the best two linear effects have found together, offered to each of them alone."""
    pairs = [f for f in search.found if len(f.members) == 2 and f.linear is not None]
    for pair in sorted(pairs, key=lambda f: f.cost)[:OFFERED]:
        values = pair.model.split(pair.point)[1]
        for member in pair.members:
            single = next((f for f in search.found if [m.id for m in f.members] == [member.id]), None)
            if single is None or single.linear is None:
                continue
            own = [c.unknown.scaled(values[c.effect][c.parameter.name]) for c in single.model.free]
            point = np.concatenate([pair.point[: len(single.model.physics)], own])
            fit = fit_linear(search.decays, single.model, point)
            if fit is not None and fit.cost < single.linear.cost - 1.0:
                search.found = [Found(single.members, fit, None) if f is single else f for f in search.found]
