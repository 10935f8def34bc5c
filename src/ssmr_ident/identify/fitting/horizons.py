"""Fits that are led from the beginning of the recordings to their end.

Over two or three periods no oscillation can be taken for its neighbour, whatever the parameters; the answer there is
near enough for twice that time, and so on (progressive horizon; Bock 1987 cures the same ill by multiple shooting).
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from ssmr_ident.identify.fitting.coordinates import Model
from ssmr_ident.identify.fitting.descent import descend
from ssmr_ident.identify.fitting.joint import JointFit, evaluate
from ssmr_ident.identify.trials.trial import Trial

Array = np.ndarray

FIRST = 16.0
"""Radians of the motion in the first horizon: two and a half periods."""

DRIVEN = 60.0
"""Radians of the motion in the part of a driven recording that effects are tried on."""

GROWTH = 2.0
STEPS = 8
"""Gauss-Newton steps on each horizon but the last, at the most."""

NEAR = 0.02
"""Fall of the cost, per independent sample, at which a fit on a horizon is near enough to go on."""


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


def horizons(trials: Sequence[Trial], time: float) -> list[float]:
    """Lengths [s], the last being infinite; only that where nothing can be shortened."""
    if not any(trial.shorten for trial in trials):
        return [np.inf]
    longest = max(float(t.times[-1] - t.times[0]) for t in trials)
    if any(trial.experiment.driven for trial in trials):
        # the force keeps the phase: a part is only a shorter recording
        return [max(DRIVEN * time, longest / 8.0), np.inf] if longest > 4.0 * DRIVEN * time else [np.inf]
    found, length = [], FIRST * time
    while length < 0.75 * longest:
        found.append(length)
        length *= GROWTH
    return [*found, np.inf]


def horizon_fit(
    trials: Sequence[Trial],
    model: Model,
    point: Array,
    lengths: Sequence[float],
    last: int,
    nuisances: Sequence[Array] | None = None,
    shared: bool = True,
) -> JointFit:
    """Fit over growing horizons.

    Parameters
    ----------
    trials : sequence of Trial
    model : Model
    point : (p,) float
    lengths : sequence of float [s]
    last : int
        Steps on the last horizon.
    nuisances : sequence of (k,) float, optional
        None begins with those of small motions.
    shared : bool
        False moves the nuisances alone.
    """
    values, effects = model.split(point)
    own = [t.until(lengths[0]).begin(values, effects) for t in trials] if nuisances is None else list(nuisances)
    fit = None
    for index, length in enumerate(lengths):
        fit = evaluate([t.until(length) for t in trials], model, point, own)
        if index < len(lengths) - 1:
            fit = descend(fit, STEPS, settled=NEAR * fit.independent, shared=shared)
        else:
            fit = descend(fit, last, shared=shared)
        point, own = fit.point, list(fit.nuisances)
    assert fit is not None
    return fit
