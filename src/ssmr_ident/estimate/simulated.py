"""A node at a point as the compiled loop takes it, and a piece run through that loop with its slopes."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, field
from functools import cached_property

import numpy as np
from scipy.interpolate import CubicSpline

from ssmr_ident.estimate.instrument import OUTPUT, passed_on
from ssmr_ident.estimate.motion_kernel import run
from ssmr_ident.estimate.motor import drive_of
from ssmr_ident.estimate.node import MEMORY, Node, Tables, law_places, law_vector, merged, stepped_with_slopes
from ssmr_ident.estimate.pieces import Piece
from ssmr_ident.estimate.values import Problem

Array = np.ndarray

REMEMBER = ("dry_friction", "hysteresis", "viscoelastic_relaxation")
"""Laws by the hidden state of an element that they use."""

GEARS = "load_dependent_friction"
"""The law that looks at what drives."""

SEES = {
    "v": (True, False, False),
    "x": (False, True, True),
    "dry_friction": (False, False, False),
    "hysteresis": (False, True, True),
}
"""Whether a law looks at speed, deflection, the rig's stiffness: by the one variable that it is a function of, or by
its id, where it has a state of its own; others may look at all."""


@dataclass(frozen=True, eq=False)
class Simulated:
    y: Array
    dy: Array
    ends: Array
    dends: Array


@dataclass(frozen=True, eq=False)
class Compiled:
    """A node at a point, as the kernel takes it."""

    node: Node
    values: Array
    slopes: Array
    tables: Tables
    law: Array
    places: Array
    scales: Array
    pieces: tuple[Piece, ...]
    problem: Problem
    steps: dict[tuple, tuple] = field(default_factory=dict)

    @cached_property
    def uses(self) -> Array:
        """(8,) bool: what the laws look at (speed, deflection, stiffness, three hidden states), whether any has terms
        that no list holds, and whether gears carry what drives."""
        laws = [m for m in self.node.members if m.law is not None]
        sees = np.array(
            [SEES.get(m.id if m.kind == MEMORY else m.variable, (True, True, True)) for m in laws], dtype=bool
        ).reshape(-1, 3)
        remembers = [any(m.id == name and m.kind == MEMORY for m in laws) for name in REMEMBER]
        further = [any(m.id == name for m in laws) for name in ("unlisted", GEARS)]
        return np.concatenate([sees.any(axis=0), remembers, further])

    @cached_property
    def turned(self) -> tuple[Array, Array, Array] | None:
        """Linear states with the stretch of the spring at which forces act, and its rate, at the front, (n, n) float;
        back again; and the order of coordinates with its damping and stiffness behind the first one.

        The loop knows forces at its first state alone. None where it is that already, or nothing acts beside.
        """
        count, springs = len(self.node.layout.bodies), len(self.node.layout.springs)
        if not self.node.beside or count == springs == 1:
            return None
        stretch = self.node.layout.stretch[self.node.site]
        pivot = int(np.flatnonzero(stretch)[0])
        into = np.eye(self.node.linear_states)
        others = [b for b in range(count) if b != pivot]
        into[: 2 * count, : 2 * count] = 0.0
        into[0, :count], into[1, count : 2 * count] = stretch, stretch
        for row, (order, body) in enumerate(((o, b) for o in (0, 1) for b in others), start=2):
            into[row, body + count * order] = 1.0
        damping = count + 2 * self.node.site
        first = [0, damping, damping + 1]
        places = np.array(first + [k for k in range(self.node.linear_count) if k not in first])
        return into, np.linalg.inv(into), places

    @classmethod
    def of(cls, problem: Problem, node: Node, point: Array, pieces: Sequence[Piece]) -> Compiled:
        places, scales = law_places(node)
        return cls(
            node, node.values(point), node.slopes(point), merged(node), law_vector(node, point), places,
            scales, tuple(pieces), problem,
        )  # fmt: skip

    def stepping(self, piece: Piece) -> tuple:
        key = (piece.step, piece.seen)
        if key not in self.steps:
            n = self.node.linear_count
            found = stepped_with_slopes(self.node, self.values[:n], self.slopes[:n], piece.seen, piece.step)
            self.steps[key] = found if self.turned is None else _turned(found, *self.turned)
        return self.steps[key]

    def courses(self, piece: Piece) -> Array:
        return np.ascontiguousarray(self.tables.courses(piece))

    def delay(self) -> tuple[float, int] | None:
        for member in self.node.members:
            if member.after == "delay":
                at = [id(c) for c in self.node.coordinates].index(id(member.coordinates[0]))
                return float(self.values[at]), at
        return None


def _turned(stepping: tuple, into: Array, back: Array, order: Array) -> tuple:
    """Exact steps and channels over states that are put together otherwise, slopes in another order."""

    def step(transition: Array, *added: Array) -> tuple[Array, ...]:
        whole = np.ascontiguousarray(into @ transition @ back)
        return whole, *(np.ascontiguousarray(column @ into.T) for column in added)

    def rows(over: Array, *others: Array) -> tuple[Array, ...]:
        return np.ascontiguousarray(over @ back), *others

    lin, d_lin, seen, d_seen = stepping
    return step(*lin), step(*(d[order] for d in d_lin)), rows(*seen), rows(*(d[order] for d in d_seen))


def simulate(model: Compiled, index: int, starts: Array, borders: Array, zero: float) -> Simulated:
    """A piece in stretches, with slopes over (states, coordinates, zero of the drive)."""
    node, piece, problem = model.node, model.pieces[index], model.problem
    lin, d_lin, rows, d_rows = model.stepping(piece)
    n_lin = node.linear_count
    n_tab, n_law = node.count("tables"), node.count("law")
    tables = model.tables
    generic = model.values[n_lin : n_lin + n_tab]
    turned, moved = model.turned, node.linear_states
    order = np.arange(n_lin) if turned is None else turned[2]
    g = (
        tables.reach, (tables.low, tables.top, 0.0 if piece.based else 1.0), tables.by_position, tables.by_velocity,
        tables.by_both, model.courses(piece), tables.kinds, np.ascontiguousarray(generic),
        np.stack([model.values[:n_lin][order], model.slopes[:n_lin][order]]), tables.yields,
        n_law > 0 or _has_law(node), model.law, model.places, model.scales, problem.size, problem.speed,
        model.uses, _motor(model, piece),
    )  # fmt: skip
    drive, drives = piece.drive, np.ones((1, len(piece.drive)))
    delay = model.delay()
    if delay is not None:
        late, _ = delay
        grid = np.arange(len(drive))
        between = CubicSpline(grid, piece.drive)  # straight lines would round a drive's corners off
        at = np.clip(grid - late / piece.step, 0.0, grid[-1])
        drive = between(at)
        drives = np.stack([drives[0], -between(at, 1) / piece.step])
    given = np.zeros(1), np.zeros(1)
    if piece.motor is None:
        drive = drive + zero
    else:
        drives[0], given = 0.0, (piece.motor.signal + zero, piece.motor.on)
    states = starts.shape[1]
    columns = states + n_lin + n_tab + n_law + len(drives)
    y, dy = np.empty(piece.y.shape), np.empty((*piece.y.shape, columns))
    ends, dends = np.empty(starts.shape), np.empty((*starts.shape, columns))
    begin = float(piece.time[0])
    begun = starts if turned is None else np.hstack([starts[:, :moved] @ turned[0].T, starts[:, moved:]])
    beside = node.beside or piece.motor is not None
    run(lin, d_lin, rows, d_rows, g, beside, begun, borders, drive, drives, given, piece.every, piece.step, begin,
        y, dy, ends, dends)  # fmt: skip
    if turned is not None:
        into, back, _ = turned
        ends[:, :moved] = ends[:, :moved] @ back.T
        dends[:, :moved] = np.einsum("ij,sjc->sic", back, dends[:, :moved])
        for slopes in (dy, dends):
            slopes[..., :moved] = slopes[..., :moved] @ into
            slopes[..., states + order] = slopes[..., states : states + n_lin].copy()
    return _arranged(model, index, Simulated(y, dy, ends, dends), states, n_lin, n_tab + n_law, delay)


def _motor(model: Compiled, piece: Piece) -> tuple[bool, float, float, float, float]:
    """Whether there is a motor, gain and limit of its controller, its gear ratio, and the size of what drives."""
    problem = model.problem
    size = float(model.values[0]) * (2.0 * math.pi * problem.frequency) ** 2 * problem.size
    motor = drive_of(model.values[: len(model.node.baseline)]) if piece.motor is not None else None
    if motor is None or piece.motor is None:
        return False, 0.0, math.inf, 1.0, size
    return True, piece.motor.gain, piece.motor.limit, motor.ratio, size


def _has_law(node: Node) -> bool:
    return any(m.law is not None for m in node.members)


def _arranged(model: Compiled, index: int, s: Simulated, states: int, n_lin: int, rest: int, delay) -> Simulated:
    """Columns in the order (states, coordinates, zero), what is done to channels afterwards among them."""
    node, count = model.node, len(model.values)
    first = states + n_lin

    def order(d: Array) -> Array:
        if d.shape[-1] == states + count + 1 and delay is None:  # nothing is done afterwards
            d[..., first : first + rest] *= model.slopes[n_lin : n_lin + rest]
            return d
        out = np.zeros((*d.shape[:-1], states + count + 1))
        out[..., : first + rest] = d[..., : first + rest]
        out[..., first : first + rest] *= model.slopes[n_lin : n_lin + rest]
        out[..., -1] = d[..., first + rest]
        if delay is not None:
            out[..., states + delay[1]] = d[..., first + rest + 1] * model.slopes[delay[1]]
        return out

    y, dy = s.y, order(s.dy)
    for member in (m for m in node.members if m.after == "clip"):
        at = [id(c) for c in node.coordinates].index(id(member.coordinates[0]))
        limit = model.values[at]
        for c in (c for c, name in enumerate(model.pieces[index].channels) if name == member.channel):
            beyond = np.abs(y[:, c]) > limit
            dy[beyond, c] = 0.0
            dy[beyond, c, states + at] = np.sign(y[beyond, c]) * model.slopes[at]
            y[:, c] = np.clip(y[:, c], -limit, limit)
    for member in (m for m in node.members if m.after == OUTPUT):
        places = [[id(c) for c in node.coordinates].index(id(own)) for own in member.coordinates]
        names = [c.name for c in member.coordinates]
        given = {name: float(model.values[k]) for name, k in zip(names, places, strict=True)}
        own = {name: (states + k, float(model.slopes[k])) for name, k in zip(names, places, strict=True)}
        y, dy = passed_on(member, model.pieces[index], y, dy, given, own)
    return Simulated(y, dy, s.ends, order(s.dends))
