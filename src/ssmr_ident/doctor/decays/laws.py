"""Laws by the simulator: begun on stretches that each have a start of their own, led on to whole recordings."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from ssmr_ident.doctor.decays.found import Found
from ssmr_ident.doctor.decays.linear import LinearFit, fit_linear
from ssmr_ident.doctor.decays.members import Member
from ssmr_ident.doctor.decays.recordings import Decay, segmented
from ssmr_ident.identify.fitting.coordinates import Model
from ssmr_ident.identify.fitting.descent import descend
from ssmr_ident.identify.fitting.joint import JointFit, evaluate
from ssmr_ident.identify.trials.decay import SCALES, STATES
from ssmr_ident.physics.extended import BODY

Array = np.ndarray

STRETCH_S, FIRST_S, STRETCHES_S = 0.35, 0.7, 1.4
"""Length of the stretches that laws are fitted to, and of the first part that they are cut from: at their first steps,
and later."""

BEGUN, LED, FURTHER, LAST = 2, 2, 4, 3
"""Steps of every start, of what goes on (by what is louder than noise, and by all), of what is begun
near an optimum, and on whole recordings."""

STATES_FIRST = 8
"""Steps of the states at the release alone, where closed form and simulator have other ones."""

TRUSTED = 0.1
"""Share of what the model without a law leaves, in squares, that counts as noise after the law's first steps,
where all of that does. In sizes of noise alone a robot leaves what is known of it before a law has taken its part."""

FAR = 3.0
"""Standard deviations of what is known that a baseline may have moved before laws are begun from what is known."""


def loudest(decays: Sequence[Decay]) -> list[Decay]:
    """The loudest decay of each kind of motion."""
    kinds: dict[str, Decay] = {}
    for d in sorted(decays, key=lambda d: float(np.ptp(d.trial.target))):
        kinds[d.trial.kind] = d
    return list(kinds.values())


def stretches_of(decays: Sequence[Decay], seconds: float) -> list[Decay]:
    """Stretches of the first part of the loudest decays."""
    return [s for d in loudest(decays) for s in segmented(d, STRETCH_S, seconds)]


def begun_at(begins: Sequence[Decay], first: Found, way: Member, left: float) -> JointFit | None:
    """A law at the begin of recordings, from where the baseline is, or where that has moved far from what is known;
    ``left`` is the mean square that this leaves, in that of white noise."""
    own = first.model.as_known(first.point) if left_known(first) else first.point
    states = linear_states(begins, first.model, own)
    if states is None:
        return None
    fit = evaluate([s.trial for s in begins], way.model, np.concatenate([own, way.own]), states)
    fit = descend(fit, BEGUN, plain=True, temper=max(left, 1.0)) if np.isfinite(fit.rss) else fit
    return fit if np.isfinite(fit.rss) else None


def left_known(fit: Found | JointFit) -> bool:
    """Whether a fit has left what is known of the robot."""
    return bool(np.abs(fit.point[: len(fit.model.physics)]).max() > FAR)


def led_on(stretches: Sequence[Decay], fit: JointFit, left: float) -> JointFit:
    """A law on more stretches, by what is louder than a share of what is ``left`` without it."""
    states = linear_states(stretches, fit.model, fit.point) or [np.zeros(len(STATES)) for _ in stretches]
    begun = evaluate([s.trial for s in stretches], fit.model, fit.point, states)
    led = descend(begun, 1, shared=False, plain=True)
    return descend(led, LED, plain=True, temper=max(TRUSTED * left, 1.0))


def joined_up(fit: JointFit) -> JointFit:
    """A law that was led on by what is louder than noise, by all of it."""
    return descend(fit, LED, plain=True)


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


def exact(decays: Sequence[Decay], fit: LinearFit, steps: int) -> JointFit:
    """A linear fit led on by the simulator, in which nothing is small.

    There branches hold a share of what the release is displaced by; in closed form anything. So states come first.
    """
    trials, nuisances = [d.trial for d in decays], [nuisance_of(x, fit.model) for x in fit.states]
    begun = evaluate(trials, fit.model, fit.point, nuisances)
    if "viscoelastic_relaxation" in fit.model.held:
        begun = descend(begun, STATES_FIRST, shared=False, plain=True)
    return descend(begun, steps, plain=True)


def on_whole(decays: Sequence[Decay], fit: JointFit, near: JointFit | None = None) -> JointFit:
    """A law that was fitted to stretches, on whole recordings.

    Their states are found over longer and longer beginnings, or are those of a fit without the law that is ``near``.
    """
    trials = [d.trial for d in decays]
    if near is not None:
        point = np.concatenate([near.point, fit.point[len(near.point) :]])
        begun = evaluate(trials, fit.model, point, near.nuisances)
        return descend(descend(begun, 1, shared=False, plain=True), LAST, plain=True)
    states = linear_states([segmented(d, STRETCH_S, STRETCH_S)[0] for d in decays], fit.model, fit.point)
    states = states or [np.zeros(len(STATES)) for _ in trials]
    for seconds in (STRETCH_S, STRETCHES_S):
        short = evaluate([t.until(seconds) for t in trials], fit.model, fit.point, states)
        states = list(descend(short, LAST, shared=False, plain=True).nuisances)
    return descend(evaluate(trials, fit.model, fit.point, states), LAST, plain=True)
