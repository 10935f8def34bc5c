"""A recording beside what a model says of it: nuisances refitted, physics not."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from ssmr_ident.compare.outcome import Prediction
from ssmr_ident.identify.coordinates import Model
from ssmr_ident.identify.horizons import horizons, led
from ssmr_ident.identify.joint import JointFit, evaluate
from ssmr_ident.identify.trials.trial import Array, Trial, Values
from ssmr_ident.physics.slots import Effects
from ssmr_ident.signals.filters import low_pass

LAST = 10
"""Gauss-Newton steps on the whole recording."""


def follow(trials: Sequence[Trial], model: Model, point: Array, near: Sequence[Array] | None = None) -> JointFit:
    """A model held where it is, with the nuisances of each recording at their best.

    Small motions give the start of a decay. Where effects bend the motion away from them, two more roads are tried:
    through growing horizons, and from a start that is near, or else from the one that fits without the effects.
    Each recording takes its own best.

    Parameters
    ----------
    trials : sequence of Trial
    model : Model
    point : (p,) float
    near : sequence of (k,) float, optional
        Nuisances of a similar model.
    """
    values, effects = model.split(point)
    starts = [[t.begin(values, effects) for t in trials]]
    lengths = horizons(trials, radian(trials))
    bent = bool(effects) and any(trial.quiet for trial in trials)
    if near is not None:
        starts.append(list(near))
    elif bent:
        plain = replace(model, held={}, free=())
        starts.append(list(_at_rest(trials, plain, point[: len(model.physics)], starts[0]).nuisances))
    fits = [_at_rest(trials, model, point, start) for start in starts]
    if bent and len(lengths) > 1:
        fits.append(led(trials, model, point, lengths, LAST, shared=False))
    sums = np.array([[float(r @ r) for r in f.residuals] for f in fits])
    chosen = np.argmin(np.where(np.isfinite(sums), sums, np.inf), axis=0)
    return evaluate(trials, model, point, [fits[f].nuisances[k] for k, f in enumerate(chosen)])


def _at_rest(trials: Sequence[Trial], model: Model, point: Array, start: Sequence[Array]) -> JointFit:
    return led(trials, model, point, [np.inf], LAST, start, shared=False)


def radian(trials: Sequence[Trial]) -> float:
    """Seconds in which the motion of the loudest channel turns by one radian: its rms over that of its slope."""
    shortest = np.inf
    for trial in trials:
        signal = trial.target - trial.target.mean(axis=0)
        column = signal[:, int(np.argmax(signal.std(axis=0)))]
        shortest = min(shortest, float(np.std(column) / np.std(np.diff(column)) * trial.step))
    return shortest


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
