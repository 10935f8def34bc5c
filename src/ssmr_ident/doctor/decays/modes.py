"""A linear model's modes, and what each coordinate changes in them."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from ssmr_ident.identify.body.builder import RobotBuilder
from ssmr_ident.identify.fitting.coordinates import Model
from ssmr_ident.physics.extended import (
    BANDWIDTH,
    COUNT,
    MASS,
    PLACES,
    POINTS,
    SLOW,
    STIFFNESS,
    added,
    numbers,
    small_motion,
    tilted,
)
from ssmr_ident.physics.sensor import low_pass_coefficients
from ssmr_ident.physics.slots import Effects

Array = np.ndarray

POSED = [MASS, *range(POINTS, STIFFNESS), STIFFNESS + 2]
"""Numbers that the pose at rest depends on."""

STEP = 1e-5
"""Of differences of the small matrices, in scaled coordinates."""

GROWTH, FASTEST = 20.0, 3.0
"""Exponent over the longest recording from which a robot counts as falling over, and size of a pole times the log's
step from which it is no motion that a log could show."""

SENSOR_STATES = 6
"""Of the transients of three slow axes."""

APART = 1e-9
"""Least difference of two poles [1/s]: those of alike sensors are the same, and have nothing to do with each other."""


@dataclass(frozen=True, eq=False)
class Modes:
    """A small motion taken apart, y = Σ read_k e^(s_k t) (into · x)_k.

    Parameters
    ----------
    poles : (n,) complex [1/s]
    right, left : (n, n) complex
        Eigenvectors and their inverse.
    read : (3, n) complex
        What axes read of each.
    into : (n, k) complex
        Over what is free at the release.
    matrices : tuple of (n, n), (3, n), (n, k) float
        A, C and the start.
    bandwidth_hz : float
    sways, relaxes, slow : bool
        Whether a mast, relaxing branches and transients of slow sensors are there.
    """

    poles: Array
    right: Array
    left: Array
    read: Array
    into: Array
    matrices: tuple[Array, Array, Array]
    bandwidth_hz: float
    sways: bool
    relaxes: bool
    slow: bool

    @property
    def keep(self) -> Array:
        """Of conjugate pairs one."""
        return np.flatnonzero(self.poles.imag >= 0)

    @property
    def kept(self) -> Array:
        return self.poles[self.keep]

    @property
    def weight(self) -> Array:
        return np.where(self.kept.imag > 0, 2.0, 1.0)

    @property
    def of_sensor(self) -> Array:
        """Which of the kept poles are a slow sensor's own, that it does not filter."""
        return self.keep >= len(self.poles) - (SENSOR_STATES if self.slow else 0)


@dataclass(frozen=True, eq=False)
class Slopes:
    """By each coordinate.

    Parameters
    ----------
    poles : (p, n) complex
    between : (p, n, n) complex
        What modes pass on to each other, over the difference of their poles.
    back : (p, 3, n) complex
        The same as axes read it.
    read : (p, 3, n) complex
    start : (p, n, k) complex
    by_band : (p,) float [Hz]
        Of the accelerometer's bandwidth.
    """

    poles: Array
    between: Array
    back: Array
    read: Array
    start: Array
    by_band: Array


def modes_at(builder: RobotBuilder, model: Model, point: Array, log_step: float) -> Modes | None:
    """Modes at a point; None where no robot carries its mast, or a motion is faster than any log."""
    row, effects = _row(builder, model, point)
    there = added(effects)
    slow = SLOW in effects and bool(low_pass_coefficients(row[BANDWIDTH], log_step)[0] != 1.0)
    *matrices, carried = small_motion(row, *tilted(row), *there)
    a, c, t = _extended(tuple(matrices), row[BANDWIDTH], slow, log_step)
    if not carried or not np.all(np.isfinite(a)):
        return None
    poles, right = np.linalg.eig(a)
    if np.abs(poles).max() * log_step > FASTEST:
        return None
    left = np.linalg.inv(right)
    sways, _, relaxes = there
    return Modes(
        poles, right, left, c @ right, left @ t, (a, c, t), float(row[BANDWIDTH]), sways, relaxes, slow
    )  # fmt: skip


def slopes_of(modes: Modes, builder: RobotBuilder, model: Model, point: Array, log_step: float) -> Slopes:
    """First-order perturbation by every coordinate."""
    row, effects = _row(builder, model, point)
    there, posed = added(effects), tilted(row)
    moves = _directions(model, point, effects, builder.read(model.split(point)[0])[0].accelerometer.bandwidth_hz)
    changes = [np.zeros((len(point), *matrix.shape)) for matrix in modes.matrices]
    for j in np.flatnonzero(moves.any(axis=1)):
        moved = row + STEP * moves[j]
        *matrices, _ = small_motion(moved, *(tilted(moved) if moves[j, POSED].any() else posed), *there)
        parts = _extended(tuple(matrices), moved[BANDWIDTH], modes.slow, log_step)
        for change, now, then in zip(changes, modes.matrices, parts, strict=True):
            change[j] = (then - now) / STEP
    turned = modes.left @ changes[0] @ modes.right
    gap = modes.poles[:, None] - modes.poles[None, :]
    gap[np.abs(gap) < APART] = APART
    between = turned / gap
    count = np.arange(len(modes.poles))
    between[:, count, count] = 0.0
    return Slopes(
        turned[:, count, count], between, modes.read @ between, changes[1] @ modes.right, modes.left @ changes[2],
        moves[:, BANDWIDTH],
    )  # fmt: skip


def waves(poles: Array, first: float, step: float, count: int) -> Array:
    """Real and imaginary parts of e^(st), and the same times t; (count, 4k) float."""
    fine = math.isqrt(count) + 1
    coarse = -(-count // fine)
    inner = np.exp(np.outer(np.arange(fine) * step, poles))
    outer = np.exp(np.outer(first + np.arange(coarse) * (fine * step), poles))
    e = (outer[:, None, :] * inner[None]).reshape(-1, len(poles))[:count]
    time = (first + step * np.arange(count))[:, None]
    return np.hstack([e.real, e.imag, time * e.real, time * e.imag])


def _row(builder: RobotBuilder, model: Model, point: Array) -> tuple[Array, Effects]:
    values, effects = model.split(point)
    robot, by = builder.read(values)
    return numbers(robot, robot.accelerometer.gain * by, effects), effects


def _directions(model: Model, point: Array, effects: Effects, sheet_hz: float) -> Array:
    """What a small step of each coordinate moves in the row, (p, COUNT) float."""
    found = np.zeros((len(point), COUNT))
    slow = SLOW in effects and effects[SLOW]["bandwidth_hz"] < sheet_hz
    for j, (unknown, scaled) in enumerate(zip(model.unknowns, point.tolist(), strict=True)):
        slope, name = unknown.slope(scaled), unknown.name
        if j >= len(model.physics):
            free = model.free[j - len(model.physics)]
            slope = slope if free.value(scaled) == unknown.value(scaled) else 0.0  # held at a bound
        if name == f"{SLOW}.bandwidth_hz":
            name, slope = "accelerometer.bandwidth_hz", slope if slow else 0.0
        elif name == "accelerometer.bandwidth_hz" and slow:
            slope = 0.0
        for place, factor in PLACES.get(name, ()):  # what small motions do not depend on moves nothing
            found[j, place] = factor * slope
    return found


def _extended(parts: tuple[Array, ...], hz: float, slow: bool, step: float) -> tuple[Array, Array, Array]:
    """A, C and the start with the transients of slow sensors beside."""
    own, rows, start = parts
    if not slow:
        return own, rows, start
    n, k = start.shape
    c = low_pass_coefficients(hz, step)
    root = np.log(np.roots([1.0, c[3], c[4]]).astype(complex)) / step
    product, total = (root[0] * root[1]).real, (root[0] + root[1]).real
    block = np.kron(np.eye(3), np.array([[0.0, 1.0], [-product, total]]))
    a, read, free = np.zeros((n + 6, n + 6)), np.zeros((3, n + 6)), np.zeros((n + 6, k + 6))
    a[:n, :n], a[n:, n:] = own, block
    read[:, :n], read[[0, 1, 2], [n, n + 2, n + 4]] = rows, 1.0
    free[:n, :k], free[n:, k:] = start, np.diag([1.0, math.sqrt(abs(product))] * 3)
    return a, read, free
