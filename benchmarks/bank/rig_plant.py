"""A rig with one mass and any laws, by classical Runge-Kutta: nothing in common with simulate/rig.py's exact steps."""

from __future__ import annotations

import math

import numpy as np
from scipy.signal import butter, resample, sosfilt

from bank.laws import STATES, force, moved, rates
from ssmr_ident.core.kernel import kernel
from ssmr_ident.physics.rig import Rig

STEP = 4e-5  # s, at most


def run_rig(
    rig: Rig,
    drive: np.ndarray,
    sample_rate: float,
    laws: np.ndarray,
    start: tuple[float, float] = (0.0, 0.0),
    bandwidth_hz: float = math.inf,
) -> np.ndarray:
    """Position, velocity, acceleration at the samples of the force, (n, 3) float.

    Parameters
    ----------
    rig : Rig
    drive : (n,) float [N]
        Periodic or quiet at its ends is not asked for: it is mirrored before it is made finer.
    sample_rate : float [Hz]
    laws : (m, WIDTH) float
    start : (float, float) [m], [m/s]
    bandwidth_hz : float
        Of the accelerometer: a Butterworth low-pass of second order, run at the fine step.
    """
    every = max(8, math.ceil(1.0 / (sample_rate * STEP)))
    step = 1.0 / (sample_rate * every)
    # the halves of a Runge-Kutta step need the force as well: twice as fine
    mirrored = np.concatenate([drive, drive[-2:0:-1]])
    fine = resample(mirrored, len(mirrored) * 2 * every)[: (len(drive) - 1) * 2 * every + 1] if drive.any() else None
    if fine is None:
        fine = np.zeros((len(drive) - 1) * 2 * every + 1)
    out = np.empty(((len(drive) - 1) * every + 1, 3))
    _run(rig.mass, rig.damping, rig.stiffness, laws, fine, start[0], start[1], step, out)
    if math.isfinite(bandwidth_hz):
        low_pass = butter(2, bandwidth_hz, fs=1.0 / step, output="sos")
        first = out[0, 2]
        out[:, 2] = first + sosfilt(low_pass, out[:, 2] - first)
    return out[::every].copy()


@kernel
def _slope(mass, damping, stiffness, laws, drive, x, v, z, t, dz):
    total = drive - damping * v - stiffness * x
    for j in range(laws.shape[0]):
        total -= force(laws[j], x, v, z[j], t)
        rates(laws[j], x, v, z[j], dz[j])
    return total / mass


@kernel
def _run(mass, damping, stiffness, laws, fine, x, v, step, out):
    count = laws.shape[0]
    z, trial = np.zeros((count, STATES)), np.zeros((count, STATES))
    k1, k2, k3, k4 = (
        np.zeros((count, STATES)), np.zeros((count, STATES)), np.zeros((count, STATES)), np.zeros((count, STATES)),
    )  # fmt: skip
    half = 0.5 * step
    for n in range(out.shape[0]):
        t = n * step
        a1 = _slope(mass, damping, stiffness, laws, fine[2 * n], x, v, z, t, k1)
        out[n, 0], out[n, 1], out[n, 2] = x, v, a1
        if n + 1 == out.shape[0]:
            break
        for j in range(count):
            for i in range(STATES):
                trial[j, i] = z[j, i] + half * k1[j, i]
            moved(laws[j], z[j], half * v, trial[j])
        v2 = v + half * a1
        a2 = _slope(mass, damping, stiffness, laws, fine[2 * n + 1], x + half * v, v2, trial, t + half, k2)
        for j in range(count):
            for i in range(STATES):
                trial[j, i] = z[j, i] + half * k2[j, i]
            moved(laws[j], z[j], half * v2, trial[j])
        v3 = v + half * a2
        a3 = _slope(mass, damping, stiffness, laws, fine[2 * n + 1], x + half * v2, v3, trial, t + half, k3)
        for j in range(count):
            for i in range(STATES):
                trial[j, i] = z[j, i] + step * k3[j, i]
            moved(laws[j], z[j], step * v3, trial[j])
        v4 = v + step * a3
        a4 = _slope(mass, damping, stiffness, laws, fine[2 * n + 2], x + step * v3, v4, trial, t + step, k4)
        travel = step / 6.0 * (v + 2.0 * v2 + 2.0 * v3 + v4)
        x += travel
        v += step / 6.0 * (a1 + 2.0 * a2 + 2.0 * a3 + a4)
        for j in range(count):
            for i in range(STATES):
                z[j, i] += step / 6.0 * (k1[j, i] + 2.0 * k2[j, i] + 2.0 * k3[j, i] + k4[j, i])
            moved(laws[j], z[j], travel, z[j])
