"""Decays of a linear model fitted exactly: eigenvalues in place of time steps, states at the release eliminated.

A small motion is a sum of exponentials; so is what a small change of a parameter adds to it, each also times t. One
set of these columns per recording gives cost, slopes and curvature of all parameters. The states at the release,
which enter linearly, are solved for at every point (variable projection; Golub and Pereyra 1973, with Kaufman's step).
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from ssmr_ident.doctor.decays.modes import GROWTH, SENSOR_STATES, Modes, Slopes, modes_at, slopes_of, waves
from ssmr_ident.doctor.decays.recordings import Decay, Sensed
from ssmr_ident.identify.fitting.coordinates import Model
from ssmr_ident.identify.trials.decay import SCALES
from ssmr_ident.physics.extended import BODY

Array = np.ndarray

SENSOR_SCALE = 30.0
"""Prior standard deviation of what a slow sensor still has to make up for at the begin [m/s^2]."""

STRIDE, EFFECT_STRIDE = 3.0, 0.6
"""Furthest that a step moves what is known beforehand, in its standard deviations, and an effect's coordinate."""

LEAST_GAIN = 0.05
"""Fall of the cost at which a fit is at rest."""

DAMPED = 6
"""Dampings that are tried in a step, each ten times the last."""


@dataclass(frozen=True, eq=False)
class LinearFit:
    """A linear model at some point.

    Parameters
    ----------
    model : Model
    point : (p,) float
    cost : float
        Of whitened residuals, priors and states at the release.
    chi2 : float
        Of the residuals alone.
    states : tuple of (k,) float
        At the release, SI: the body's twelve first.
    information : (p, p) float
        Curvature of half the cost, the states eliminated; its priors, of unit width, are in it.
    """

    model: Model
    point: Array
    cost: float
    chi2: float
    states: tuple[Array, ...]
    information: Array


@dataclass(frozen=True, eq=False)
class System:
    """Cost, half its gradient and curvature in the coordinates, all else eliminated."""

    cost: float
    chi2: float
    gradient: Array
    information: Array
    states: tuple[Array, ...]


def fit_linear(
    decays: Sequence[Decay], model: Model, point: Array, steps: int = 25, temper: float = 1.0
) -> LinearFit | None:
    """Levenberg-Marquardt from a point.

    Parameters
    ----------
    decays : sequence of Decay
    model : Model
        Its effects among ``physics.extended.LINEAR``.
    point : (p,) float
    steps : int
        At the most; 0 finds the states at the release alone.
    temper : float
        Variance of what counts as noise, in that of the recordings' white noise.

    Returns
    -------
    LinearFit or None
        None where there is no such robot at the point, or it falls over.
    """
    now = system(decays, model, point, temper)
    if now is None:
        return None
    damping = 1e-3
    stride = np.where(np.arange(len(point)) < len(model.physics), STRIDE, EFFECT_STRIDE)
    for _ in range(steps):
        moved = None
        for _ in range(DAMPED):
            curved = now.information + damping * np.diag(np.diag(now.information))
            move = -np.linalg.solve(curved, now.gradient)
            move *= min(1.0, float(np.min(stride / np.maximum(np.abs(move), 1e-300))))
            if -float(move @ now.gradient) < LEAST_GAIN:
                break
            then = system(decays, model, point + move, temper)
            if then is not None and then.cost < now.cost:
                moved = then
                break
            damping = max(10.0 * damping, 1e-3)
        if moved is None:
            break
        gain, point, now, damping = now.cost - moved.cost, point + move, moved, 0.2 * damping
        if gain < LEAST_GAIN:
            break
    return LinearFit(model, point, now.cost, now.chi2, now.states, now.information)


def system(decays: Sequence[Decay], model: Model, point: Array, temper: float = 1.0) -> System | None:
    """Normal equations at a point; None where there is no such robot, or it falls over."""
    first = decays[0]
    modes = modes_at(first.builder, model, point, first.log_step)
    if modes is None or modes.poles.real.max() * max(float(d.times[-1]) for d in decays) > GROWTH:
        return None
    moved = slopes_of(modes, first.builder, model, point, first.log_step)
    scales = state_scales(modes)
    columns: dict[tuple[float, float], Array] = {}
    sensed: dict[tuple[float, int], Sensed] = {}
    cost, chi2 = float(point @ point), 0.0
    gradient, information = point.copy(), np.eye(len(point))
    states = []
    for decay in decays:
        grid, sampling = (decay.first, decay.step), (decay.log_step, decay.block)
        if grid not in columns:
            count = max(len(d.times) for d in decays if (d.first, d.step) == grid)
            columns[grid] = waves(modes.kept, *grid, count)
        if sampling not in sensed:
            sensed[sampling] = decay.sensed(modes.kept, modes.bandwidth_hz, modes.of_sensor, bool(moved.by_band.any()))
        white = decay.whitened(columns[grid][: len(decay.times)]) / math.sqrt(temper)
        target = decay.trial.white_target / math.sqrt(temper)
        part = _of_decay(decay, white, target, modes, moved, sensed[sampling], scales)
        if part is None:
            return None
        x, rest, projected, slope = part
        chi2 += float(rest @ rest)
        cost += float(rest @ rest) + float(x @ x)
        states.append(scales * x)
        gradient -= slope.T @ rest
        information += slope.T @ projected
    return System(cost, chi2, gradient, information, tuple(states)) if math.isfinite(cost) else None


def _of_decay(
    decay: Decay, white: Array, target: Array, modes: Modes, moved: Slopes, sensed: Sensed, scales: Array
) -> tuple[Array, Array, Array, Array] | None:
    """Scaled states at the release, residuals, and slopes with the states' share taken out and in; None where no state
    can be told, for modes fall together or grow beyond all numbers."""
    design = design_of(decay, white, modes, sensed) * scales
    try:
        factor = np.linalg.inv(np.linalg.cholesky(design.T @ design + np.eye(design.shape[1])))
    except np.linalg.LinAlgError:  # not positive definite, or not finite
        return None
    x = factor.T @ (factor @ (design.T @ target))
    rest = target - design @ x
    slope = linear_slopes(decay, white, modes, moved, sensed, scales * x)
    return x, rest, slope - design @ (factor.T @ (factor @ (design.T @ slope))), slope


def design_of(decay: Decay, white: Array, modes: Modes, sensed: Sensed) -> Array:
    """Whitened recordings over the states at the release, (N, k) float."""
    count = len(modes.kept)
    read = modes.read[list(decay.axes)]
    amplitude = (read[:, modes.keep] * sensed.gain * modes.weight)[:, :, None] * modes.into[modes.keep]
    columns = np.concatenate([amplitude.real, -amplitude.imag], axis=1)
    return np.asarray((white[:, :, : 2 * count] @ columns).reshape(-1, columns.shape[2]))


def linear_slopes(decay: Decay, white: Array, modes: Modes, moved: Slopes, sensed: Sensed, state: Array) -> Array:
    """Whitened recordings' slopes by the coordinates where the states at the release are given, (N, p) float."""
    axes = list(decay.axes)
    read = modes.read[axes]
    own = modes.into @ state
    # what each exponential's amplitude changes by, and that of the same times t
    change = moved.read[:, axes] * own + read * (moved.between @ own)[:, None, :] - moved.back[:, axes] * own
    change = change + read * (moved.start @ state)[:, None, :]
    drift = (read * own)[:, modes.keep] * modes.weight
    pole = moved.poles[:, None, modes.keep]
    plain = change[:, :, modes.keep] * sensed.gain * modes.weight + sensed.by_pole * drift * pole
    plain = plain + sensed.by_band * drift * moved.by_band[:, None, None]
    late = sensed.gain * drift * pole
    coefficients = np.concatenate([plain.real, -plain.imag, late.real, -late.imag], axis=2)
    slope = np.matmul(white, coefficients.transpose(1, 2, 0))
    return np.asarray(slope.reshape(-1, slope.shape[2]))


def state_count(modes: Modes) -> int:
    """What is free at the release."""
    return BODY + 4 * modes.sways + 6 * modes.relaxes + SENSOR_STATES * modes.slow


def state_scales(modes: Modes) -> Array:
    """Prior standard deviations of what is free at the release."""
    parts = [SCALES[:BODY]]
    parts += [SCALES[BODY : BODY + 4]] if modes.sways else []
    parts += [SCALES[:6]] if modes.relaxes else []
    parts += [np.full(SENSOR_STATES, SENSOR_SCALE)] if modes.slow else []
    return np.concatenate(parts)
