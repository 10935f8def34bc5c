"""How far estimates scatter: slopes fine enough to show what recordings cannot tell, and noise that is not white.

A fit is led by one-sided differences with steps that a descent can use. What these err by counts as information: a
mass on a spring that is let go moves alike whatever it weighs, and its mass was given to 0.5 % of what the file left
open. So the slopes of an answer are symmetric differences with finer steps.

Least squares in coloured noise: the covariance is H⁻¹ G H⁻¹, where H is the curvature that the fit supposes and G the
scatter of its slope, Σ |J(f)|² S(f) with the power spectrum S of what the fit leaves (Huber, Proc. 5th Berkeley
Symposium, 1967; White, Econometrica 48, 1980). What a formula errs by sits where the motion is, and counts there. To G
belongs what priors leave open, of nuisances as of the rest: the place where a spring bends is known by how far off
sensors may be, and by nothing else.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from ssmr_ident.identify.fitting.curvature import Curvature
from ssmr_ident.identify.fitting.joint import NUISANCE_STEP, JointFit, Slopes, acting, over
from ssmr_ident.identify.trials.trial import Asked

Array = np.ndarray

FINE = 1e-4
"""Share of a descent's steps: symmetric differences then err by 10⁻⁸ of what they did, rounding by 10⁻⁷. A force that
bends makes them err by the share of samples in which a step crosses the bend: at a hundred times this share the place
of a bend was stated to 0.29 mm, and here to the 0.387 by which its cost rises."""

SIDES = (1.0, -1.0)

SMOOTHED = 15
"""Bins of a periodogram over which its mean is taken: S is known to a quarter then."""


def covariance(fit: JointFit) -> Array:
    """Of the scaled coordinates, nuisances integrated out.

    Parameters
    ----------
    fit : JointFit
        With slopes.

    Returns
    -------
    (p, p) float
    """
    return sandwich(sharpened(fit))


def sandwich(fit: JointFit) -> Array:
    """The same, (p, p) float, by the slopes that a fit has."""
    matrix, _ = Curvature.of(fit, fit.weights).normal_equations()
    scatter = np.eye(len(fit.point))
    for weight, trial, slopes, residual in zip(fit.weights, fit.trials, fit.slopes, fit.residuals, strict=True):
        a, b = slopes.shared, slopes.own
        own = weight * (b.T @ b) + np.eye(b.shape[1])
        carried = np.linalg.solve(own, weight * (b.T @ a))
        cleared = a - b @ carried
        scatter += carried.T @ carried
        left = trial.by_channel(residual)
        columns = [trial.by_channel(column) for column in cleared.T]
        for c in range(left.shape[1] if columns else 0):
            power = smoothed(np.abs(np.fft.fft(left[:, c])) ** 2) / len(left)
            lines = np.fft.fft(np.column_stack([column[:, c] for column in columns]), axis=0)
            scatter += weight**2 * np.real((lines.conj().T * power) @ lines) / len(left)
    inverse = np.linalg.inv(matrix)
    return inverse @ scatter @ inverse


def sharpened(fit: JointFit) -> JointFit:
    """The same fit with symmetric differences of fine steps.

    Recordings that ask for coarse steps, as pulls do whose contacts chatter, keep their slopes.
    """
    here, steps = fit.model.split(fit.point), FINE * np.array(fit.model.steps())
    names, width = [unknown.name for unknown in fit.model.unknowns], FINE * NUISANCE_STEP
    # a robot that has been split once is built once for all trials
    ends = [
        [fit.model.with_one(here, k, float(fit.point[k] + side * steps[k])) for side in SIDES]
        for k in range(len(names))
    ]

    def one(index: int) -> Slopes:
        trial, nuisance, before = fit.trials[index], fit.nuisances[index], fit.slopes[index]
        if trial.coarse != 1.0:
            return before
        seen, own = [k for k, name in enumerate(names) if trial.sees(name)], acting(trial, fit.model)
        asked: list[Asked] = [(*end, nuisance) for k in seen for end in ends[k]]
        asked += [(*here, nuisance + side * width * np.eye(len(nuisance))[k]) for k in own for side in SIDES]
        if not asked:
            return before
        found = trial.whitened(trial.runs(asked))
        across = 0.5 * (found[:, ::2] - found[:, 1::2]) / np.array([*steps[seen], *[width] * len(own)])
        # where a step leaves what can be simulated, what stood there stays
        fine = np.where(
            np.all(np.isfinite(across), axis=0), across, np.hstack([before.shared[:, seen], before.own[:, own]])
        )
        slopes = Slopes(before.shared.copy(), before.own.copy())
        slopes.shared[:, seen], slopes.own[:, own] = fine[:, : len(seen)], fine[:, len(seen) :]
        return slopes

    return replace(fit, slopes=tuple(over(fit.trials, one)))


def smoothed(power: Array) -> Array:
    """Mean of (n,) bins of a periodogram over their neighbours, round the circle."""
    width = min(SMOOTHED, len(power))
    around = np.concatenate([power[len(power) - width // 2 :], power, power[: width - 1 - width // 2]])
    return np.convolve(around, np.full(width, 1.0 / width), "valid")
