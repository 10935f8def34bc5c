"""A recording beside what a model says of it: nuisances refitted, physics not."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace

import numpy as np

from ssmr_ident.compare.outcome import Prediction
from ssmr_ident.identify.coordinates import Model
from ssmr_ident.identify.horizons import STEPS, horizons, led
from ssmr_ident.identify.joint import JointFit, evaluate
from ssmr_ident.identify.parallel import side_by_side
from ssmr_ident.identify.trials.trial import Array, Trial, Values
from ssmr_ident.physics.slots import Effects
from ssmr_ident.signals.filters import low_pass

LOUD = 2.0
"""Variance over the noise's from which another start may be worth its time."""

SHARES = (1.0, 0.6, 0.35)
"""Of the start that small motions suggest: where tires harden, the same acceleration takes a smaller deflection."""

LAST = 10
"""Gauss-Newton steps on the whole recording."""


def follow(
    trials: Sequence[Trial],
    model: Model,
    point: Array,
    near: Sequence[Array] | None = None,
    kin: JointFit | None = None,
) -> JointFit:
    """A model held where it is, with the nuisances of each recording at their best.

    Small motions give the start of a decay, or nuisances that are near. Where effects bend the motion and more than
    noise is left, further roads are tried: from the start that fits without the effects or from small motions, from
    recordings of the same kind, in proportion, through growing horizons, and from a robot that is let go at rest. Each
    recording takes its own best.

    Parameters
    ----------
    trials : sequence of Trial
    model : Model
    point : (p,) float
    near : sequence of (k,) float, optional
        Nuisances of a similar model.
    kin : JointFit, optional
        Other recordings, as the model explains them; by default these.
    """
    values, effects = model.split(point)
    own = [t.begin(values, effects) for t in trials]
    found = _nuisances_only(trials, model, point, own if near is None else near)
    if not effects:
        return found

    def bare(left: Sequence[int]) -> JointFit:
        few, starts = [trials[k] for k in left], [own[k] for k in left]
        if near is None:
            plain = replace(model, held={}, free=())
            starts = list(_nuisances_only(few, plain, point[: len(model.physics)], starts).nuisances)
        return _nuisances_only(few, model, point, starts)

    def grown(left: Sequence[int]) -> JointFit:
        few = [trials[k] for k in left]
        lengths = horizons(few, radian(few))
        if len(lengths) < 2:
            return _nuisances_only(few, model, point, [own[k] for k in left])
        short = [t.until(lengths[0]) for t in few]
        small = [t.begin(values, effects) for t in short]

        def shrunk(share: float) -> JointFit:
            return led(short, model, point, [np.inf], STEPS, [share * start for start in small], shared=False)

        fits = list(side_by_side(shrunk, SHARES))
        parts = np.array([np.where(np.isfinite(f.parts), f.parts, np.inf) for f in fits])
        begun = [fits[f].nuisances[k] for k, f in enumerate(np.argmin(parts, axis=0))]
        return led(few, model, point, lengths[1:], LAST, begun, shared=False)

    def let_go(left: Sequence[int]) -> JointFit:
        # where damping grows with deflection the first push hardly swings, and no small motion looks like it; what is
        # let go at rest has its deflection in the first samples, before any damping acts
        few = [trials[k] for k in left]
        undeflected = [np.zeros_like(own[k]) for k in left]
        begun = _nuisances_only([_let_go_at_rest(t) for t in few], model, point, undeflected)
        return led(few, model, point, horizons(few, radian(few)), LAST, begun.nuisances, shared=False)

    def alike(sign: float) -> Callable[[Sequence[int]], JointFit]:
        def road(left: Sequence[int]) -> JointFit:
            like = [_in_proportion(trials[k], own[k], found if kin is None else kin, sign) for k in left]
            return _nuisances_only([trials[k] for k in left], model, point, like)

        return road

    for road in (bare, alike(1.0), alike(-1.0), grown, let_go):
        found = _better(found, road, kin)
    return found


def _let_go_at_rest(trial: Trial) -> Trial:
    """The first samples of a recording whose velocities start at zero."""
    first = trial.until(0.0)
    speeds = [name for name in first.nuisances if name.endswith(("_rate", "_velocity"))]
    return replace(first, idle={**first.idle, **dict.fromkeys(speeds, ())})


def _better(found: JointFit, road: Callable[[Sequence[int]], JointFit], kin: JointFit | None) -> JointFit:
    """Decays that are left with more than noise by another road, where that one is better.

    Where the model leaves the like of it too, it is no start that is wanting.
    """
    left = [k for k, trial in enumerate(found.trials) if trial.quiet and not found.parts[k] < LOUD * trial.size]
    if kin is not None:
        left = [k for k in left if min(_kin(found.trials[k], kin), default=(0.0, 0))[0] < LOUD]
    if not left:
        return found
    other = road(left)
    nuisances = list(found.nuisances)
    for index, k in enumerate(left):
        if np.isfinite(other.parts[index]) and not other.parts[index] > found.parts[k]:
            nuisances[k] = other.nuisances[index]
    return evaluate(found.trials, found.model, found.point, nuisances)


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


def _nuisances_only(trials: Sequence[Trial], model: Model, point: Array, start: Sequence[Array]) -> JointFit:
    return led(trials, model, point, [np.inf], LAST, start, shared=False)


def radian(trials: Sequence[Trial]) -> float:
    """Seconds in which the motion of the loudest channel turns by one radian: its rms over that of its slope.

    Mains lines and noise are taken off both, for their slopes are steep. The median recording of the fastest kind.
    """
    kinds: dict[str, list[float]] = {}
    for trial in trials:
        signal = trial.colour(np.zeros_like(trial.target))
        loudest = int(np.argmax(signal.std(axis=0)))
        column, noise = signal[:, loudest], trial.noises[loudest].std ** 2 if trial.quiet else 0.0
        size, slope = float(np.var(column)) - noise, float(np.var(np.diff(column))) - 2.0 * noise
        if size > 0.0 and slope > 0.0:
            kinds.setdefault(trial.kind, []).append(float(np.sqrt(size / slope)) * trial.step)
    return min((float(np.median(found)) for found in kinds.values()), default=trials[0].step)


def predicted(trial: Trial, values: Values, effects: Effects, nuisance: Array) -> Prediction:
    """All samples of a recording, with the zeros of its sensors."""
    course = trial.course
    simulated = course.run(values, effects, nuisance)
    rate = 1.0 / float(course.times[1] - course.times[0])
    rest = course.measured - simulated
    if course.low_pass_hz is not None and course.low_pass_hz < 0.45 * rate:
        rest = low_pass(rest, rate, course.low_pass_hz)
    zero = rest.mean(axis=0)
    sized = nuisance * trial.scales
    found = {name: float(number) for name, number in zip(trial.nuisances, sized, strict=True) if number != 0.0}
    units = [unit.replace("/", "_").replace("^", "") for unit in course.units]
    zeros = {f"zero_{c}_{u}" if c != "force" else f"zero_{u}": float(z)
             for c, u, z in zip(trial.channels, units, zero, strict=True)}  # fmt: skip
    return Prediction(
        course.times, trial.channels, course.units, course.measured, simulated + zero,
        low_pass_hz=course.low_pass_hz, nuisances={**found, **zeros},
    )  # fmt: skip
