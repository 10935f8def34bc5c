"""Pulls fitted from robots that are drawn: which wheel lets go first makes many hollows, and a descent ends in one.

Draws cost little where lanes have many at once, and descents from the nearest of them are what finds a deeper hollow.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from functools import partial

import numpy as np

from ssmr_ident.core.threads import side_by_side
from ssmr_ident.identify.fitting.descent import descend
from ssmr_ident.identify.fitting.joint import JointFit, evaluate_all

DRAWN, BEGUN, SEED = 64, 16, 20120511
"""Robots drawn out of what is known, those of them from which pulls are fitted, and the seed of all draws."""

SHAKES = (0.3, 0.1) * 4
"""Standard deviations of what is known by which a fit is shaken, one time after the other. The baseline of a null
session went down by 39, 42 and 119 in six times, from where it had begun, and by 0 to 82 the first time."""

ENOUGH, HOPE = 2, 2.0
"""Times after which a fit is given up that at so many times the pace it has had would not come as far as it should: of
the three above the slowest had won 7 by then, of the 32 that it lacked, and got there."""

SHAKEN, KEPT = 32, 8
"""Robots that are drawn each time, and those of them that are fitted."""

HEATS, STEPS = ((2, 2), (2, 4)), (4, 8)
"""Gauss-Newton steps from a draw by plain squares, and the share (one in so many) that goes on: twice; then steps by
plain squares and by what each recording is worth. Of 18 times that a baseline was begun from 16 draws or shaken by 8,
all led to the end, the best was among the first three after two steps, or ahead of one of them by less than one."""


def from_afar(fit: JointFit) -> list[JointFit]:
    """The best of pulls fitted from robots drawn out of what is known of theirs; none where no lanes have many at once.

    One in four or five of such starts ends in the deepest hollow.
    """
    return _around(fit, np.zeros(len(fit.point)), 1.0, (DRAWN, BEGUN), np.random.default_rng(SEED))[:1]


def challenged(
    by: JointFit, counted: np.ndarray, bases: Sequence[JointFit], beaten: Callable[[JointFit], bool]
) -> JointFit:
    """The deepest hollow of pulls without an effect that is found from some of them, until the effect is beaten.

    Of a dozen effects, begun from many places, one ends deeper than the baseline by chance.

    Parameters
    ----------
    by : JointFit
        With the effect.
    counted : (t,) float
        Independent samples, by which costs are compared.
    bases : sequence of JointFit
        Without it.
    beaten : callable
        Whether nobody would name the effect beside such a fit without it.
    """
    order = sorted(bases, key=lambda f: f.cost(counted))
    best = order[0]
    for base in order:
        if beaten(best):
            break
        best = min((best, _shaken(base, counted, by.cost(counted), beaten)), key=lambda f: f.cost(counted))
    return best


def _shaken(fit: JointFit, counted: np.ndarray, goal: float, beaten: Callable[[JointFit], bool]) -> JointFit:
    """Pulls shaken, fitted, and shaken again from the best, as long as that has a chance of getting to a goal."""
    random, best, first = np.random.default_rng(SEED), fit, fit.cost(counted)
    for times, width in enumerate(SHAKES, 1):
        deepest = min((best, *_around(best, best.point, width, (SHAKEN, KEPT), random)), key=lambda f: f.cost(counted))
        moved, best = deepest is not best, deepest
        won = first - best.cost(counted)
        if (moved and beaten(best)) or (times >= ENOUGH and HOPE * len(SHAKES) * won / times < first - goal):
            break
    return best


def _around(
    fit: JointFit, centre: np.ndarray, width: float, count: tuple[int, int], random: np.random.Generator
) -> list[JointFit]:
    """Fits from the nearest few of many robots drawn around a centre, the best first."""
    if not all(trial.abreast for trial in fit.trials):
        return []
    places = [(centre + width * random.standard_normal(len(centre)), fit.nuisances) for _ in range(count[0])]
    drawn = [f for f in evaluate_all(fit.trials, fit.model, places) if np.isfinite(f.rss)]
    field = _nearest(drawn, count[1])
    for steps, one_in in HEATS:
        field = _nearest(side_by_side(partial(descend, iterations=steps, plain=True), field), count[1] // one_in)
    ends = side_by_side(lambda f: descend(descend(f, STEPS[0], plain=True), STEPS[1]), field)
    return sorted(ends, key=lambda f: f.cost(fit.counted))


def _nearest(fits: Iterable[JointFit], count: int) -> list[JointFit]:
    return sorted(fits, key=lambda f: f.rss + f.penalty)[:count]
