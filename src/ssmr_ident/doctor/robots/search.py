"""The search in any recordings of a robot: every model by the simulator, led from all that it leaves as noise to the
noise alone."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from ssmr_ident.diagnose.prepared import prepared
from ssmr_ident.diagnose.scan import candidates, promising, scan
from ssmr_ident.diagnose.setup import Setup
from ssmr_ident.doctor.robots.cooled import FURTHER, TRUSTED, Progress, cooled, cooled_alone, from_known, to_the_end
from ssmr_ident.doctor.robots.found import Found, Search, cost_of
from ssmr_ident.doctor.robots.members import BY_KIND, Member, members
from ssmr_ident.doctor.robots.spans import spanned
from ssmr_ident.doctor.rules import MORE_OVER, SECOND
from ssmr_ident.identify.fitting.descent import descend
from ssmr_ident.identify.fitting.joint import JointFit, differentiate, evaluate
from ssmr_ident.identify.trials import Trial
from ssmr_ident.physics.effects import CATALOGUE
from ssmr_ident.physics.extended import OFFSET

NEAR = 1.5
"""RMS of a model's whitened residuals up to which a score test beside it says what may be missing."""

OFFERED = 2
"""Models, the best ones, that are offered to the baseline."""


@dataclass(frozen=True, eq=False)
class Sliding:
    """A session under one law of sliding: its set-up, whose recordings hold the law, and what has been fitted."""

    setup: Setup
    search: Search


def searched(setups: Sequence[Setup], progress: Progress | None = None) -> Sliding:
    """Fit the baseline and what may be beside it, under the law of sliding that follows the recordings best.

    Parameters
    ----------
    setups : sequence of Setup
        The session under each law that its file leaves open.
    progress : callable, optional
    """
    say = progress or (lambda stage, done, total: None)
    say("fitting the baseline", 0, 1)
    setups = [replace(s, fitted=tuple(t.as_it_is() for t in s.fitted)) for s in setups]
    fits = [from_known(s.fitted, s.model) for s in setups]
    noise = prepared(min(fits, key=cost_of))
    laws = [_begun(s, fit, noise) for s, fit in zip(setups, fits, strict=True)]
    say("fitting the baseline", 1, 1)
    laws.sort(key=lambda law: law.search.baseline.cost)
    first, *others = laws
    _beside(first.search, first.search.baseline, say)
    for other in others:
        _offered(other.search, first.search)
        other.search.looked_at = first.search.looked_at
        first = min(first, other, key=lambda law: law.search.best.cost)
    _offered_back(first.search)
    _offered_on(first.search)
    _settled(first.search, say)
    if _leaves_a_second(first.search):
        _beside(first.search, first.search.best, say)
        _settled(first.search, say)
    return first


def _begun(setup: Setup, fit: JointFit, noise: Sequence[Trial]) -> Sliding:
    """The baseline at its best, its noise as the best of all has it."""
    trials = tuple(t.with_noises(other.noises) for t, other in zip(setup.fitted, noise, strict=True))
    fit = descend(evaluate(trials, fit.model, fit.point, fit.nuisances), FURTHER, plain=True)
    return Sliding(replace(setup, fitted=trials), Search(Found((), None, fit)))


def _beside(search: Search, first: Found, say: Progress) -> None:
    """Effects beside a model: from what is known, or from the model where that follows the recordings."""
    fit = first.fit
    assert fit is not None
    names = [e.id for e in candidates(fit, "rigid6") if e.id in BY_KIND]
    search.looked_at = max(search.looked_at, len(names))
    if search.over(first) < NEAR:
        near = _promised(fit, [name for name in names if name != OFFSET])
        begun = [(way, _at(fit, way)) for m in members(fit, near) for way in [m.from_nothing()]]
        begun += [(way, _gathered(fit, way)) for way in members(fit, [OFFSET] if OFFSET in names else [])[:1]]
    else:
        known = evaluate(fit.trials, fit.model, fit.model.as_known(fit.point), fit.nuisances)
        begun = [(way, _at(known, way)) for way in members(known, names)]
    begun += spanned(fit, names)
    for member, ended in cooled(begun, fit.trials, say, first=1, reach=1.0 / TRUSTED):
        search.add(Found((*first.members, member), None, descend(ended, FURTHER, plain=True)))


def _promised(fit: JointFit, names: Sequence[str]) -> list[str]:
    """Effects that a score test speaks for, and those that begin at a threshold, of which it says nothing."""
    effects = [CATALOGUE[name] for name in names]
    groups = scan(differentiate(fit), [effect for effect in effects if not effect.sudden])
    likely = {suspect.effect for group in groups for suspect in group if promising(suspect)}
    return [effect.id for effect in effects if effect.sudden or effect.id in likely]


def _leaves_a_second(search: Search) -> bool:
    """Whether a second effect may stand beside the best: where that leaves more than noise, or a straight line promises
    that one would be certain."""
    best = search.best
    if not best.members or search.over(best) > MORE_OVER:
        return bool(best.members)
    assert best.fit is not None
    effects = [e for e in candidates(best.fit, "rigid6") if e.id in BY_KIND]
    price = math.log(search.samples)
    return any(
        suspect.gain > 2.0 * SECOND + len(suspect.at) * price
        for group in scan(differentiate(best.fit), effects)
        for suspect in group
    )


def _at(start: JointFit, way: Member) -> JointFit:
    return evaluate(start.trials, way.model, np.concatenate([start.point, way.own]), start.nuisances)


def _gathered(start: JointFit, way: Member) -> JointFit:
    """A displaced centre of mass in place of contacts that have moved the other way: for pulls the same robot, which
    what is known of the contacts charges nothing for."""
    names = [u.name for u in way.model.unknowns]
    point = np.concatenate([start.point, way.own])
    for axis in "xy":
        if (shift := f"contact_shift_{axis}_m") in names:
            moved, offset = names.index(shift), names.index(f"{OFFSET}.offset_{axis}_m")
            point[offset] = way.model.unknowns[offset].scaled(-way.model.unknowns[moved].value(float(point[moved])))
            point[moved] = 0.0
    return evaluate(start.trials, way.model, point, start.nuisances)


def _offered(search: Search, other: Search) -> None:
    """What was found under another law of sliding."""
    for found in other.found:
        assert found.fit is not None
        assert search.baseline.fit is not None
        fit = evaluate(search.baseline.fit.trials, found.model, found.point, found.fit.nuisances)
        if np.isfinite(fit.rss):
            search.add(replace(found, fit=descend(cooled_alone(fit), FURTHER, plain=True)))


def _offered_back(search: Search) -> None:
    """What the best have found without their effects, offered to the baseline."""
    for found in sorted(search.found, key=lambda f: f.cost)[:OFFERED]:
        base = search.baseline.fit
        assert base is not None
        assert found.fit is not None
        begun = evaluate(base.trials, base.model, found.point[: len(base.point)], found.fit.nuisances)
        fit = descend(cooled_alone(begun), FURTHER, plain=True)
        if cost_of(fit) < cost_of(base):
            search.baseline = Found((), None, fit)


def _offered_on(search: Search) -> None:
    """The baseline at its end, offered to every effect as it is."""
    base = search.baseline.fit
    assert base is not None
    base = to_the_end(base)
    search.baseline = Found((), None, base)
    for found in tuple(search.found):
        (member,) = found.members
        way = replace(member, own=found.point[len(base.point) :])
        begun = _gathered(base, way) if member.id == OFFSET else _at(base, way)
        if np.isfinite(begun.rss):
            search.add(replace(found, fit=descend(begun, FURTHER, plain=True)))


def _settled(search: Search, say: Progress) -> None:
    """The best to its end."""
    best = search.best
    assert best.fit is not None
    say("the best to its end", 0, 1)
    if best.members:
        search.add(replace(best, fit=to_the_end(best.fit)))
    else:
        search.baseline = replace(best, fit=to_the_end(best.fit))
