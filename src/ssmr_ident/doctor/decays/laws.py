"""Laws by the simulator: all that a model leaves of the recordings counts as noise at first, then ever less.

As the variance of what counts as noise falls, a law takes its part before the robot can leave what is known of it to
follow what no robot does (continuation in the noise's variance: Rose 1998, deterministic annealing).
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from ssmr_ident.doctor.decays.closed_slopes import closed_slopes
from ssmr_ident.doctor.decays.linear import LinearFit, fit_linear
from ssmr_ident.doctor.decays.recordings import Decay, thinned
from ssmr_ident.doctor.decays.small_motions import FAR, small_motions
from ssmr_ident.doctor.robots.cooled import led, variances
from ssmr_ident.doctor.robots.found import Found, cost_of
from ssmr_ident.doctor.robots.members import Member
from ssmr_ident.identify.fitting.coordinates import Model
from ssmr_ident.identify.fitting.descent import Differentiated, descend
from ssmr_ident.identify.fitting.joint import JointFit, differentiate, evaluate
from ssmr_ident.identify.trials.decay import SCALES, STATES
from ssmr_ident.physics.extended import BODY, BRANCH, SLOW

Array = np.ndarray

BEGINS_S = 0.12, 0.35, 1.4
"""Lengths of the first parts of a recording by which its state at the release is found: one period of the fastest mode,
some of the slowest one, more of it."""

IS_RATE = np.array([name.endswith("_rate") for name in STATES])
"""Which of a release's states are rates."""

SCREENED_S = 0.7, 1.4
"""Length of the first part that laws are fitted to under the first variance of what counts as noise, and later."""

LAST = 3
"""Steps of states alone."""

FROM_REST, CLOSED = 2, 3
"""Steps by slopes in closed form, of states alone that begin at rest, and of all."""

NEAR = 1.5
"""RMS of whitened residuals up to which a model follows the recordings: laws' releases are then taken to be the
baseline's, and a law's own those that were begun at linear ones."""


@dataclass(frozen=True, eq=False)
class Start:
    """Where laws begin beside a model.

    Parameters
    ----------
    point : (p,) float
    nuisances : tuple of (k,) float
    """

    point: Array
    nuisances: tuple[Array, ...]


def loudest(decays: Sequence[Decay]) -> list[int]:
    """Which is the loudest decay of each kind of motion."""
    kinds: dict[str, int] = {}
    for index in sorted(range(len(decays)), key=lambda i: float(np.ptp(decays[i].trial.target))):
        kinds[decays[index].trial.kind] = index
    return sorted(kinds.values())


def starts(decays: Sequence[Decay], which: Sequence[int], first: Found, follows: bool) -> list[Start]:
    """From a fit; and where that does not follow the recordings or has left what is known of the robot, from that, and
    from what their small motions say of it."""
    assert first.fit is not None
    fit = first.fit
    found = [Start(fit.point, tuple(fit.nuisances[index] for index in which))]
    if not follows or left_known(fit):
        loud = [decays[index] for index in which]
        further = [released(loud, fit.model, fit.model.as_known(fit.point))]
        if (small := small_motions(decays, fit.model)) is not None:
            further.append(let_go(loud, fit.model, small))
        found += [Start(one.point, one.nuisances) for one in further if np.isfinite(one.rss)]
    return found


def left_known(fit: Found | JointFit) -> bool:
    """Whether a fit has left what is known of the robot."""
    return bool(np.abs(fit.point[: len(fit.model.physics)]).max() > FAR)


def begun_at(start: Start, decays: Sequence[Decay], way: Member) -> JointFit:
    """A law beside a model, before its first step, on the first part of recordings."""
    trials = [d.trial.until(SCREENED_S[0]) for d in decays]
    return evaluate(trials, way.model, np.concatenate([start.point, way.own]), start.nuisances)


def on_whole(
    decays: Sequence[Decay], fit: JointFit, near: Sequence[Array], slopes: Differentiated = differentiate
) -> JointFit:
    """A law that was fitted to some recordings, on all of them: from states of their own, or from those ``near``."""
    trials = [d.trial for d in decays]
    by_near = descend(evaluate(trials, fit.model, fit.point, near), LAST, shared=False, plain=True, slopes=slopes)
    begun = min((by_near, let_go(decays, fit.model, fit.point)), key=cost_of)
    if not np.isfinite(begun.rss):
        return begun
    for variance in variances(begun):
        begun = led(begun, variance, slopes=slopes)
    return begun


def released(decays: Sequence[Decay], model: Model, point: Array) -> JointFit:
    """A model at a point, its states at the release found over longer and longer beginnings from the linear ones."""
    found = _longer(decays, model, point, BEGINS_S[1:], 1.0)
    return evaluate([d.trial for d in decays], model, point, found.nuisances)


def let_go(decays: Sequence[Decay], model: Model, point: Array) -> JointFit:
    """The same of large motions, which are not linear, so that a linear state may be far from theirs: where it does not
    follow, what it is displaced by is let go at rest, as a hand does; of every recording the better."""
    found = _longer(decays, model, point, BEGINS_S[1:], 1.0)
    states: Sequence[Array] = found.nuisances
    if not found.rss < NEAR**2 * found.size:
        other = _longer(decays, model, point, BEGINS_S, 0.0)
        better = other.parts < found.parts if np.isfinite(found.rss) else np.ones(len(decays), dtype=bool)
        states = [b if use else a for a, b, use in zip(found.nuisances, other.nuisances, better, strict=True)]
    return evaluate([d.trial for d in decays], model, point, states)


def _longer(decays: Sequence[Decay], model: Model, point: Array, lengths: Sequence[float], moving: float) -> JointFit:
    """States alone over longer and longer beginnings, from the linear ones, their rates times ``moving``; over the
    first from all that those leave as noise."""
    states = linear_states([thinned(d, lengths[0], 1) for d in decays], model, point)
    states = states or [np.zeros(len(STATES)) for _ in decays]
    states = [np.where(IS_RATE, moving * x, x) for x in states]
    for seconds in lengths:
        found = evaluate([d.trial.until(seconds) for d in decays], model, point, states)
        for variance in variances(found) if seconds == lengths[0] and np.isfinite(found.rss) else (1.0,):
            found = descend(found, LAST, shared=False, plain=True, temper=variance)
        states = list(found.nuisances)
    return found


def linear_states(decays: Sequence[Decay], model: Model, point: Array) -> list[Array] | None:
    """States at the begin by the baseline alone."""
    plain = replace(model, free=(), held={})
    fit = fit_linear(decays, plain, point[: len(model.physics)], 0)
    return None if fit is None else [nuisance_of(x, plain) for x in fit.states]


def nuisance_of(state: Array, model: Model) -> Array:
    """A linear fit's state at the release as a trial's nuisances; branches hold nothing."""
    found = np.zeros(len(STATES))
    found[:BODY] = state[:BODY]
    if "flexible_mast" in model.held:
        found[BODY : BODY + 4] = state[BODY : BODY + 4]
    return found / SCALES


def exact(decays: Sequence[Decay], fit: LinearFit) -> JointFit:
    """A linear fit led on by the simulator, in which nothing is small, by slopes in closed form.

    There branches hold a share of what the release is displaced by, and a slow sensor lags by a share of the first
    acceleration; in closed form by anything, so that all states are looked for anew, from rest.
    """
    trials, nuisances = [d.trial for d in decays], [nuisance_of(x, fit.model) for x in fit.states]
    slopes = closed_slopes(decays)
    anew = not {BRANCH, SLOW}.isdisjoint(fit.model.held)
    begun = evaluate(trials, fit.model, fit.point, [0.0 * n if anew else n for n in nuisances])
    if anew:
        begun = descend(begun, FROM_REST, shared=False, plain=True, slopes=slopes)
    return descend(begun, CLOSED, plain=True, slopes=slopes)
