"""A rig with one degree of freedom, driven by a measured force or let go."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

import numpy as np
from scipy.linalg import expm

from ssmr_ident.core.errors import InputError, SimulationError
from ssmr_ident.core.kernel import kernel
from ssmr_ident.physics.effects import CATALOGUE, unlisted
from ssmr_ident.physics.element import STATES
from ssmr_ident.physics.rig import Rig
from ssmr_ident.physics.sensor import filter_step, low_pass_coefficients
from ssmr_ident.physics.slots import LOAD_FRICTION, LOAD_SHARE, UNLISTED, Effects, checked, effect_vector
from ssmr_ident.physics.voltage_drive import Controller, Course, VoltageDrive
from ssmr_ident.signals.grid import band_limited, line_corners
from ssmr_ident.simulate.kicks import kicks, seen_by
from ssmr_ident.simulate.rig_kernel import run
from ssmr_ident.simulate.sensed import sensed

RIDER_SHARE, RIDER_HZ, RIDER_RATIO = unlisted.RIDER_SHARE, unlisted.RIDER_HZ, unlisted.RIDER_RATIO

PART = 20_000
"""Steps that are run at once, for their slopes, which nobody asks for here, take memory."""

TINIEST = 1e-12
"""Least size of a motion [m] and of its speed [m/s], of a rig that nothing seems to move."""


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
    motor: VoltageDrive | None = None,
    course: Course | None = None,
) -> np.ndarray:
    """Motion of the rig under a sampled force, or driven by a motor.

    The mass, spring and damper are propagated exactly over a step with the force in a straight line across it, whose
    corners make up for what lines take from a smooth force; it is first made ``oversampling`` times finer within its
    band, because lines between the samples of a force near half the sampling rate are not what acted. Effects kick the
    mass before and after each step (Strang splitting, with what kicks leave of a smooth force: fourth order for one of
    the deflection alone, second order for others), and are passed over when there are none.

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
    motor : VoltageDrive, optional
        Whose armature turns with the rig.
    course : Course, optional
        What the motor is given, beside the force; straight between its samples.

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
    if active.get("nonlinear_stiffness", {}).get("sine_share") and not rig.rotary:
        where = "effects: nonlinear_stiffness.sine_share"
        raise InputError(where, "is of a rig that turns", "Give the rig inertia_kg_m2 in place of its mass")
    order, slow = 2.0, active.get("sensor_bandwidth", {"bandwidth_hz": math.inf})
    if slow["bandwidth_hz"] < bandwidth_hz:
        bandwidth_hz, order = slow["bandwidth_hz"], slow["order"]
    if math.isfinite(bandwidth_hz) and not fine:  # the bilinear low-pass is true to 0.1 % in phase from here on
        oversampling = max(oversampling, math.ceil(8.0 * bandwidth_hz / sample_rate))
    if motor is not None:
        rig = replace(rig, mass=rig.mass + motor.inertia)
    driving = force if fine or oversampling == 1 else band_limited(force, oversampling)
    step = 1.0 / (sample_rate * oversampling)
    given = _given(motor, course, len(driving))
    motion = _motion(rig, effect_vector(active), driving, given, (position, velocity), step)
    out = motion[::oversampling].copy()
    if math.isfinite(bandwidth_hz):
        out[:, 2] = _low_passed(motion[:, 2], low_pass_coefficients(bandwidth_hz, step, order))[::oversampling]
    if not np.isfinite(out[-1]).all():
        row = int(np.flatnonzero(~np.isfinite(out).all(axis=1))[0])
        raise SimulationError(
            f"the rig left the finite numbers at t = {row / sample_rate:.4g} s with effects {active or 'none'}; "
            f"mass {rig.mass:g}, damping {rig.damping:g}, stiffness {rig.stiffness:g}"
        )
    names = ("angle", "angular_rate") if rig.rotary else ("position", "velocity")
    logged = dict(zip((*names, "acceleration"), out.T, strict=True))
    return np.column_stack(list(sensed(np.arange(n) / sample_rate, logged, active).values()))


@dataclass(frozen=True, eq=False)
class _Given:
    """What a motor is given on the fine grid, and whether it is connected; as the loop takes it, but for a size."""

    signal: np.ndarray
    on: np.ndarray
    gain: float
    limit: float
    motor: VoltageDrive | None

    def stalled(self) -> np.ndarray:
        """Its torque [N m] at rest at the origin."""
        assert self.motor is not None
        held = np.clip(self.gain * self.signal, -self.limit, self.limit) if self.gain else self.signal
        return self.on * self.motor.gain * held


def _given(motor: VoltageDrive | None, course: Course | None, count: int) -> _Given:
    if motor is None or course is None:
        return _Given(np.zeros(1), np.zeros(1), 0.0, math.inf, None)
    at = np.linspace(0.0, len(course.signal) - 1.0, count)
    signal, on = (np.interp(at, np.arange(len(x)), x) for x in (course.signal, course.on))
    held = course.controller or Controller(0.0)
    return _Given(signal, on, held.gain, held.limit, motor)


def _motion(
    rig: Rig, e: np.ndarray, force: np.ndarray, given: _Given, begun: tuple[float, float], step: float
) -> np.ndarray:
    """Position, velocity, acceleration on the fine grid, (n, 3) float."""
    plain, driving, motor = rig, force, given.motor
    if motor is not None:
        plain, driving = replace(rig, damping=rig.damping + motor.braking), force + given.stalled()
    usual = _looped(plain, effect_vector({}), driving, _given(None, None, 0), begun, step)
    if motor is None and np.array_equal(e, effect_vector({})):
        return usual
    size, speed, _ = np.abs(np.where(np.isfinite(usual), usual, 0.0)).max(axis=0)
    return _looped(rig, e, force, given, begun, step, max(float(size), TINIEST), max(float(speed), TINIEST))


def _looped(
    rig: Rig, e: np.ndarray, force: np.ndarray, given: _Given, begun: tuple[float, float], step: float,
    size: float = 1.0, speed: float = 1.0,
) -> np.ndarray:  # fmt: skip
    """The same by the loop, part by part; ``size`` [m] and ``speed`` [m/s] of the motion are what it is exact to."""
    motor, beside = given.motor, not np.array_equal(e, effect_vector({}))
    lin, rows = _linear(rig, e[UNLISTED:], step)
    values = np.array([rig.mass, rig.damping, rig.stiffness, *((motor.constant, motor.resistance) if motor else ())])
    n_lin, n_par = len(lin[0]), len(values)
    d_lin, d_rows = (tuple(np.zeros((n_par, *x.shape)) for x in part) for part in (lin, rows))
    drives = (motor is not None, given.gain, given.limit, motor.ratio if motor else 1.0, rig.mass * speed / step)
    none, uses = np.zeros((2, 0)), np.ones(8, dtype=bool)
    uses[7] = e[LOAD_FRICTION] != 0.0 or e[LOAD_SHARE] != 0.0
    g = (
        1.0, (1.0, 1.0, 1.0), none, none, np.zeros((2, 2, 0)), np.zeros((1, 0)), np.zeros(0, dtype=np.int64),
        np.zeros(0), np.stack([values, np.zeros(n_par)]), np.zeros(0), beside, e, np.zeros(0, dtype=np.int64),
        np.zeros(0), size, speed, uses, drives,
    )  # fmt: skip
    count, states = len(force), n_lin + STATES
    columns = states + n_par + 1
    out, lines, slopes = np.empty((count, 3)), line_corners(force), np.zeros((1, count))
    state = np.zeros((1, states))
    state[0, :2] = begun
    for first in range(0, count, PART):
        length = min(PART, count - first)
        places = np.array([[0, length, length - 1, first, count - 1]])
        y, dy, ends = np.empty((length, 3)), np.empty((length, 3, columns)), np.empty((1, states))
        run(lin, d_lin, rows, d_rows, g, beside or motor is not None, state, places, np.array([first * step]), force,
            lines, slopes, (given.signal, given.on), 1, step, y, dy, ends, np.empty((1, states, columns)),
            np.empty((length, 3)))  # fmt: skip
        out[first : first + length], state = y, ends
    return out


def _linear(rig: Rig, free: np.ndarray, step: float) -> tuple[tuple[np.ndarray, ...], tuple[np.ndarray, ...]]:
    """Exact step of (x, v) under a force that runs straight from f0 to f1, and position, velocity and acceleration of
    them: (state matrix, the two weights, kick, aside), (over states, over the force, over one beside, over its rise).

    Of (x, v, y, w) where a part of the mass rides along, which is y further than x, with the relative speed w.
    """
    share, turning = free[RIDER_SHARE], 2.0 * math.pi * free[RIDER_HZ]
    n = 4 if share else 2
    a = np.zeros((n + 2, n + 2))
    body = rig.mass * (1.0 - share)
    a[0, 1] = 1.0
    a[1, :2] = [-rig.stiffness / body, -rig.damping / body]
    a[1, n] = 1.0 / body
    if share:
        pull = np.array([turning**2, 2.0 * free[RIDER_RATIO] * turning])  # on the rider, for each of its kilograms
        a[2, 3] = 1.0
        a[1, 2:4] = pull * share / (1.0 - share)
        a[3] = -a[1]
        a[3, 2:4] -= pull
    a[n, n + 1] = 1.0 / step
    e = expm(a * step)
    now, later = e[:n, n] - e[:n, n + 1], e[:n, n + 1]
    kick, aside = kicks(a[:n, :n], np.array([0.0, 1.0 / body, 0.0, -1.0 / body])[:n], step)
    over, felt = np.vstack([np.eye(n)[:2], a[1, :n]]), np.array([0.0, 0.0, 1.0 / body])
    rows = (over, felt, *seen_by(over, -felt, kick, aside))
    return tuple(np.ascontiguousarray(x) for x in (e[:n, :n], now, later, kick, aside)), rows


@kernel
def _low_passed(signal, coefficients):
    """What a second-order low-pass, at rest at its first value, makes of a signal."""
    history, out = np.full((1, 4), signal[0]), np.empty(len(signal))
    for n in range(len(signal)):
        out[n] = filter_step(history, 0, signal[n], coefficients)
    return out
