"""The search in free decays: linear members in closed form, laws by the simulator, the best on whole recordings."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import replace

import numpy as np

from ssmr_ident.core.errors import InputError
from ssmr_ident.diagnose.noise_at_rest import coloured, colours_at_rest, colours_left
from ssmr_ident.diagnose.scan import promising, scan
from ssmr_ident.doctor.decays.formulas import in_other_formulas, parts_of
from ssmr_ident.doctor.decays.laws import (
    LAST,
    NEAR,
    SCREENED_S,
    begun_at,
    exact,
    left_known,
    let_go,
    loudest,
    on_whole,
    starts,
)
from ssmr_ident.doctor.decays.linear import fit_linear
from ssmr_ident.doctor.decays.linear_members import (
    OFFERED,
    from_all_starts,
    offered_back,
    offered_down,
    simulated,
)
from ssmr_ident.doctor.decays.recordings import Decay
from ssmr_ident.doctor.decays.small_motions import MORE_OVER, annealed
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
    to_the_end,
)
from ssmr_ident.doctor.robots.found import Found, Search, cost_of
from ssmr_ident.doctor.robots.members import GEOMETRY, KINDS, Member, any_shape, members
from ssmr_ident.doctor.rules import FORMULA, STATED
from ssmr_ident.identify.fitting.coordinates import Model
from ssmr_ident.identify.fitting.descent import descend
from ssmr_ident.identify.fitting.joint import differentiate, evaluate
from ssmr_ident.physics.effects import CATALOGUE

Array = np.ndarray

MATTERS = 0.95
"""Factor on the error, noise included, below which an effect makes it that matters on what it was not fitted to."""

RELEASED = 3
"""Times that a law's states at the release are looked for anew, at the most."""

ALIKE = 1.2
"""Factor on the cost of an effect's best fit up to which another formula, or start, of it goes on; and on the least of
all, up to which laws go on where a model leaves noise alone."""

REACH, SHARE = 50.0, 0.02
"""Cost above the least, of what is linear too, and share of the baseline's misfit, up to which a linear model is led on
by the simulator."""


def searched(decays: Sequence[Decay], model: Model, progress: Progress | None = None) -> Search:
    """Fit the baseline and what may be beside it.

    Parameters
    ----------
    decays : sequence of Decay
    model : Model
        The baseline.
    progress : callable, optional
    """
    search = begun(decays, model, progress)
    for _ in in_turn(search, progress):
        pass
    completed(search, progress)
    return search


def in_turn(search: Search, progress: Progress | None = None) -> Iterator[None]:
    """Effects beside a baseline, cheapest first: one linear effect, one law, two linear effects. It stops where what
    has been fitted may be the answer, and goes on where that is not certain."""
    say = progress or _silent
    _linear_beside(search, search.baseline, say)
    offered_back(search)
    if search.over(search.best) <= MORE_OVER:
        if _compared(search, say):
            yield
        return
    _single_laws(search, say)
    _finished(search, say)
    yield
    if not _leaves_a_second(search):
        return
    for first in _firsts(search, linear=True):
        _linear_beside(search, first, say)
    offered_down(search)
    if _compared(search, say):
        yield


def completed(search: Search, progress: Progress | None = None) -> None:
    """All that has not been tried: laws, and any two effects where the best one leaves more than noise."""
    say = progress or _silent
    if not search.has_laws:
        _single_laws(search, say)
    if search.best is not search.baseline and _leaves_a_second(search):
        for first in _firsts(search):
            _beside(search, first, say)
        _settled(search, say)
        _offered_to_each(search)
    _finished(search, say)


def _silent(stage: str, done: int, total: int) -> None:
    pass


def _single_laws(search: Search, say: Progress) -> None:
    """Laws beside the baseline, the best of them to its end and in other formulas; where any shape is better, too."""
    _laws_beside(search, search.baseline, say)
    _settled(search, say)
    for _ in range(2):
        if (law := _best_law(search)) is not None and search.over(law) > MORE_OVER:
            _settled(search, say, law)
            _other_formulas(search, law, say)
    _settled(search, say)


def _compared(search: Search, say: Progress) -> bool:
    """Whether the best may be the answer; laws are then fitted too, where the baseline follows the recordings."""
    _finished(search, say)
    if search.over(search.best) > NEAR or not (_matters(search) or _displaced(search)):
        return False
    if search.over(search.baseline) < NEAR and not search.has_laws:
        _laws_beside(search, search.baseline, say)
        _settled(search, say, _best_law(search))
        _finished(search, say)
    return True


def _best_law(search: Search) -> Found | None:
    """The best single law: short of its end it is no measure of what is linear."""
    laws = [f for f in search.found if len(f.members) == 1 and not f.members[0].linear and not f.members[0].generic]
    return min(laws, key=lambda f: f.cost, default=None)


def _matters(search: Search) -> bool:
    """Whether the best model leaves less than the baseline, noise included."""
    return search.over(search.best) < MATTERS * search.over(search.baseline)


def _leaves_a_second(search: Search) -> bool:
    """Whether the best model leaves more beyond noise than a formula may leave of what it takes."""
    best, base = search.best, search.baseline
    beyond = best.chi2 - search.samples
    return search.over(best) > MORE_OVER and beyond > FORMULA * (base.chi2 - best.chi2)


def _displaced(search: Search) -> bool:
    """Whether a displaced place may be certain, which makes no other error smaller."""
    base = search.baseline.linear
    places = [f.linear for f in search.found if f.linear is not None and {m.kind for m in f.members} == {GEOMETRY}]
    return base is not None and any(base.cost - fit.cost > 2.0 * STATED for fit in places)


def promised_beside(search: Search, found: Found) -> float:
    """Fall of n ln RSS that a straight line promises of the best effect beside a simulated model, but for those that
    were fitted beside it."""
    assert found.fit is not None
    own = [m.id for m in found.members]
    fitted = {f.members[-1].id for f in search.found if [m.id for m in f.members[:-1]] == own}
    asked = [CATALOGUE[name] for name in KINDS if name not in found.model.held and name not in fitted]
    return max((suspect.gain for group in scan(differentiate(found.fit), asked) for suspect in group), default=0.0)


def begun(decays: Sequence[Decay], model: Model, progress: Progress | None = None) -> Search:
    """The baseline alone.

    Raises
    ------
    InputError
        The robot as the file has it falls over.
    """
    say = progress or _silent
    known = colours_at_rest([d.trial for d in decays])
    decays = [d.coarse() for d in decays]
    say("fitting the baseline", 0, 1)
    fit = annealed(decays, model)
    if fit is None:
        raise InputError(
            "robot file", "describes a robot that falls over on its tires", "Check stiffness, mass and height"
        )
    search = Search(Found((), fit, exact(decays, fit, 1)), decays=tuple(decays), looked_at=len(KINDS))
    if not known and search.over(search.baseline) < NEAR:
        search = _heard(search)
    say("fitting the baseline", 1, 1)
    return search


def _heard(search: Search) -> Search:
    """The baseline under noise of the colour that it leaves."""
    base = search.baseline
    assert base.fit is not None
    colours = colours_left(base.fit)
    decays = tuple(replace(d, trial=coloured(d.trial, colours)) for d in search.decays)
    fit = fit_linear(decays, base.model, base.point)
    return search if fit is None else replace(search, baseline=Found((), fit, exact(decays, fit, 1)), decays=decays)


def _firsts(search: Search, linear: bool = False) -> list[Found]:
    """The best single effect, a linear one where that is asked."""
    named = [f for f in search.found if len(f.members) == 1 and not f.members[0].generic]
    named = [f for f in named if f.members[0].linear or not linear]
    return sorted(named, key=lambda f: f.cost)[:1]


def _beside(search: Search, first: Found, say: Progress) -> None:
    """All members beside a fit."""
    first = _linear_beside(search, first, say)
    _laws_beside(search, first, say)


def _members_beside(search: Search, first: Found) -> list[Member]:
    """All members beside a fit, from nought where that follows the recordings."""
    assert first.fit is not None
    follows = search.over(first) < NEAR
    return [m.from_nothing() if first.members or follows else m for m in members(first.fit)]


def _linear_beside(search: Search, first: Found, say: Progress) -> Found:
    """Linear members beside a fit, which is simulated for it."""
    first = simulated(search, first)
    linear = [m for m in _members_beside(search, first) if m.linear]
    for index, name in enumerate(names := list(dict.fromkeys(m.id for m in linear))):
        say("linear members", index, len(names))
        found = from_all_starts(search, first, [m for m in linear if m.id == name])
        if found is not None:
            search.add(found)
    return first


def _laws_beside(search: Search, first: Found, say: Progress) -> None:
    """Laws beside a fit."""
    assert first.fit is not None
    laws = _promising(search, first, [m for m in _members_beside(search, first) if not m.linear])
    laws += any_shape(first.fit) if laws and not first.members else []
    which = loudest(search.decays)
    loud, ended = [search.decays[index] for index in which], list[Tried]()
    trials = [d.trial.until(SCREENED_S[1]) for d in loud]
    for start in starts(search.decays, which, first, search.over(first) < NEAR):
        tried = [(way, begun_at(start, loud, way)) for way in laws]
        ended += cooled(tried, trials, say)
    ended += [pair for member, fit in ended if member.generic for pair in parts_of(member, fit, laws)]
    least = min((cost_of(f) for _, f in ended), default=math.inf)
    for index, (member, fit) in enumerate(going := field(ended, LAWS, FAR_OFF * least, ALIKE)):
        if cost_of(fit) > ALIKE * least and search.over(search.best) < MORE_OVER:
            break
        say("laws on whole recordings", index, len(going))
        search.add(Found((*first.members, member), None, on_whole(search.decays, fit, first.fit.nuisances)))


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


def _settled(search: Search, say: Progress, found: Found | None = None) -> None:
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


def _offered_to_each(search: Search) -> None:
    """What the best two pairs have found, offered to each of their effects alone."""
    pairs = [f for f in search.found if len(f.members) == 2 and f.fit is not None]
    for pair in sorted(pairs, key=lambda f: f.cost)[:OFFERED] if search.best in pairs else []:
        assert pair.fit is not None
        for member, other in (pair.members, pair.members[::-1]):
            model, keep = pair.model.without_effect(other.id)
            begun = evaluate(pair.fit.trials, model, pair.point[keep], pair.fit.nuisances)
            alone = min((f.cost for f in search.found if [m.id for m in f.members] == [member.id]), default=math.inf)
            if np.isfinite(begun.rss) and cost_of(led := cooled_alone(begun)) < ALIKE * alone:
                search.add(Found((replace(member, model=model),), None, to_the_end(led)))


def _other_formulas(search: Search, law: Found, say: Progress) -> None:
    """A law in other formulas of its effect, begun where it is."""
    assert law.fit is not None
    for index, (member, fit) in enumerate(forms := in_other_formulas(law.members[-1], law.fit)):
        say("other formulas", index, len(forms))
        search.add(Found((*law.members[:-1], member), None, descend(fit, FURTHER, plain=True)))


def _finished(search: Search, say: Progress) -> None:
    """Linear models that come near the best, by the simulator; and the best of all to its end."""
    best = search.best
    if best.fit is None and best.linear is not None:
        fit = fit_linear(search.decays, best.model, best.point)
        if fit is not None and fit.cost < best.cost:
            search.add(replace(best, linear=fit))
    while (found := _nearest(search)) is not None:
        say("near the best", 0, 1)
        simulated(search, found)
    base = search.baseline
    assert base.fit is not None
    search.baseline = replace(base, fit=descend(base.fit, LAST, plain=True))


def _nearest(search: Search) -> Found | None:
    """Of linear models that are not simulated the best, where it comes near the best of all, or in closed form near
    those that do; or before a baseline that follows the recordings."""
    best, base = search.best, search.baseline
    reach = REACH * max(search.over(best), 1.0) ** 2
    near = best.cost + max(reach, SHARE * (base.cost - best.cost))
    alike = [f.linear.cost for f in search.all if f.linear is not None and f.fit is not None and f.cost < near]
    limit = max(near, min(alike, default=-math.inf) + reach)
    if base.linear is not None and search.over(base) < NEAR:
        limit = max(limit, base.linear.cost - 2.0 * STATED)
    left = [f for f in search.found if f.fit is None and f.cost < limit]
    return min(left, key=lambda f: f.cost, default=None)
