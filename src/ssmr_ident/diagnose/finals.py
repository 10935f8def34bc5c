"""What has come first in a search, refitted to all recordings at their full length."""

from __future__ import annotations

from collections.abc import Iterable, Sequence

import numpy as np

from ssmr_ident.compare.recorded import follow
from ssmr_ident.compare.starts import by_other_starts
from ssmr_ident.core.threads import side_by_side
from ssmr_ident.diagnose.baseline import LAST
from ssmr_ident.diagnose.race import CLOSE, Progress, ranked, within_reach
from ssmr_ident.identify.fitting.descent import LOUD, chatters, descend, slides
from ssmr_ident.identify.fitting.horizons import horizon_fit
from ssmr_ident.identify.fitting.joint import JointFit

REFITTED = 3
"""Effects that are refitted to the end."""

AS_MUCH = 0.2
"""Difference in the logarithm of what two fits leave of a recording, up to which they leave as much: of 31 fits whose
loudest recordings were begun elsewhere (14 sessions) six fell by 490 to 4,400 in cost, and had left those more than
three times as loud or as quiet as the other; none of the rest fell by more than 29."""

HALFWAY = 0.5
"""Difference in the logarithm of the unexplained variance up to which a fit of all recordings may overtake another
when half its steps are done. Of 104 that were then more than 0.02 behind (24 sessions of decays) none came first, and
none made up for more than 0.17; pulls, whose wheels let go at other times, are given more."""


def to_the_end(
    base: JointFit,
    rough: Sequence[JointFit],
    rest: Sequence[float],
    lengths: Sequence[float],
    progress: Progress | None,
    starts: int = 1,
) -> list[JointFit]:
    """The first few of what was tried, refitted to all recordings at their full length."""
    few = _finalists([fit for fit in rough if within_reach(rough, fit)], starts=2 if slides(base) else starts)
    return led_on(base, few, rest, lengths, progress)


def led_on(
    base: JointFit,
    rough: Sequence[JointFit],
    rest: Sequence[float],
    lengths: Sequence[float],
    progress: Progress | None,
) -> list[JointFit]:
    """Fits refitted to all recordings at their full length, side by side."""

    def halfway(fit: JointFit) -> JointFit:
        if chatters(base):
            fit = descend(fit, LAST // 2, plain=True)
        return horizon_fit(base.trials, fit.model, fit.point, rest, LAST // 2, _all_nuisances(base, fit, lengths))

    def ended(fit: JointFit) -> JointFit:
        # what is as far behind as this halfway does not win, and where exactly it ends decides nothing
        return descend(fit, LAST - LAST // 2) if any(_behind(fit, best, base) < close for best in first) else fit

    def begun_elsewhere(fit: JointFit) -> JointFit:
        return mended(fit, base) if any(_behind(fit, best, base) < AS_MUCH for best in first) else fit

    close = CLOSE if slides(base) else HALFWAY
    count = 3 * len(rough)
    halves = _told(side_by_side(halfway, rough), 0, count, progress)
    first = ranked(halves)[:1]
    ends = _told(side_by_side(ended, halves), len(rough), count, progress)
    first = ranked(ends)[:1]
    return _told(side_by_side(begun_elsewhere, ends), 2 * len(rough), count, progress)


def _behind(fit: JointFit, first: JointFit, base: JointFit) -> float:
    """How far behind the first a fit would be, per independent sample, were the recordings in which it is stuck left
    with noise alone, or with as little as the first leaves of them."""
    stuck, sizes = _stuck(fit, base), np.array([t.size for t in fit.trials])
    won = float(first.counted[stuck] @ np.log(fit.parts[stuck] / np.minimum(sizes, first.parts)[stuck]))
    return (fit.cost(first.counted) - won - first.cost(first.counted)) / first.independent


def _told(fits: Iterable[JointFit], done: int, count: int, progress: Progress | None) -> list[JointFit]:
    """Fits as they come, each counted."""
    found: list[JointFit] = []
    for fit in fits:
        if progress:
            progress("refitting explanations", done + len(found), count)
        found.append(fit)
    return found


def mended(fit: JointFit, beside: JointFit | None = None) -> JointFit:
    """A fit that explains most of its recordings, the others begun elsewhere: one release in a valley of its own spoils
    the physics that all share.

    Parameters
    ----------
    fit : JointFit
    beside : JointFit, optional
        Recordings of which it leaves as much are no reason: what it does without has to do with them.
    """
    stuck = _stuck(fit, beside)
    if not len(stuck):
        return fit
    led_back = by_other_starts(fit, only=stuck.tolist(), known=True)
    found_another = np.any(np.log(fit.parts / led_back.parts) > AS_MUCH)
    return descend(led_back, LAST) if found_another else fit


def _stuck(fit: JointFit, beside: JointFit | None) -> np.ndarray:
    """Which recordings are left with far more than most, (k,) int; none where most are left with much."""
    left = fit.parts / [t.size for t in fit.trials]
    middle = float(np.median(left))
    stuck = (left > LOUD * max(middle, 1.0)) & (middle < LOUD)
    if beside is not None:
        stuck &= np.abs(np.log(fit.parts / beside.parts)) > AS_MUCH
    return np.flatnonzero(stuck)


def _finalists(ranked: Sequence[JointFit], starts: int) -> list[JointFit]:
    """The first few effects, and of the very first also what is tried and not fitted of it.

    ``starts`` is how many fits of the very first go on: where contacts let go, how far one comes in a few steps says
    little of where it ends.
    """
    if not ranked:
        return []
    effects = list(dict.fromkeys(fit.model.ids for fit in ranked))[:REFITTED]
    best: dict[tuple[object, ...], list[JointFit]] = {}
    for fit in ranked:
        if fit.model.ids in effects:
            first = fit.model.ids == effects[0]
            own = fit.model.held[fit.model.ids[-1]] if first else {}
            same = best.setdefault((fit.model.ids, *own.values()), [])
            if len(same) < (starts if first else 1):
                same.append(fit)
    return [fit for same in best.values() for fit in same]


def each_once(fits: Sequence[JointFit]) -> list[JointFit]:
    """Of every effect the fit that leaves least."""
    best: dict[tuple[str, ...], JointFit] = {}
    for fit in ranked(fits):
        best.setdefault(fit.model.ids, fit)
    return list(best.values())


def _all_nuisances(base: JointFit, fit: JointFit, lengths: Sequence[float]) -> list[np.ndarray]:
    """Nuisances for all trials: those of the fit, and for trials that it left out those that fit it best."""
    known = {trial.name: own for trial, own in zip(fit.trials, fit.nuisances, strict=True)}
    left = [trial for trial in base.trials if trial.name not in known]
    if left:
        second = lengths[min(1, len(lengths) - 1)]
        short = follow([trial.until(second) for trial in left], fit.model, fit.point, kin=fit)
        known |= {trial.name: own for trial, own in zip(left, short.nuisances, strict=True)}
    return [known[trial.name] for trial in base.trials]


def anew(fit: JointFit, lengths: tuple[float, ...]) -> JointFit:
    """The effects as they are, everything else begun from what is known of it."""
    point = fit.model.as_known(fit.point)
    short = [t.until(lengths[0]) for t in fit.trials]
    begun = follow(short, fit.model, point, kin=fit)
    return mended(horizon_fit(fit.trials, fit.model, point, lengths, LAST, begun.nuisances))
