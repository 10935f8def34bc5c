"""A node at a point as the compiled loop takes it, and pieces run through that loop with their slopes."""

from __future__ import annotations

import itertools
import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field
from functools import cached_property

import numpy as np
from scipy.interpolate import CubicSpline

from ssmr_ident.estimate.instrument import OUTPUT, passed_on
from ssmr_ident.estimate.motor import drive_of
from ssmr_ident.estimate.node import MEMORY, Node, Tables, law_places, law_vector, merged, stepped_with_slopes
from ssmr_ident.estimate.pieces import Piece
from ssmr_ident.estimate.values import Problem
from ssmr_ident.signals.grid import line_corners
from ssmr_ident.simulate.rig_kernel import run

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
    unsure: Array


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

    def beside(self, pieces: Sequence[Piece]) -> tuple:
        """Forces beside the linear rig along pieces that step alike, as the loop takes them."""
        n, tables = self.node.linear_count, self.tables
        generic = np.ascontiguousarray(self.values[n : n + self.node.count("tables")])
        order = slice(None) if self.turned is None else self.turned[2]
        courses = [tables.courses(p) for p in pieces] if len(tables.kinds) else [np.zeros((1, 0))]
        return (
            tables.reach, (tables.low, tables.top, 0.0 if pieces[0].based else 1.0), tables.by_position,
            tables.by_velocity, tables.by_both, np.ascontiguousarray(np.vstack(courses)), tables.kinds, generic,
            np.stack([self.values[:n][order], self.slopes[:n][order]]), tables.yields, self.has_law, self.law,
            self.places, self.scales, self.problem.size, self.problem.speed, self.uses, _motor(self, pieces[0]),
        )  # fmt: skip

    @cached_property
    def has_law(self) -> bool:
        return any(m.law is not None for m in self.node.members)

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


BATCH = 20_000
"""Samples of pieces that are run at once: of more, what a call costs is nothing beside the steps."""


def batches(pieces: Sequence[Piece]) -> Iterator[range]:
    """Numbers of neighbours that step and are measured alike, up to ``BATCH`` samples of them."""
    first, samples = 0, 0
    for index, piece in enumerate(pieces):
        alike = _alike(piece) == _alike(pieces[first])
        if index > first and (not alike or samples + len(piece.y) > BATCH):
            yield range(first, index)
            first, samples = index, 0
        samples += len(piece.y)
    yield range(first, len(pieces))


def _alike(piece: Piece) -> tuple:
    motor = None if piece.motor is None else (piece.motor.gain, piece.motor.limit)
    return piece.step, piece.every, piece.seen, piece.driven, piece.channels, motor


def simulate(
    model: Compiled, starts: Sequence[Array], borders: Sequence[Array], zeros: Sequence[float]
) -> Iterator[Simulated]:
    """Every piece in stretches, with slopes over (states, coordinates, zero of the drive).

    Parameters
    ----------
    model : Compiled
    starts : sequence of (s, states) float
        Per piece, at the begin of each stretch.
    borders : sequence of (s + 1,) int
        Samples at which these begin; the last is the number of samples.
    zeros : sequence of float
        Of the drives.
    """
    for batch in batches(model.pieces):
        own = slice(batch.start, batch.stop)
        s = _batch(model, model.pieces[own], starts[own], borders[own], zeros[own])
        row, part = 0, 0
        for k in batch:
            rows, parts = slice(row, row + len(model.pieces[k].y)), slice(part, part + len(starts[k]))
            yield Simulated(s.y[rows], s.dy[rows], s.ends[parts], s.dends[parts], s.unsure[rows])
            row, part = rows.stop, parts.stop


def simulate_whole(model: Compiled, batch: range, begun: Sequence[Array] | Array) -> Simulated:
    """Pieces that step alike from their begins to their ends, one behind the other.

    Parameters
    ----------
    model : Compiled
    batch : range
        Numbers of the pieces.
    begun : sequence of (k,) float
        What a fit has of each piece: states, then the zero of its drive.
    """
    n, pieces = model.node.states, model.pieces[batch.start : batch.stop]
    own = [begun[k] for k in batch]
    borders = [np.array([0, len(p.y)]) for p in pieces]
    zeros = [float(o[n]) if p.driven else 0.0 for p, o in zip(pieces, own, strict=True)]
    return _batch(model, pieces, [o[None, :n] for o in own], borders, zeros)


def motions(model: Compiled, begun: Sequence[Array]) -> list[Array]:
    """Channels of every piece from its begin to its end, (n, c) float, by what a fit has of each."""
    found: list[Array] = []
    for batch in batches(model.pieces):
        y = simulate_whole(model, batch, begun).y
        found += np.split(y, np.cumsum([len(model.pieces[k].y) for k in batch])[:-1])
    return found


def _batch(
    model: Compiled, pieces: Sequence[Piece], starts: Sequence[Array], borders: Sequence[Array], zeros: Sequence[float]
) -> Simulated:
    """Pieces that step alike, in one run."""
    node, piece = model.node, pieces[0]
    lin, d_lin, rows, d_rows = model.stepping(piece)
    n_lin, n_tab, n_law = node.linear_count, node.count("tables"), node.count("law")
    drive, drives, motor, at = _drives(model, pieces, zeros)
    row = np.cumsum([0, *(len(p.y) for p in pieces)])
    both = list(zip(pieces, borders, strict=True))
    places = np.vstack([_places(p, b, row[i], at[i], at[i + 1]) for i, (p, b) in enumerate(both)])
    times = np.concatenate([p.time[0] + b[:-1] * p.every * p.step for p, b in both])
    begun = np.vstack(starts)
    states, moved, turned = begun.shape[1], node.linear_states, model.turned
    columns = states + n_lin + n_tab + n_law + len(drives)
    y, dy = np.empty((row[-1], piece.y.shape[1])), np.empty((row[-1], piece.y.shape[1], columns))
    ends, dends, unsure = np.empty(begun.shape), np.empty((*begun.shape, columns)), np.empty(y.shape)
    if turned is not None:
        begun = np.hstack([begun[:, :moved] @ turned[0].T, begun[:, moved:]])
    beside = node.beside or piece.motor is not None
    lines = np.concatenate([line_corners(drive[a:b]) for a, b in itertools.pairwise(at)])
    run(lin, d_lin, rows, d_rows, model.beside(pieces), beside, begun, places, times, drive, lines, drives, motor,
        piece.every, piece.step, y, dy, ends, dends, unsure)  # fmt: skip
    if turned is not None:
        into, back, order = turned
        ends[:, :moved] = ends[:, :moved] @ back.T
        dends[:, :moved] = np.einsum("ij,sjc->sic", back, dends[:, :moved])
        for slopes in (dy, dends):
            slopes[..., :moved] = slopes[..., :moved] @ into
            slopes[..., states + order] = slopes[..., states : states + n_lin].copy()
    delay = model.delay()
    dy, dends = (_arranged(model, slopes, states, n_lin, n_tab + n_law, delay) for slopes in (dy, dends))
    if any(m.after for m in node.members):
        for own, first, after in zip(pieces, row[:-1], row[1:], strict=True):
            y[first:after], dy[first:after] = _afterwards(model, own, y[first:after], dy[first:after], states)
    return Simulated(y, dy, ends, dends, unsure)


def _motor(model: Compiled, piece: Piece) -> tuple[bool, float, float, float, float]:
    """Whether there is a motor, gain and limit of its controller, its gear ratio, and the size of what drives."""
    problem = model.problem
    size = float(model.values[0]) * (2.0 * math.pi * problem.frequency) ** 2 * problem.size
    motor = drive_of(model.values[: len(model.node.baseline)]) if piece.motor is not None else None
    if motor is None or piece.motor is None:
        return False, 0.0, math.inf, 1.0, size
    return True, piece.motor.gain, piece.motor.limit, motor.ratio, size


def _places(piece: Piece, borders: Array, row: int, at: int, after: int) -> Array:
    """Of each stretch of a piece, as ``run`` takes it."""
    found = np.empty((len(borders) - 1, 5), dtype=np.int64)
    found[:, 0], found[:, 1], found[:, 2] = row + borders[:-1], row + borders[1:], row + len(piece.y) - 1
    found[:, 3], found[:, 4] = np.minimum(at + borders[:-1] * piece.every, after - 1), after - 1
    return found


def _drives(
    model: Compiled, pieces: Sequence[Piece], zeros: Sequence[float]
) -> tuple[Array, Array, tuple[Array, Array], Array]:
    """What drives pieces, one behind the other, its slopes over what may change in it, what a motor is given and
    whether it is connected, and where each one begins."""
    found, slopes, delay = [p.drive for p in pieces], [], model.delay()
    if delay is not None:
        for i, piece in enumerate(pieces):
            grid = np.arange(len(piece.drive))
            between = CubicSpline(grid, piece.drive)  # straight lines would round a drive's corners off
            at = np.clip(grid - delay[0] / piece.step, 0.0, grid[-1])
            found[i] = between(at)
            slopes.append(-between(at, 1) / piece.step)
    begins = np.cumsum([0, *(len(d) for d in found)])
    drive, zero = np.concatenate(found), np.repeat(zeros, np.diff(begins))
    given = [p.motor for p in pieces if p.motor is not None]
    if given:
        motor = np.concatenate([m.signal for m in given]) + zero, np.concatenate([m.on for m in given])
        own = np.zeros((1, len(drive)))
    else:
        motor, own = (np.zeros(1), np.zeros(1)), np.ones((1, len(drive)))
        drive = drive + zero
    return drive, np.vstack([own, np.concatenate(slopes)]) if slopes else own, motor, begins


def _arranged(model: Compiled, slopes: Array, states: int, n_lin: int, rest: int, delay) -> Array:
    """Columns in the order (states, coordinates, zero), with room for what is done to channels afterwards."""
    count, first = len(model.values), states + n_lin
    if slopes.shape[-1] == states + count + 1 and delay is None:
        slopes[..., first : first + rest] *= model.slopes[n_lin : n_lin + rest]
        return slopes
    out = np.zeros((*slopes.shape[:-1], states + count + 1))
    out[..., : first + rest] = slopes[..., : first + rest]
    out[..., first : first + rest] *= model.slopes[n_lin : n_lin + rest]
    out[..., -1] = slopes[..., first + rest]
    if delay is not None:
        out[..., states + delay[1]] = slopes[..., first + rest + 1] * model.slopes[delay[1]]
    return out


def _afterwards(model: Compiled, piece: Piece, y: Array, dy: Array, states: int) -> tuple[Array, Array]:
    """What instruments do to a piece's channels."""
    node = model.node
    for member in (m for m in node.members if m.after == "clip"):
        at = [id(c) for c in node.coordinates].index(id(member.coordinates[0]))
        limit = model.values[at]
        for c in (c for c, name in enumerate(piece.channels) if name == member.channel):
            beyond = np.abs(y[:, c]) > limit
            dy[beyond, c] = 0.0
            dy[beyond, c, states + at] = np.sign(y[beyond, c]) * model.slopes[at]
            y[:, c] = np.clip(y[:, c], -limit, limit)
    for member in (m for m in node.members if m.after == OUTPUT):
        places = [[id(c) for c in node.coordinates].index(id(own)) for own in member.coordinates]
        names = [c.name for c in member.coordinates]
        given = {name: float(model.values[k]) for name, k in zip(names, places, strict=True)}
        own = {name: (states + k, float(model.slopes[k])) for name, k in zip(names, places, strict=True)}
        y, dy = passed_on(member, piece, y, dy, given, own)
    return y, dy
