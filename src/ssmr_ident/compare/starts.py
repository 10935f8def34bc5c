"""Starts from which the nuisances of a recording are looked for where the first one leads to no good end."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace
from functools import cache, partial

import numpy as np

from ssmr_ident.core.threads import side_by_side
from ssmr_ident.identify.fitting.coordinates import Model
from ssmr_ident.identify.fitting.descent import LOUD, descend
from ssmr_ident.identify.fitting.horizons import STEPS, horizon_fit, horizons, radian
from ssmr_ident.identify.fitting.joint import JointFit, evaluate, together
from ssmr_ident.identify.trials.trial import Array, Trial

SHARES = (1.0, 0.6, 0.35)
"""Of the start that small motions suggest: where tires harden, the same acceleration takes a smaller deflection."""

LAST, TRIED = 10, 2
"""Gauss-Newton steps on a horizon, and those after which a start that is far behind is given up."""

REACH = 3.0
"""Times what was found leaves up to which a start may still overtake it. Of 1,505 starts (6 sessions of decays) 75
ended more than 3 ahead in cost; 13 of them were farther behind after two steps, two of which ended 331 and 870 ahead.
"""

Start = tuple[Array, Sequence[float]]
"""Nuisances to begin with, and the growing horizons that they are fitted over."""


def alone(trial: Trial, model: Model, point: Array, start: Array, steps: int = LAST) -> JointFit:
    """One recording's nuisances at their best, from a start."""
    return horizon_fit([trial], model, point, [np.inf], steps, [start], shared=False)


def by_other_starts(
    found: JointFit, kin: JointFit | None = None, only: Sequence[int] | None = None, known: bool = False
) -> JointFit:
    """Recordings that are left with more than noise, each from its best start.

    The starts: what fits without the effects, recordings of the same kind, in proportion, what growing
    horizons lead to, and a robot that is let go at rest.

    Parameters
    ----------
    found : JointFit
    kin : JointFit, optional
        Other recordings, as the model explains them; by default these.
    only : sequence of int, optional
        Recordings that are asked for; by default all.
    known : bool
        What was found had not begun from small motions, so these are a start as they are.
    """
    trials, model, point = found.trials, found.model, found.point
    values, effects = model.split(point)
    time = radian(trials)

    @cache
    def small(k: int) -> Array:
        return trials[k].begin(values, effects)

    def without_effects(k: int) -> Start:
        start = small(k)
        if not known:
            plain = replace(model, held={}, free=())
            start = alone(trials[k], plain, point[: len(model.physics)], start).nuisances[0]
        return start, [np.inf]

    def over_horizons(k: int) -> Start:
        first, *rest = horizons([trials[k]], time)
        if not rest:
            return small(k), [np.inf]
        short = trials[k].until(first)
        whole = short.begin(values, effects)
        fits = [alone(short, model, point, share * whole, STEPS) for share in SHARES]
        return min(fits, key=lambda f: f.rss if np.isfinite(f.rss) else np.inf).nuisances[0], rest

    def let_go(k: int) -> Start:
        # where damping grows with deflection the first push hardly swings, and no small motion looks like it; what is
        # let go at rest has its deflection in the first samples, before any damping acts
        begun = alone(_let_go_at_rest(trials[k]), model, point, np.zeros_like(small(k)))
        return begun.nuisances[0], horizons([trials[k]], time)

    def like_others(sign: float) -> Callable[[int], Start]:
        return lambda k: (_in_proportion(trials[k], small(k), found if kin is None else kin, sign), [np.inf])

    for start in (without_effects, like_others(1.0), like_others(-1.0), over_horizons, let_go):
        left = [k for k in _left(found, kin) if only is None or k in only]
        if not left:
            return found
        each = [found.only(k) for k in range(len(trials))]
        others = side_by_side(partial(_from, start), [(each[k], k) for k in left])
        for k, other in zip(left, others, strict=True):
            each[k] = other
        found = together(each)
    return found


def _left(found: JointFit, kin: JointFit | None) -> list[int]:
    """Decays of which more than noise is left.

    Where the model leaves the like of it too, it is no start that is wanting.
    """
    left = [k for k, trial in enumerate(found.trials) if trial.quiet and not found.parts[k] < LOUD * trial.size]
    if kin is not None:
        left = [k for k in left if min(_kin(found.trials[k], kin), default=(0.0, 0))[0] < LOUD]
    return left


def _from(start: Callable[[int], Start], recording: tuple[JointFit, int]) -> JointFit:
    found, index = recording
    return _along(found, *start(index))


def _along(found: JointFit, start: Array, lengths: Sequence[float]) -> JointFit:
    """One recording's better fit of what was found and what a start leads to, through growing horizons."""
    fit = found
    for length in lengths:
        short = found.trials[0].until(length)
        known = found if short is found.trials[0] else evaluate([short], found.model, found.point, found.nuisances)
        fit = descend(evaluate([short], found.model, found.point, [start]), TRIED, shared=False)
        if not fit.rss < REACH * known.rss:
            return found
        fit = descend(fit, LAST - TRIED, shared=False)
        start = fit.nuisances[0]
    return fit if fit.rss <= found.rss else found


def _let_go_at_rest(trial: Trial) -> Trial:
    """The first samples of a recording whose velocities start at zero."""
    first = trial.until(0.0)
    speeds = [name for name in first.nuisances if name.endswith(("_rate", "_velocity"))]
    return replace(first, idle={**first.idle, **dict.fromkeys(speeds, ())})


def _in_proportion(trial: Trial, start: Array, kin: JointFit, sign: float) -> Array:
    """Start of a recording as that of the best explained one of its kind, as much larger as it is itself."""
    others = _kin(trial, kin)
    if not others:
        return start
    best = min(others)[1]
    sizes = [float(np.std(t.target - t.target.mean(axis=0))) for t in (trial, kin.trials[best])]
    return sign * sizes[0] / sizes[1] * kin.nuisances[best]


def _kin(trial: Trial, kin: JointFit) -> list[tuple[float, int]]:
    """Variance over the noise's and index of the other recordings of a kind."""
    return [
        (float(kin.parts[k]) / other.size, k)
        for k, other in enumerate(kin.trials)
        if other.kind == trial.kind and other.channels == trial.channels and other.name != trial.name
    ]
