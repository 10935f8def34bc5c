"""A node at a point as the compiled loop takes it, and a piece run through that loop with its slopes."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field

import numpy as np
from scipy.interpolate import CubicSpline

from ssmr_ident.estimate.instrument import OUTPUT, passed_on
from ssmr_ident.estimate.motion_kernel import run
from ssmr_ident.estimate.node import Node, Tables, law_places, law_vector, merged, stepped_with_slopes
from ssmr_ident.estimate.pieces import Piece
from ssmr_ident.estimate.values import Problem

Array = np.ndarray

REMEMBER = ("dry_friction", "hysteresis", "viscoelastic_relaxation", "unlisted")
"""Laws by the hidden state of an element that they use; the last one by its terms."""


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

    @property
    def remembers(self) -> Array:
        """(4,) bool: which hidden states of laws are in use, and whether terms that no list holds are."""
        return np.array([any(m.id == name and m.law is not None for m in self.node.members) for name in REMEMBER])

    @classmethod
    def of(cls, problem: Problem, node: Node, point: Array, pieces: Sequence[Piece]) -> Compiled:
        places, scales = law_places(node)
        return cls(
            node, node.values(point), node.slopes(point), merged(node), law_vector(node, point), places,
            scales, tuple(pieces), problem,
        )  # fmt: skip

    def stepping(self, piece: Piece) -> tuple:
        key = (piece.step, tuple(piece.orders), piece.based)
        if key not in self.steps:
            n = 3 + self.node.count("linear")
            self.steps[key] = stepped_with_slopes(
                self.node, self.values[:n], self.slopes[:n], piece.orders, piece.based, piece.step
            )
        return self.steps[key]

    def courses(self, piece: Piece) -> Array:
        return np.ascontiguousarray(self.tables.courses(piece))

    def delay(self) -> tuple[float, int] | None:
        for member in self.node.members:
            if member.after == "delay":
                at = [id(c) for c in self.node.coordinates].index(id(member.coordinates[0]))
                return float(self.values[at]), at
        return None


def simulate(model: Compiled, index: int, starts: Array, borders: Array, zero: float) -> Simulated:
    """A piece in stretches, with slopes over (states, coordinates, zero of the drive)."""
    node, piece, problem = model.node, model.pieces[index], model.problem
    lin, d_lin, rows, d_rows = model.stepping(piece)
    n_lin = 3 + node.count("linear")
    n_tab, n_law = node.count("tables"), node.count("law")
    tables = model.tables
    generic = model.values[n_lin : n_lin + n_tab]
    g = (
        tables.reach, (tables.low, tables.top, 0.0 if piece.based else 1.0), tables.by_position, tables.by_velocity,
        tables.by_both, model.courses(piece), tables.kinds, np.ascontiguousarray(generic),
        np.stack([model.values[:n_lin], model.slopes[:n_lin]]), tables.yields, n_law > 0 or _has_law(node), model.law,
        model.places, model.scales, problem.size, problem.speed, model.remembers,
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
    drive = drive + zero
    states = starts.shape[1]
    columns = states + n_lin + n_tab + n_law + len(drives)
    y, dy = np.empty(piece.y.shape), np.empty((*piece.y.shape, columns))
    ends, dends = np.empty(starts.shape), np.empty((*starts.shape, columns))
    begin = float(piece.time[0])
    run(lin, d_lin, rows, d_rows, g, node.beside, starts, borders, drive, drives, piece.every, piece.step, begin,
        y, dy, ends, dends)  # fmt: skip
    return _arranged(model, index, Simulated(y, dy, ends, dends), states, n_lin, n_tab + n_law, delay)


def _has_law(node: Node) -> bool:
    return any(m.law is not None for m in node.members)


def _arranged(model: Compiled, index: int, s: Simulated, states: int, n_lin: int, rest: int, delay) -> Simulated:
    """Columns in the order (states, coordinates, zero), what is done to channels afterwards among them."""
    node, count = model.node, len(model.values)
    first = states + n_lin

    def order(d: Array) -> Array:
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
