"""Bodies on springs with any laws at one of them, by classical Runge-Kutta, which shares no code with the library."""

from __future__ import annotations

import math

import numpy as np
from scipy.signal import resample

from bank.laws import STATES, force, moved, rates
from ssmr_ident.core.kernel import kernel


def run_network(
    mass: np.ndarray, damping: np.ndarray, stiffness: np.ndarray, stretch: np.ndarray, laws: np.ndarray,
    drive: np.ndarray, into: int, sample_rate: float, step: float,
) -> np.ndarray:  # fmt: skip
    """Coordinates, rates and accelerations at the samples of the force, (n, 3, bodies) float.

    Parameters
    ----------
    mass : (bodies,) float [kg]
    damping, stiffness : (bodies, bodies) float
    stretch : (bodies,) float
        Of the spring at which the laws act.
    laws : (m, WIDTH) float
    drive : (n,) float [N]
    into : int
        Body on which it acts.
    sample_rate : float [Hz]
    step : float [s]
        At most.
    """
    every = max(8, math.ceil(1.0 / (sample_rate * step)))
    mirrored = np.concatenate([drive, drive[-2:0:-1]])
    # the halves of a Runge-Kutta step need the force as well: twice as fine
    fine = resample(mirrored, len(mirrored) * 2 * every)[: (len(drive) - 1) * 2 * every + 1]
    out = np.empty((len(drive), 3, len(mass)))
    _run(mass, damping, stiffness, stretch, laws, fine, into, 1.0 / (sample_rate * every), every, out)
    return out


@kernel
def _slope(mass, damping, stiffness, stretch, laws, drive, into, q, v, z, t, dz):
    x, rate = 0.0, 0.0
    for i in range(len(mass)):
        x += stretch[i] * q[i]
        rate += stretch[i] * v[i]
    beside = 0.0
    for j in range(laws.shape[0]):
        beside += force(laws[j], x, rate, z[j], t)
        rates(laws[j], x, rate, z[j], dz[j])
    a = np.empty(len(mass))
    for i in range(len(mass)):
        total = -stretch[i] * beside + (drive if i == into else 0.0)
        for k in range(len(mass)):
            total -= damping[i, k] * v[k] + stiffness[i, k] * q[k]
        a[i] = total / mass[i]
    return a


@kernel
def _remembered(laws, z, dz, step, travel, out):
    for j in range(laws.shape[0]):
        for i in range(STATES):
            out[j, i] = z[j, i] + step * dz[j, i]
        moved(laws[j], z[j], travel, out[j])


@kernel
def _run(mass, damping, stiffness, stretch, laws, fine, into, step, every, out):
    n, count, half = len(mass), laws.shape[0], 0.5 * step
    q, v, z = np.zeros(n), np.zeros(n), np.zeros((count, STATES))
    k1, k2, trial = np.zeros((count, STATES)), np.zeros((count, STATES)), np.zeros((count, STATES))
    k3, k4 = np.zeros((count, STATES)), np.zeros((count, STATES))
    for at in range((out.shape[0] - 1) * every + 1):
        t = at * step
        a1 = _slope(mass, damping, stiffness, stretch, laws, fine[2 * at], into, q, v, z, t, k1)
        if at % every == 0:
            row = out[at // every]
            row[0], row[1], row[2] = q, v, a1
        if at == (out.shape[0] - 1) * every:
            break
        v2, between = v + half * a1, fine[2 * at + 1]
        _remembered(laws, z, k1, half, half * np.sum(stretch * v), trial)
        a2 = _slope(mass, damping, stiffness, stretch, laws, between, into, q + half * v, v2, trial, t + half, k2)
        v3 = v + half * a2
        _remembered(laws, z, k2, half, half * np.sum(stretch * v2), trial)
        a3 = _slope(mass, damping, stiffness, stretch, laws, between, into, q + half * v2, v3, trial, t + half, k3)
        v4 = v + step * a3
        _remembered(laws, z, k3, step, step * np.sum(stretch * v3), trial)
        a4 = _slope(
            mass, damping, stiffness, stretch, laws, fine[2 * at + 2], into, q + step * v3, v4, trial, t + step, k4
        )
        travel = step / 6.0 * (v + 2.0 * v2 + 2.0 * v3 + v4)
        q = q + travel
        v = v + step / 6.0 * (a1 + 2.0 * a2 + 2.0 * a3 + a4)
        _remembered(laws, z, (k1 + 2.0 * k2 + 2.0 * k3 + k4) / 6.0, step, np.sum(stretch * travel), z)
