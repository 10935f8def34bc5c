"""A rig with one degree of freedom, driven by a measured force or let go."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
from scipy.linalg import expm

from ssmr_ident.core.errors import InputError, SimulationError
from ssmr_ident.core.kernel import kernel
from ssmr_ident.physics.effects import CATALOGUE, load_dependent_friction, unlisted
from ssmr_ident.physics.element import STATES, element_advance, element_force, spring_force
from ssmr_ident.physics.rig import Rig
from ssmr_ident.physics.sensor import filter_step, low_pass_coefficients
from ssmr_ident.physics.slots import (
    LOAD_FRICTION,
    LOAD_ROUNDING,
    LOAD_SHARE,
    UNLISTED,
    Effects,
    checked,
    effect_vector,
)
from ssmr_ident.physics.voltage_drive import Controller, Course, VoltageDrive, torque, voltage
from ssmr_ident.signals.grid import band_limited, line_corners
from ssmr_ident.simulate.sensed import sensed

_unlisted = unlisted.force
_gears, _slowed = load_dependent_friction.force, load_dependent_friction.slowed
RIDER_SHARE, RIDER_HZ, RIDER_RATIO = unlisted.RIDER_SHARE, unlisted.RIDER_HZ, unlisted.RIDER_RATIO


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
    mass before and after each step (Strang splitting, second order), and are passed over when there are none.

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
    if "sensor_bandwidth" in active:
        bandwidth_hz = min(bandwidth_hz, active["sensor_bandwidth"]["bandwidth_hz"])
    if math.isfinite(bandwidth_hz) and not fine:  # the bilinear low-pass is true to 0.1 % in phase from here on
        oversampling = max(oversampling, math.ceil(8.0 * bandwidth_hz / sample_rate))
    if motor is not None:
        rig = replace(rig, mass=rig.mass + motor.inertia)
    driving = force if fine or oversampling == 1 else band_limited(force, oversampling)
    step = 1.0 / (sample_rate * oversampling)
    out = np.empty((n, 3))
    e = effect_vector(active)
    given = _given(motor, course, len(driving))
    beside = given[0] or not np.array_equal(e, effect_vector({}))
    laws = (rig.mass, rig.damping, rig.stiffness, e, beside, low_pass_coefficients(bandwidth_hz, step), given)
    _run(
        *_propagators(rig, e[UNLISTED:], step),
        *laws,
        driving,
        line_corners(driving),
        position,
        velocity,
        step,
        oversampling,
        out,
    )
    if not np.isfinite(out[-1]).all():
        row = int(np.flatnonzero(~np.isfinite(out).all(axis=1))[0])
        raise SimulationError(
            f"the rig left the finite numbers at t = {row / sample_rate:.4g} s with effects {active or 'none'}; "
            f"mass {rig.mass:g}, damping {rig.damping:g}, stiffness {rig.stiffness:g}"
        )
    names = ("angle", "angular_rate") if rig.rotary else ("position", "velocity")
    logged = dict(zip((*names, "acceleration"), out.T, strict=True))
    return np.column_stack(list(sensed(np.arange(n) / sample_rate, logged, active).values()))


def _given(
    motor: VoltageDrive | None, course: Course | None, count: int
) -> tuple[bool, np.ndarray, np.ndarray, float, float, float, float]:
    """Whether a motor is given anything; on the fine grid what that is and whether it is connected; controller's gain
    and limit; the motor's gain and braking."""
    if motor is None or course is None:
        return False, np.zeros(1), np.zeros(1), 0.0, math.inf, 0.0, 0.0
    at = np.linspace(0.0, len(course.signal) - 1.0, count)
    signal, on = (np.interp(at, np.arange(len(x)), x) for x in (course.signal, course.on))
    held = course.controller or Controller(0.0)
    return True, signal, on, held.gain, held.limit, motor.gain, motor.braking


def _propagators(rig: Rig, free: np.ndarray, step: float) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Exact step of (x, v) under a force that runs straight from f0 to f1: state matrix and the two weights.

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
    return e[:n, :n].copy(), e[:n, n] - e[:n, n + 1], e[:n, n + 1].copy()


@kernel
def _extra(x, v, hidden, time, half, here, n, stiffness, e, given):
    """Force beside spring, damper and what drives from outside [N] once it has kicked the velocity ``v`` for ``half``
    [s/kg]; ``here`` : force from outside [N]."""
    driven, signal, on, gain, limit, motor_gain, braking = given
    loads = e[LOAD_FRICTION] != 0.0 or e[LOAD_SHARE] != 0.0
    extra, kicked = 0.0, v
    # the kick takes the velocity after it, so that damping keeps the second order
    for _ in range(3 if half > 0.0 else 1):
        extra = element_force(x, kicked, hidden, stiffness, 1.0, 1.0, True, e)
        extra += _unlisted(x, kicked, time, 1.0, e[UNLISTED:])
        drive = here
        if driven:
            own = torque(voltage(signal[n], x, gain, limit), kicked, on[n], motor_gain, braking)
            extra -= own
            drive += own
        if loads:
            carried = drive + spring_force(x, stiffness, e)
            rubs = e[LOAD_FRICTION], e[LOAD_SHARE], e[LOAD_ROUNDING]
            extra += _gears(_slowed(v - half * extra, half, carried, *rubs), carried, *rubs)
        kicked = v - half * extra
    return extra


@kernel
def _run(
    transition, weight_now, weight_next, mass, damping, stiffness, e, beside, low_pass, given,
    force, lines, position, velocity, step, every, out,
):  # fmt: skip
    x, v, y, w = position, velocity, 0.0, 0.0
    hidden = np.zeros(STATES)
    free = e[UNLISTED:]
    riding = transition.shape[0] == 4
    share = free[RIDER_SHARE] if riding else 0.0
    body, turning = mass * (1.0 - share), 2.0 * math.pi * free[RIDER_HZ]
    pull_y, pull_w = mass * share * turning * turning, 2.0 * mass * share * free[RIDER_RATIO] * turning
    extra = _extra(x, v, hidden, 0.0, 0.0, force[0], 0, stiffness, e, given) if beside else 0.0
    first = (force[0] - damping * v - stiffness * x - extra) / body
    history = np.full((1, 4), first)
    steps = (out.shape[0] - 1) * every
    for n in range(steps + 1):
        inertial = force[n] - damping * v - stiffness * x - extra
        if riding:
            inertial += pull_y * y + pull_w * w
        acceleration = filter_step(history, 0, inertial / body, low_pass)
        if n % every == 0:
            row = out[n // every]
            row[0], row[1], row[2] = x, v, acceleration
        if n < steps:
            if beside:
                kick = 0.5 * step / body * extra
                v, w = v - kick, w + kick
            now, later, start = lines[n], lines[n + 1], x
            was = x, v, y, w
            x = transition[0, 0] * was[0] + transition[0, 1] * was[1] + weight_now[0] * now + weight_next[0] * later
            v = transition[1, 0] * was[0] + transition[1, 1] * was[1] + weight_now[1] * now + weight_next[1] * later
            if riding:
                x += transition[0, 2] * y + transition[0, 3] * w
                v += transition[1, 2] * y + transition[1, 3] * w
                y, w = 0.0, 0.0
                for k in range(4):
                    y += transition[2, k] * was[k]
                    w += transition[3, k] * was[k]
                y += weight_now[2] * now + weight_next[2] * later
                w += weight_now[3] * now + weight_next[3] * later
            if beside:
                element_advance(hidden, (x - start) / step, step, True, e)
                half = 0.5 * step / body
                extra = _extra(x, v, hidden, (n + 1) * step, half, force[n + 1], n + 1, stiffness, e, given)
                v, w = v - half * extra, w + half * extra
