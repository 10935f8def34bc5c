"""A rig with one degree of freedom, driven by a measured force or let go."""

from __future__ import annotations

import math

import numpy as np
from scipy.linalg import expm

from ssmr_ident.core.errors import InputError, SimulationError
from ssmr_ident.core.kernel import kernel
from ssmr_ident.physics.effects import CATALOGUE, unlisted
from ssmr_ident.physics.element import STATES, element_advance, element_force
from ssmr_ident.physics.rig import Rig
from ssmr_ident.physics.sensor import filter_step, low_pass_coefficients
from ssmr_ident.physics.slots import UNLISTED, Effects, checked, effect_vector
from ssmr_ident.simulate.sensed import sensed

_unlisted = unlisted.force


def simulate_rig(
    rig: Rig,
    force: np.ndarray,
    sample_rate: float,
    position: float = 0.0,
    velocity: float = 0.0,
    oversampling: int = 4,
    bandwidth_hz: float = math.inf,
    effects: Effects | None = None,
    fine: bool = False,
) -> np.ndarray:
    """Motion of the rig under a sampled force.

    The mass, spring and damper are propagated exactly over a step with the force in a straight line across it; the
    force is first made ``oversampling`` times finer within its band, because straight lines between the samples
    of a force near half the sampling rate are not what acted. Effects kick the mass before and after each step
    (Strang splitting, second order), and are passed over when there are none.

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
    effects : mapping of effect id to parameters
    fine : bool
        ``force`` has been made ``oversampling`` times finer already, ((n - 1)·oversampling + 1,): who runs one force
        many times need not interpolate it every time.

    Returns
    -------
    (n, 3) float
        Position, velocity, acceleration at the samples.

    Raises
    ------
    SimulationError
        A state was no longer finite.
    InputError
        An unknown effect or parameter, or one that no rig has.
    """
    n = (len(force) - 1) // oversampling + 1 if fine else len(force)
    active = checked(effects or {})
    for effect_id in active:
        if not CATALOGUE[effect_id].rig:
            known = ", ".join(name for name, effect in CATALOGUE.items() if effect.rig)
            raise InputError(f"effects: {effect_id}", "does not act on a rig with one mass", f"Those that do: {known}")
    if "sensor_bandwidth" in active:
        bandwidth_hz = min(bandwidth_hz, active["sensor_bandwidth"]["bandwidth_hz"])
    if math.isfinite(bandwidth_hz) and not fine:  # the bilinear low-pass is true to 0.1 % in phase from here on
        oversampling = max(oversampling, math.ceil(8.0 * bandwidth_hz / sample_rate))
    driving = force if fine or oversampling == 1 else band_limited(force, oversampling)
    step = 1.0 / (sample_rate * oversampling)
    out = np.empty((n, 3))
    e = effect_vector(active)
    beside = not np.array_equal(e, effect_vector({}))
    laws = (rig.mass, rig.damping, rig.stiffness, e, beside, low_pass_coefficients(bandwidth_hz, step))
    _run(*_propagators(rig, step), *laws, driving, position, velocity, step, oversampling, out)
    if not np.isfinite(out[-1]).all():
        row = int(np.flatnonzero(~np.isfinite(out).all(axis=1))[0])
        raise SimulationError(
            f"the rig left the finite numbers at t = {row / sample_rate:.4g} s with effects {active or 'none'}; "
            f"mass {rig.mass:g}, damping {rig.damping:g}, stiffness {rig.stiffness:g}"
        )
    channels = sensed(np.arange(n) / sample_rate, {"acceleration": out[:, 2]}, active)
    out[:, 2] = channels["acceleration"]
    return out


def band_limited(signal: np.ndarray, factor: int) -> np.ndarray:
    """Finer samples of a band-limited signal, (n,) to ((n - 1)·factor + 1,).

    By Fourier series over the signal and its mirror image, so that the ends meet without a jump.
    """
    n = len(signal)
    if n < 4:
        return np.interp(np.arange((n - 1) * factor + 1) / factor, np.arange(n), signal)
    from scipy.signal import resample  # half a second that a swivel from the command line need not wait for

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
    transition, weight_now, weight_next, mass, damping, stiffness, e, beside, low_pass,
    force, position, velocity, step, every, out,
):  # fmt: skip
    x, v = position, velocity
    hidden = np.zeros(STATES)
    free = e[UNLISTED:]
    extra = element_force(x, v, hidden, stiffness, 1.0, 1.0, True, e) + _unlisted(x, v, free) if beside else 0.0
    first = (force[0] - damping * v - stiffness * x - extra) / mass
    history = np.full(4, first)
    steps = (out.shape[0] - 1) * every
    for n in range(steps + 1):
        acceleration = filter_step(history, (force[n] - damping * v - stiffness * x - extra) / mass, low_pass)
        if n % every == 0:
            row = out[n // every]
            row[0], row[1], row[2] = x, v, acceleration
        if n < steps:
            if beside:
                v -= 0.5 * step / mass * extra
            now, later, start = force[n], force[n + 1], x
            x, v = (
                transition[0, 0] * x + transition[0, 1] * v + weight_now[0] * now + weight_next[0] * later,
                transition[1, 0] * x + transition[1, 1] * v + weight_now[1] * now + weight_next[1] * later,
            )
            if beside:
                element_advance(hidden, (x - start) / step, step, True, e)
                # the second kick takes the velocity after it, so that damping keeps the second order
                kicked = v
                for _ in range(3):
                    extra = element_force(x, kicked, hidden, stiffness, 1.0, 1.0, True, e)
                    extra += _unlisted(x, kicked, free)
                    kicked = v - 0.5 * step / mass * extra
                v = kicked
