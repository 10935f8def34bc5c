"""A recording beside what a model says of it: nuisances refitted, physics not."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from ssmr_ident.compare.outcome import Prediction
from ssmr_ident.compare.starts import LAST, alone, by_other_starts
from ssmr_ident.core.threads import side_by_side
from ssmr_ident.identify.fitting.coordinates import Model
from ssmr_ident.identify.fitting.horizons import horizon_fit
from ssmr_ident.identify.fitting.joint import JointFit, together
from ssmr_ident.identify.trials.trial import Array, Trial, Values
from ssmr_ident.physics.slots import Effects
from ssmr_ident.signals.filters import low_pass


def follow(
    trials: Sequence[Trial],
    model: Model,
    point: Array,
    near: Sequence[Array] | None = None,
    kin: JointFit | None = None,
) -> JointFit:
    """A model held where it is, with the nuisances of each recording at their best.

    Small motions give the start of a decay, or nuisances that are near. Where effects bend the motion and more than
    noise is left, other starts are tried. Each recording goes by itself: one that takes long is no reason to go on with
    those that are at rest.

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
    starts = begun(trials, model, point) if near is None else near
    pairs = list(zip(trials, starts, strict=True))
    found = together(list(side_by_side(lambda pair: alone(pair[0], model, point, pair[1]), pairs)))
    return by_other_starts(found, kin, known=near is not None) if found.model.ids else found


def nearest(trials: Sequence[Trial], model: Model, point: Array, near: Sequence[Array] | None = None) -> JointFit:
    """The same from the first start alone, all recordings at one step until they gain no more together.

    Where physics is to be fitted at once, it is no use to bring each to rest.
    """
    starts = begun(trials, model, point) if near is None else near
    return horizon_fit(trials, model, point, [np.inf], LAST, starts, shared=False)


def begun(trials: Sequence[Trial], model: Model, point: Array) -> list[Array]:
    """Nuisances that small motions give."""
    values, effects = model.split(point)
    return [t.begin(values, effects) for t in trials]


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
