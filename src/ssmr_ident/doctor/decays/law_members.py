"""Laws beside a fit: which are tried, on which recordings, and how far each is led on."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from ssmr_ident.diagnose.scan import promising, scan
from ssmr_ident.doctor.decays.closed_slopes import closed_slopes
from ssmr_ident.doctor.decays.formulas import in_other_formulas, parts_of
from ssmr_ident.doctor.decays.laws import (
    NEAR,
    SCREENED_S,
    begun_at,
    left_known,
    let_go,
    loudest,
    on_whole,
    starts,
)
from ssmr_ident.doctor.decays.linear_members import (
    OFFERED,
    members_beside,
    within_reach,
)
from ssmr_ident.doctor.decide import certain
from ssmr_ident.doctor.robots.answer import table
from ssmr_ident.doctor.robots.cooled import (
    FAR_OFF,
    FURTHER,
    LAWS,
    Progress,
    Tried,
    cooled,
    cooled_alone,
    field,
    led,
    to_the_end,
)
from ssmr_ident.doctor.robots.found import Found, Search, cost_of
from ssmr_ident.doctor.robots.members import Member, any_shape
from ssmr_ident.doctor.rules import MORE_OVER
from ssmr_ident.identify.fitting.descent import descend
from ssmr_ident.identify.fitting.joint import differentiate, evaluate
from ssmr_ident.identify.trials import Trial
from ssmr_ident.physics.effects import CATALOGUE

RELEASED = 3
"""Times that a law's states at the release are looked for anew, at the most."""

ALIKE = 1.2
"""Factor on the cost of an effect's best fit up to which another formula, or start, of it goes on, and on the least of
all, up to which a member of any shape begins laws."""


def laws_beside(search: Search, first: Found, say: Progress) -> None:
    """Laws beside a fit."""
    assert first.fit is not None
    search.has_laws |= not first.members
    laws = _promising(search, first, [m for m in members_beside(search, first) if not m.linear])
    laws += any_shape(first.fit) if laws and not first.members else []
    which = loudest(search.decays)
    loud, ended = [search.decays[index] for index in which], list[Tried]()
    follows = search.over(first) < NEAR
    near, whole = (closed_slopes(loud), closed_slopes(search.decays)) if follows else (differentiate, differentiate)
    trials = [d.trial.until(SCREENED_S[1]) for d in loud]
    for start in starts(search.decays, which, first, follows):
        tried = [(way, begun_at(start, loud, way)) for way in laws]
        ended += cooled(tried, trials, say, slopes=near)
    least = min((cost_of(f) for _, f in ended), default=math.inf)
    shapes = [(m, f) for m, f in ended if m.generic and cost_of(f) < ALIKE * least]
    ended += [pair for member, fit in shapes for pair in parts_of(member, fit, laws)]
    least = min((cost_of(f) for _, f in ended), default=math.inf)
    for index, (member, fit) in enumerate(going := field(ended, LAWS, FAR_OFF * least, ALIKE)):
        say("laws on whole recordings", index, len(going))
        if search.over(search.best) < MORE_OVER:
            before, fit = cost_of(fit), led(fit, 1.0, 1, near)
            if not within_reach(cost_of(fit), before, min(least, _linear_on(search, which, trials))):
                continue
        search.add(Found((*first.members, member), None, on_whole(search.decays, fit, first.fit.nuisances, whole)))


def _linear_on(search: Search, which: Sequence[int], trials: Sequence[Trial]) -> float:
    """Least cost on some recordings, or first parts of them, of what is linear and was simulated."""
    fits = [f.fit for f in search.all if f.fit is not None and f.linear is not None]
    return min(cost_of(evaluate(trials, f.model, f.point, [f.nuisances[i] for i in which])) for f in fits)


def _promising(search: Search, first: Found, laws: list[Member]) -> list[Member]:
    """Laws that a score test beside a fit that follows the recordings speaks for, and those that begin at a threshold,
    of which it says nothing; all beside a fit that does not follow them or has left what is known to do so, and where
    another effect is as good as certain, which is then held against all."""
    if first.fit is None or search.over(first) > NEAR or left_known(first.fit) or _something_is_certain(search):
        return laws
    asked = [CATALOGUE[name] for name in dict.fromkeys(m.id for m in laws)]
    found = scan(differentiate(first.fit), [effect for effect in asked if not effect.sudden])
    likely = {suspect.effect for group in found for suspect in group if promising(suspect)}
    return [m for m in laws if m.id in likely or CATALOGUE[m.id].sudden]


def _something_is_certain(search: Search) -> bool:
    rows = [row for row, _ in table(search)]
    base = next(row for row in rows if not row.ids)
    return any(certain(row, base) for row in rows)


def settled(search: Search, say: Progress, found: Found | None = None) -> None:
    """A law to its end, the best model's if none is given; where more than noise is left, from other states at the
    release, in one of which it may be caught."""
    best = found or search.best
    if best.fit is None or not best.members:
        return
    say("the best law to its end", 0, 1)
    best = replace(best, fit=to_the_end(best.fit))
    for _ in range(RELEASED):
        anew = let_go(search.decays, best.model, best.point)
        if search.over(best) < MORE_OVER or not cost_of(anew) < best.cost - 1.0:
            break
        best = replace(best, fit=min(anew, to_the_end(cooled_alone(anew)), key=cost_of))
    search.add(best)


def offered_to_each(search: Search) -> None:
    """What the best two pairs have found, offered to each of their effects alone."""
    pairs = [f for f in search.found if len(f.members) == 2 and f.fit is not None]
    for pair in sorted(pairs, key=lambda f: f.cost)[:OFFERED] if search.best in pairs else []:
        assert pair.fit is not None
        for member, other in (pair.members, pair.members[::-1]):
            model, keep = pair.model.without_effect(other.id)
            begun = evaluate(pair.fit.trials, model, pair.point[keep], pair.fit.nuisances)
            alone = min((f.cost for f in search.found if [m.id for m in f.members] == [member.id]), default=math.inf)
            if np.isfinite(begun.rss) and cost_of(onward := cooled_alone(begun)) < ALIKE * alone:
                search.add(Found((replace(member, model=model),), None, to_the_end(onward)))


def in_formulas(search: Search, law: Found, say: Progress) -> None:
    """A law in other formulas of its effect, begun where it is."""
    assert law.fit is not None
    for index, (member, fit) in enumerate(forms := in_other_formulas(law.members[-1], law.fit)):
        say("other formulas", index, len(forms))
        search.add(Found((*law.members[:-1], member), None, descend(fit, FURTHER, plain=True)))
