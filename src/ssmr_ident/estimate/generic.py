"""Generic members: for each kind of physics one that can take any shape, linear in its coefficients."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import replace

import numpy as np
from scipy.interpolate import BSpline
from scipy.linalg import eigh

from ssmr_ident.estimate.coordinate import Coordinate
from ssmr_ident.estimate.node import BRANCH, LAG, LAG_1, MEMORY, RIDER, Member, Tables
from ssmr_ident.estimate.pieces import Piece
from ssmr_ident.estimate.values import Problem
from ssmr_ident.physics.network import ONE
from ssmr_ident.simulate.rig_kernel import BY_INERTIA, BY_POSITION, BY_VELOCITY

Array = np.ndarray

STATIC, EXTRA, CHANGING, SENSOR = "static_force", "extra_motion", "changing", "sensor_chain"
ANY, SMOOTH, BY_RECORDING = "any shape", "any smooth shape", "by recording"

CELLS = 400
"""Of a table: straight lines between."""

KNOTS, SHAPES = 15, 10
"""Of the spline over deflection, and how many of its smoothest shapes are taken."""

DENSER = 0.5
"""Share of the knots that stand where a decay is for most of the time, which is near rest; the others evenly."""

STEEP = (0.01, 0.05, 0.25)
"""Widths of steps in velocity, in the largest: the narrowest is as sharp as a law without memory can be seen."""

SIDE = 0.1
"""Width of a step in deflection, in the largest."""

YIELDS = (0.01, 0.04, 0.12, 0.25, 0.5, 0.9)
"""Deflections at which spring-slider elements slide, in the largest."""

RANGES = {"m/s^2": "range_m_s2", "m": "range_m", "m/s": "range_m_s", "rad": "range_rad", "rad/s": "range_rad_s"}
"""Parameters of ``sensor_saturation`` by the unit of what is read."""

LOOSE = 3.0
"""Prior standard deviation of a coefficient, in the forces that the linear rig shows."""


def static(problem: Problem, paths: Sequence[Array], variable: str = "", smooth: bool = False) -> Member:
    """f(x) + g(v) + h(x) v + s(x) r(v), x and v that the linear rig has left out; s and r are steep.

    Parameters
    ----------
    problem : Problem
    paths : sequence of (n, 3) float
        Position, velocity, acceleration per piece; they say where the tables are.
    variable : str
        ``x`` for f alone, ``v`` for g.
    smooth : bool
        Without a step where the motion turns: g is of powers alone, and s r is left out.
    """
    x, v = np.concatenate([p[:, 0] for p in paths]), np.concatenate([p[:, 1] for p in paths])
    reach, fastest = 1.1 * float(np.abs(x).max()), float(np.abs(v).max())
    low = 0.5 * STEEP[0] * fastest
    top = float(np.arcsinh(1.1 * fastest / low))
    grid = np.linspace(-1.0, 1.0, CELLS + 1)
    driven = any(p.driven for p in problem.pieces)
    by_x = _smooth_shapes(grid, x / reach, 0.0 if driven else DENSER)
    u = low * np.sinh(top * grid) / fastest
    steps = [] if smooth else [np.tanh(u / width) for width in STEEP]
    by_v = np.column_stack([*steps, u * np.abs(u), u**3, np.abs(u), u**2])
    by_v = _without(by_v, np.column_stack([u]), np.interp(np.arcsinh(v / low) / top, grid, np.arange(CELLS + 1.0)))
    side, sharp = np.tanh(grid / SIDE), np.tanh(u / STEEP[0])
    both = np.array([
        np.column_stack([grid, np.abs(grid), grid**2, side, side, grid, np.abs(grid)]),
        np.column_stack([u, u, u, u, sharp, sharp, sharp]),
    ])  # fmt: skip
    both = both[..., :4] if smooth else both
    parts = {"x": Tables(by_position=by_x), "v": Tables(by_velocity=by_v), "": Tables(by_x, by_v, both)}
    tables = replace(parts[variable], reach=reach, low=low, top=top)
    member = _member("unlisted", STATIC, tables, problem)
    member = replace(member, form=SMOOTH) if smooth else member
    return replace(member, form=f"{ANY} over {variable}", variable=variable) if variable else member


def memory(problem: Problem, paths: Sequence[Array]) -> Member:
    """Spring-slider (Jenkins) elements in parallel (Iwan 1966)."""
    reach = max(float(np.abs(p[:, 0]).max()) for p in paths)
    yields = reach * np.array(YIELDS)
    coordinates = tuple(
        Coordinate(f"slider_{k}", _force(problem) / y, mean=0.0, std=LOOSE) for k, y in enumerate(yields.tolist())
    )
    return Member("unlisted", MEMORY, ANY, coordinates, Tables(yields=yields))


def changing(problem: Problem) -> Member:
    """Stiffness, damping and inertia as slow functions of the time since a recording began."""
    longest = max(p.time[-1] - p.begin for p in problem.pieces)
    driven = problem.layout == ONE and any(p.driven and not p.based for p in problem.pieces)
    kinds = [BY_POSITION] * 3 + [BY_VELOCITY] * 2 + [BY_INERTIA] * (2 if driven else 0)

    def courses(piece: Piece) -> Array:
        t = (piece.time - piece.begin) / longest
        shapes = np.column_stack([t, t**2, t**3])
        return np.hstack([shapes, shapes[:, :2], shapes[:, : len(kinds) - 5]])

    return _courses(problem, courses, kinds, "over time")


def by_recording(problem: Problem) -> Member | None:
    """Another stiffness and damping in every recording."""
    count = max(p.recording for p in problem.pieces) + 1
    if count < 2:
        return None

    def courses(piece: Piece) -> Array:
        own = np.zeros((len(piece.y), count))
        own[:, piece.recording] = 1.0
        own -= 1.0 / count
        return np.hstack([own[:, 1:], own[:, 1:]])

    return _courses(problem, courses, [BY_POSITION] * (count - 1) + [BY_VELOCITY] * (count - 1), BY_RECORDING)


def _courses(problem: Problem, courses: Callable[[Piece], Array], kinds: Sequence[int], form: str) -> Member:
    stiffness, damping = _force(problem) / problem.size, _force(problem) / problem.speed
    size = {BY_POSITION: stiffness, BY_VELOCITY: damping, BY_INERTIA: 1.0}
    coordinates = tuple(Coordinate(f"course_{k}", 0.1 * size[kind], std=10.0 * LOOSE) for k, kind in enumerate(kinds))
    tables = Tables(courses=courses, kinds=np.array(kinds, dtype=np.int64))
    return Member("unlisted", CHANGING, f"{ANY}, {form}", coordinates, tables)


def rider(problem: Problem, hz: float) -> Member:
    """A part of the mass on a spring of its own."""
    return Member(
        "unlisted", EXTRA, "a part of the mass rides",
        (
            Coordinate("rider_share", 1.0, False, 1e-5, 0.9, 0.0, 0.5, "1"),
            Coordinate("rider_Hz", hz, True, 0.05 * hz, 20.0 * hz, 0.0, 1.0, "Hz"),
            Coordinate("rider_ratio", 0.02, True, 2e-4, 0.1, 0.0, 1.5, "1"),
        ),
        linear=RIDER,
    )  # fmt: skip


def branch(problem: Problem, seconds: float, form: str = "one branch") -> Member:
    """A Maxwell branch."""
    stiff = _force(problem) / problem.size
    return Member(
        "viscoelastic_relaxation", MEMORY, form,
        (
            Coordinate("K_m_N_m", 0.3 * stiff, False, 0.0, 1e3 * stiff, 0.0, 10.0, "N/m"),
            Coordinate("tau_s", seconds, True, 1e-3 * seconds, 1e3 * seconds, 0.0, 2.0, "s"),
        ),
        linear=BRANCH,
    )  # fmt: skip


def lag(hz: float, known_hz: float = math.inf, order: float = 2.0) -> Member:
    """A slow accelerometer: a Butterworth low-pass of second order or first, in place of the one that is known."""
    bandwidth = Coordinate("bandwidth_hz", hz, True, 0.05 * hz, min(50.0 * hz, 0.999 * known_hz), 0.0, 2.0, "Hz")
    held = {"order": order} if order < 2.0 else {}
    held |= {"known_hz": known_hz} if math.isfinite(known_hz) else {}
    fixed = (Coordinate(name, value, False, value, value, 1.0, 1e-9, "") for name, value in held.items())
    form, linear = ("first order", LAG_1) if order < 2.0 else ("", LAG)
    return Member("sensor_bandwidth", SENSOR, form, (bandwidth, *fixed), linear=linear)


def delay(step: float, longest: float) -> Member:
    """The motion comes later than the force by a constant time; both arguments in seconds."""
    late = Coordinate("delay_s", step, False, -longest, longest, 0.0, 10.0, "s")
    return Member("sensor_delay", SENSOR, "", (late,), after="delay")


def clip(channel: str, limit: float, parameter: str, unit: str) -> Member:
    """A channel's range."""
    at = Coordinate(parameter, limit, True, 0.1 * limit, 3.0 * limit, 0.0, 1.0, unit)
    return Member("sensor_saturation", SENSOR, "", (at,), after="clip", channel=channel)


def _force(problem: Problem) -> float:
    """Force that the linear rig shows [N]."""
    mass = problem.baseline[0].scale
    return float(mass * (2.0 * np.pi * problem.frequency) ** 2 * problem.size)


def _member(effect: str, kind: str, tables: Tables, problem: Problem) -> Member:
    force = _force(problem)
    coordinates = tuple(Coordinate(f"shape_{k}", force, std=LOOSE) for k in range(tables.size))
    return Member(effect, kind, ANY, coordinates, tables)


def _smooth_shapes(grid: Array, where: Array, denser: float) -> Array:
    """Smoothest shapes over the grid that are no straight line where the motion is, each of unit size there.

    Demmler and Reinsch (1975): eigenvectors of a spline's roughness against its size.
    """
    inner = np.linspace(-1.0, 1.0, KNOTS)
    knots = np.concatenate([[-1.0] * 3, inner, [1.0] * 3])
    count = len(knots) - 4
    spline = BSpline(knots, np.eye(count), 3)
    density = np.histogram(where, bins=len(grid) - 1, range=(-1.0, 1.0))[0] / len(where)
    centres = 0.5 * (grid[1:] + grid[:-1])
    even = density + density[::-1]
    share = denser * np.cumsum(even) / even.sum() + (1.0 - denser) * 0.5 * (grid[1:] + 1.0)
    at = 2.0 * np.concatenate([[0.0], share]) - 1.0

    def basis(x: Array) -> Array:
        return np.asarray(spline(np.clip(np.interp(x, grid, at), -1.0, 1.0)))

    density = density + 1e-4
    own = basis(centres)
    straight = np.column_stack([np.ones(len(centres)), centres])
    q = np.linalg.qr(straight * np.sqrt(density)[:, None])[0]
    weighted = own * np.sqrt(density)[:, None]
    weighted -= q @ (q.T @ weighted)
    size = weighted.T @ weighted
    bend = np.diff(np.asarray(spline(grid)), 2, axis=0)
    values, vectors = eigh(bend.T @ bend + 1e-12 * np.eye(count), size + 1e-9 * np.trace(size) * np.eye(count))
    shapes = vectors[:, np.argsort(values)]
    line = np.linalg.lstsq(straight * np.sqrt(density)[:, None], own * np.sqrt(density)[:, None], rcond=None)[0]
    table = basis(grid) @ shapes - np.column_stack([np.ones(len(grid)), grid]) @ (line @ shapes)
    rms = np.sqrt(np.sum(density[:, None] * ((table[1:] + table[:-1]) / 2.0) ** 2, axis=0))
    bent = np.einsum("ki,kl,li->i", shapes, size, shapes) > 0.5  # straight lines have no size
    good = bent & (rms > 1e-3 * rms[bent].max())
    return np.ascontiguousarray((table[:, good] / rms[good])[:, :SHAPES])


def _without(table: Array, lines: Array, places: Array) -> Array:
    """A table less its part along given columns where the motion is, each of unit size there."""
    weight = np.sqrt(np.histogram(places, bins=len(table), range=(-0.5, len(table) - 0.5))[0] / len(places))[:, None]
    table = table - lines @ np.linalg.lstsq(lines * weight, table * weight, rcond=None)[0]
    return np.ascontiguousarray(table / np.maximum(np.linalg.norm(table * weight, axis=0), 1e-12))
