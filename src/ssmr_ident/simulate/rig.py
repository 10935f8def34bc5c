"""A rig with one degree of freedom, driven by a measured force or let go."""

from __future__ import annotations

import math

import numpy as np
from scipy.linalg import expm
from scipy.signal import resample

from ssmr_ident.core.errors import SimulationError
from ssmr_ident.core.kernel import kernel
from ssmr_ident.physics.rig import Rig
from ssmr_ident.physics.sensor import filter_step, low_pass_coefficients


def simulate_rig(
    rig: Rig,
    force: np.ndarray,
    sample_rate: float,
    position: float = 0.0,
    velocity: float = 0.0,
    oversampling: int = 4,
    bandwidth_hz: float = math.inf,
) -> np.ndarray:
    """Motion of the rig under a sampled force.

    The mass, spring and damper are propagated exactly over a step with the force in a straight line across it; the
    force is first made ``oversampling`` times finer within its band, because straight lines between the samples
    of a force near half the sampling rate are not what acted.

    Parameters
    ----------
    rig : Rig
    force : (n,) float [N] or [N m]
    sample_rate : float [Hz]
    position, velocity : float
        At the first sample.
    oversampling : int
        At least; more is taken where the accelerometer's bandwidth asks for it.
    bandwidth_hz : float
        Of the accelerometer, a second-order low-pass; it acts on the acceleration alone.

    Returns
    -------
    (n, 3) float
        Position, velocity, acceleration at the samples.
    """
    n = len(force)
    if math.isfinite(bandwidth_hz):  # the bilinear low-pass is true to 0.1 % in phase from here on
        oversampling = max(oversampling, math.ceil(8.0 * bandwidth_hz / sample_rate))
    fine = force if oversampling == 1 else band_limited(force, oversampling)
    step = 1.0 / (sample_rate * oversampling)
    out = np.empty((n, 3))
    laws = (rig.mass, rig.damping, rig.stiffness, low_pass_coefficients(bandwidth_hz, step))
    _run(*_propagators(rig, step), *laws, fine, position, velocity, oversampling, out)
    if not np.isfinite(out[-1]).all():
        row = int(np.flatnonzero(~np.isfinite(out).all(axis=1))[0])
        raise SimulationError(
            f"the rig left the finite numbers at t = {row / sample_rate:.4g} s; mass {rig.mass:g}, "
            f"damping {rig.damping:g}, stiffness {rig.stiffness:g}"
        )
    return out


def band_limited(signal: np.ndarray, factor: int) -> np.ndarray:
    """Finer samples of a band-limited signal, (n,) to ((n - 1)·factor + 1,).

    By Fourier series over the signal and its mirror image, so that the ends meet without a jump.
    """
    n = len(signal)
    if n < 4:
        return np.interp(np.arange((n - 1) * factor + 1) / factor, np.arange(n), signal)
    mirrored = np.concatenate([signal, signal[-2:0:-1]])
    return resample(mirrored, len(mirrored) * factor)[: (n - 1) * factor + 1]


def _propagators(rig: Rig, step: float) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Exact step of (x, v) under a force that runs straight from f0 to f1: state matrix and the two weights."""
    a = np.zeros((4, 4))
    a[0, 1] = 1.0
    a[1] = [-rig.stiffness / rig.mass, -rig.damping / rig.mass, 1.0 / rig.mass, 0.0]
    a[2, 3] = 1.0 / step
    e = expm(a * step)
    return e[:2, :2].copy(), e[:2, 2] - e[:2, 3], e[:2, 3].copy()


@kernel
def _run(
    transition, weight_now, weight_next, mass, damping, stiffness, low_pass, force, position, velocity, every, out
):
    x, v = position, velocity
    first = (force[0] - damping * v - stiffness * x) / mass
    history = np.full(4, first)
    steps = (out.shape[0] - 1) * every
    for n in range(steps + 1):
        acceleration = filter_step(history, (force[n] - damping * v - stiffness * x) / mass, low_pass)
        if n % every == 0:
            row = out[n // every]
            row[0], row[1], row[2] = x, v, acceleration
        if n < steps:
            now, later = force[n], force[n + 1]
            x, v = (
                transition[0, 0] * x + transition[0, 1] * v + weight_now[0] * now + weight_next[0] * later,
                transition[1, 0] * x + transition[1, 1] * v + weight_now[1] * now + weight_next[1] * later,
            )
