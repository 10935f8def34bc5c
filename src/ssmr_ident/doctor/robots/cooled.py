"""Models led from all that they leave of the recordings as noise to the noise alone, fewer and fewer of them.

As the variance of what counts as noise falls, a law takes its part before the robot can leave what is known of it to
follow what no robot does (continuation in the noise's variance: Rose 1998, deterministic annealing).
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence

import numpy as np

from ssmr_ident.compare.recorded import follow
from ssmr_ident.core.errors import InputError
from ssmr_ident.doctor.robots.found import cost_of
from ssmr_ident.doctor.robots.members import BY_KIND, Member
from ssmr_ident.identify.fitting.coordinates import Model
from ssmr_ident.identify.fitting.descent import Differentiated, ahead, descend
from ssmr_ident.identify.fitting.joint import JointFit, differentiate, evaluate
from ssmr_ident.identify.trials import Trial

Tried = tuple[Member, JointFit]
Progress = Callable[[str, int, int], None]

BEGINS_S = 0.35, 1.4, math.inf
"""Lengths of the first parts of decays that a model is led over from what is known."""

STEPS, FURTHER = 2, 4
"""Steps under each variance of what counts as noise, and of what is begun near an optimum."""

SECANTS = 1
"""Steps with corrected slopes after each of the first ones: with three, 24 drawn robots took a third longer and named
the same laws."""

TO_THE_END, ROUNDS = 10, 4
"""Steps of the best law, and how often an undamped one leads it on, at the most."""

TRUSTED = 0.1
"""Factor from one variance of what counts as noise to the next."""

LAWS = 3
"""Effects with laws that go on after the second variance of what counts as noise, and to all recordings; two fits
each."""

SAME_COST, SAME_PLACE = 0.5, 0.1
"""Difference of the cost, and of coordinates, below which two fits are one."""

FAR_OFF = 3.0
"""Factor on the least cost beyond which a law does not go on to all recordings."""


def variances(fit: JointFit) -> list[float]:
    """What counts as noise, in variances of the noise: all that a fit leaves, a tenth of it and so on, at last 1."""
    left = max(fit.rss / fit.size, 1.0)
    return [max(left * TRUSTED**k, 1.0) for k in range(math.ceil(math.log(left) / -math.log(TRUSTED)) + 1)]


def led(fit: JointFit, variance: float, steps: int = STEPS, slopes: Differentiated = differentiate) -> JointFit:
    """A few steps while ``variance`` counts as noise."""
    return descend(fit, steps, plain=True, temper=variance, secants=SECANTS, slopes=slopes)


def cooled_alone(fit: JointFit) -> JointFit:
    """One model led from all that it leaves as noise to the noise alone; as it is where it cannot be simulated."""
    for variance in variances(fit) if np.isfinite(fit.rss) else ():
        fit = led(fit, variance)
    return fit


def from_known(trials: Sequence[Trial], model: Model) -> JointFit:
    """A model from what is known of it, decays by their beginnings first.

    Raises
    ------
    InputError
        The robot as the file has it cannot be simulated.
    """
    begun: JointFit | None = None
    for seconds in BEGINS_S:
        parts = tuple(t.until(seconds) for t in trials)
        if begun is None:
            begun = cooled_alone(follow(parts, model, np.zeros(len(model.unknowns))))
        elif any(part is not before for part, before in zip(parts, begun.trials, strict=True)):
            begun = cooled_alone(evaluate(parts, model, begun.point, begun.nuisances))
    if begun is None or not np.isfinite(begun.rss):
        raise InputError(
            "robot file", "describes a robot whose simulation leaves the finite numbers", "Check stiffness and mass"
        )
    return begun


def cooled(
    tried: Sequence[Tried],
    trials: Sequence[Trial],
    say: Progress,
    first: int = STEPS,
    reach: float = math.inf,
    slopes: Differentiated = differentiate,
) -> list[Tried]:
    """Laws led from all that each leaves as noise to the noise alone; fewer and fewer go on.

    Parameters
    ----------
    tried : sequence of (Member, JointFit)
    trials : sequence of Trial
        On which they go on after the first variance.
    say : callable
    first : int
        Steps under the first variance.
    reach : float
        Factor on the least cost beyond which a model does not go on after the first variance.
    slopes : callable
        As ``descend`` takes it.
    """
    begun = distinct([(member, fit) for member, fit in tried if np.isfinite(fit.rss)])
    running = [(member, fit, variances(fit)) for member, fit in begun]
    for rung in range(max((len(v) for _, _, v in running), default=0)):
        if rung == 1:
            running = [(m, evaluate(trials, f.model, f.point, f.nuisances), v) for m, f, v in running]
        onward = []
        for index, (member, fit, own) in enumerate(running):
            say("laws from loose to exact", index, len(running))
            steps = STEPS if rung else first
            onward.append((member, led(fit, own[min(rung, len(own) - 1)], steps, slopes), own))
        kept = fewer([(m, f) for m, f, _ in onward if np.isfinite(f.rss)], rung, reach)
        running = [one for one in onward if any(one[1] is fit for _, fit in kept)]
    return [(m, f) for m, f, _ in running]


def fewer(tried: Sequence[Tried], rung: int, reach: float) -> list[Tried]:
    """Which laws go on after each variance of what counts as noise."""
    least = min((cost_of(f) for _, f in tried), default=math.inf)
    return field(tried, LAWS, FAR_OFF * least) if rung else field(tried, len(BY_KIND), reach * least)


def field(tried: Sequence[Tried], effects: int, most: float = math.inf, beside: float = math.inf) -> list[Tried]:
    """Of every effect the two best formulas or starts, up to a cost, the second up to a factor on the first one's; of
    all the first effects, and what takes any shape."""
    ranked = distinct(sorted(tried, key=lambda pair: cost_of(pair[1])))
    names = list(dict.fromkeys(m.id for m, _ in ranked if not m.generic))[:effects]
    found: list[Tried] = []
    for member, fit in ranked:
        fits = member.generic or (member.id in names and cost_of(fit) < most)
        alike = [cost_of(f) for m, f in found if (m.id, m.kind, m.generic) == (member.id, member.kind, member.generic)]
        if fits and (not alike or (len(alike) < 2 and cost_of(fit) < beside * alike[0])):
            found.append((member, fit))
    return found


def distinct(tried: Sequence[Tried]) -> list[Tried]:
    """Fits but for those that have come to where another one of their formula is."""
    found: list[Tried] = []
    for member, fit in tried:
        same = (f for m, f in found if (m.id, m.kind, m.form) == (member.id, member.kind, member.form))
        if not any(
            abs(cost_of(f) - cost_of(fit)) < SAME_COST and np.abs(f.point - fit.point).max() < SAME_PLACE for f in same
        ):
            found.append((member, fit))
    return found


def to_the_end(fit: JointFit) -> JointFit:
    """A fit's optimum, along a valley's floor too: damped steps, and undamped ones as long as those lead on."""
    for _ in range(ROUNDS):
        found = descend(fit, TO_THE_END, plain=True)
        onward = descend(ahead(found), FURTHER, plain=True)
        better = min((found, onward), key=cost_of)
        if not cost_of(better) < cost_of(fit) - 1.0:
            return better
        fit = better
    return fit
