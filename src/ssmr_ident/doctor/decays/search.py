"""The search in free decays: linear members in closed form, laws by the simulator, the best on whole recordings."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import replace

import numpy as np

from ssmr_ident.core.errors import InputError
from ssmr_ident.diagnose.noise_at_rest import coloured, colours_at_rest, colours_left
from ssmr_ident.diagnose.scan import scan
from ssmr_ident.doctor.decays.law_members import in_formulas, laws_beside, offered_to_each, settled
from ssmr_ident.doctor.decays.laws import (
    LAST,
    NEAR,
    exact,
)
from ssmr_ident.doctor.decays.linear import fit_linear
from ssmr_ident.doctor.decays.linear_members import (
    from_all_starts,
    members_beside,
    offered_back,
    offered_down,
    raced,
    simulated,
)
from ssmr_ident.doctor.decays.recordings import Decay
from ssmr_ident.doctor.decays.small_motions import annealed
from ssmr_ident.doctor.robots.cooled import (
    Progress,
)
from ssmr_ident.doctor.robots.found import Found, Search
from ssmr_ident.doctor.robots.members import GEOMETRY, KINDS
from ssmr_ident.doctor.rules import FORMULA, MORE_OVER, STATED
from ssmr_ident.identify.fitting.coordinates import Model
from ssmr_ident.identify.fitting.descent import descend
from ssmr_ident.identify.fitting.joint import differentiate
from ssmr_ident.physics.effects import CATALOGUE

Array = np.ndarray

MATTERS = 0.95
"""Factor on the error, noise included, below which an effect makes it that matters on what it was not fitted to."""

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
        settled(search, say)
        offered_to_each(search)
    _finished(search, say)


def _silent(stage: str, done: int, total: int) -> None:
    pass


def _single_laws(search: Search, say: Progress) -> None:
    """Laws beside the baseline, the best of them to its end and in other formulas; where any shape is better, too."""
    laws_beside(search, search.baseline, say)
    settled(search, say)
    for _ in range(2):
        if (law := _best_law(search)) is not None and search.over(law) > MORE_OVER:
            settled(search, say, law)
            in_formulas(search, law, say)
    settled(search, say)


def _compared(search: Search, say: Progress) -> bool:
    """Whether the best may be the answer; laws are then fitted too, where the baseline follows the recordings."""
    _finished(search, say)
    if search.over(search.best) > NEAR or not (_matters(search) or _displaced(search)):
        return False
    if search.over(search.baseline) < NEAR and not search.has_laws:
        laws_beside(search, search.baseline, say)
        settled(search, say, _best_law(search))
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
    search = Search(Found((), fit, exact(decays, fit)), decays=tuple(decays), looked_at=len(KINDS))
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
    return search if fit is None else replace(search, baseline=Found((), fit, exact(decays, fit)), decays=decays)


def _firsts(search: Search, linear: bool = False) -> list[Found]:
    """The best single effect, a linear one where that is asked."""
    named = [f for f in search.found if len(f.members) == 1 and not f.members[0].generic]
    named = [f for f in named if f.members[0].linear or not linear]
    return sorted(named, key=lambda f: f.cost)[:1]


def _beside(search: Search, first: Found, say: Progress) -> None:
    """All members beside a fit."""
    first = _linear_beside(search, first, say)
    laws_beside(search, first, say)


def _linear_beside(search: Search, first: Found, say: Progress) -> Found:
    """Linear members beside a fit, which is simulated for it."""
    first = simulated(search, first)
    linear = [m for m in members_beside(search, first) if m.linear]
    for index, name in enumerate(names := list(dict.fromkeys(m.id for m in linear))):
        say("linear members", index, len(names))
        found = from_all_starts(search, first, [m for m in linear if m.id == name])
        if found is not None:
            search.add(found)
    return first


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
    raced(search)
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
