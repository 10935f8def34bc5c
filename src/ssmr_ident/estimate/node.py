"""Models as values: a rig's baseline and the members beside it, and how they become numbers for the kernel."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property

import numpy as np

from ssmr_ident.estimate.coordinate import Coordinate
from ssmr_ident.estimate.motor import armature
from ssmr_ident.estimate.pieces import Piece, Seen
from ssmr_ident.physics.effects import CATALOGUE
from ssmr_ident.physics.element import STATES
from ssmr_ident.physics.exponential import exponentials
from ssmr_ident.physics.network import ONE, Layout
from ssmr_ident.physics.slots import SLOTS, effect_vector
from ssmr_ident.simulate.kicks import kicks, seen_by

Array = np.ndarray

LAG, LAG_1, BRANCH, RIDER = "lag", "first-order lag", "branch", "rider"
"""Linear members: a slow sensor of second order or first, a Maxwell branch, a part of the mass on its own spring."""

LAGS = (LAG, LAG_1)

STATES_OF = {LAG: 2, LAG_1: 1, BRANCH: 1, RIDER: 2}
"""States that each has."""

MEMORY = "memory"
"""The kind of what has states of its own that no log shows."""

APART = 1e-5
"""Relative step of the differences of small matrices, which are exact to 1e-15."""


def _no_courses(piece: Piece) -> Array:
    return np.zeros((1, 0))


@dataclass(frozen=True, eq=False)
class Tables:
    """A generic member: forces linear in their coefficients, by tables.

    Parameters
    ----------
    by_position, by_velocity : (g, k) float
        Over -1 … 1 of x/reach; of asinh(v/low)/top.
    by_both : (2, g, k) float
        Over the one and the other, to be multiplied.
    reach, low, top : float
    courses : callable
        ``courses(piece)``: (n, k) float over a piece's samples.
    kinds : (k,) int
        What a course multiplies.
    yields : (k,) float
        Of spring-slider elements.
    """

    by_position: Array = field(default_factory=lambda: np.zeros((2, 0)))
    by_velocity: Array = field(default_factory=lambda: np.zeros((2, 0)))
    by_both: Array = field(default_factory=lambda: np.zeros((2, 2, 0)))
    reach: float = 1.0
    low: float = 1.0
    top: float = 1.0
    courses: Callable[[Piece], Array] = _no_courses
    kinds: Array = field(default_factory=lambda: np.zeros(0, dtype=np.int64))
    yields: Array = field(default_factory=lambda: np.zeros(0))

    @property
    def size(self) -> int:
        tables = self.by_position.shape[1] + self.by_velocity.shape[1] + self.by_both.shape[2]
        return tables + len(self.kinds) + len(self.yields)

    @property
    def linear(self) -> int:
        """Coefficients whose forces a path alone gives: all but those of spring-slider elements."""
        return self.size - len(self.yields)

    def along(self, path: Array, courses: Array, mass: float) -> Array:
        """(n, linear) float: forces of unit coefficients along a path.

        Parameters
        ----------
        path : (n, 3) float
            Position, velocity, acceleration.
        courses : (n, k) float
            Of the piece.
        mass : float [kg]
        """
        x, v = path[:, 0], path[:, 1]
        places = (x / self.reach, np.arcsinh(v / self.low) / self.top)

        def read(table: Array, place: Array) -> Array:
            grid = np.linspace(-1.0, 1.0, len(table))
            return np.array([np.interp(place, grid, c) for c in table.T]).reshape(-1, len(path)).T

        columns = [read(self.by_position, places[0]), read(self.by_velocity, places[1])]
        columns.append(read(self.by_both[0], places[0]) * read(self.by_both[1], places[1]))
        factors = (x, v, np.ones(len(x)), -mass * path[:, 2])
        columns += [(courses[:, i] * factors[kind])[:, None] for i, kind in enumerate(self.kinds.tolist())]
        return np.hstack(columns)


@dataclass(frozen=True, eq=False)
class Member:
    """A piece of physics beside the linear rig, in one formula.

    Parameters
    ----------
    id : str
        Effect of the catalogue, or ``unlisted``.
    kind : str
    form : str
        Which formula, short; ``any shape`` for a generic one.
    coordinates : tuple of Coordinate
    tables : Tables or None
        Of a generic member.
    linear : str
        Of ``STATES_OF``; empty for what is not linear.
    law : mapping of str to float
        Parameters of the effect that are held, where it is a law of the catalogue.
    after : str
        ``clip`` or ``delay``: what is done to the channel, or to the drive.
    channel : str
        Which channel that is.
    variable : str
        ``x`` or ``v``, of which alone a static force is a function; empty for both, and for other kinds.
    element : str
        Spring or body of a network at which it acts; empty on a rig, which has one of each.
    """

    id: str
    kind: str
    form: str
    coordinates: tuple[Coordinate, ...]
    tables: Tables | None = None
    linear: str = ""
    law: Mapping[str, float] | None = None
    after: str = ""
    channel: str = ""
    variable: str = ""
    element: str = ""

    @property
    def name(self) -> str:
        what = f"{self.kind} in {self.form}" if self.tables else f"{self.id} ({self.form})" if self.form else self.id
        return f"{what} at {self.element}" if self.element else what


@dataclass(frozen=True, eq=False)
class Node:
    """The baseline's coordinates, in the order of the layout's keys, and the members beside it."""

    baseline: tuple[Coordinate, ...]
    members: tuple[Member, ...] = ()
    layout: Layout = ONE

    @property
    def name(self) -> str:
        """The same in whatever order members were found."""
        return " + ".join(sorted(m.name for m in self.members)) or "baseline"

    @property
    def generic(self) -> bool:
        return any(m.tables for m in self.members)

    @cached_property
    def coordinates(self) -> tuple[Coordinate, ...]:
        """Linear ones, then those of tables, laws, and what is done afterwards."""
        rest = [m for m in self.members if not m.linear]
        order = [m for m in self.members if m.linear]
        order += sorted(rest, key=_place)
        return (*self.baseline, *(c for m in order for c in m.coordinates))

    def count(self, kind: str) -> int:
        chosen = {
            "linear": [m for m in self.members if m.linear],
            "tables": [m for m in self.members if m.tables],
            "law": [m for m in self.members if m.law is not None],
            "after": [m for m in self.members if m.after],
        }[kind]
        return sum(len(m.coordinates) for m in chosen)

    def of(self, member: Member, point: Array) -> dict[str, float]:
        """Values of a member's parameters."""
        names = {id(c): float(v) for c, v in zip(self.coordinates, self.values(point), strict=True)}
        return {c.name: names[id(c)] for c in member.coordinates}

    def values(self, point: Array) -> Array:
        return np.array([c.value(float(p)) for c, p in zip(self.coordinates, point, strict=True)])

    def slopes(self, point: Array) -> Array:
        return np.array([c.slope(float(p)) for c, p in zip(self.coordinates, point, strict=True)])

    def with_member(self, member: Member) -> Node:
        return replace(self, members=(*self.members, member))

    def without(self, member: Member) -> Node:
        return replace(self, members=tuple(m for m in self.members if m is not member))

    @property
    def linear_states(self) -> int:
        return self.motion_states + sum(STATES_OF[m.linear] for m in self.members if m.linear)

    @property
    def motion_states(self) -> int:
        """Coordinates of the bodies, then their rates."""
        return 2 * len(self.layout.bodies)

    @property
    def linear_count(self) -> int:
        """Coordinates of the fit that the linear part has."""
        return len(self.baseline) + self.count("linear")

    @property
    def site(self) -> int:
        """Number of the spring at which forces beside the linear network act."""
        names = {m.element for m in self.members if (m.tables or m.law is not None) and m.element}
        if len(names) > 1:
            raise ValueError(f"forces at several springs, {', '.join(sorted(names))}: one takes them all")
        return self.layout.springs.index(names.pop()) if names else 0

    @property
    def hidden_states(self) -> int:
        jenkins = sum(len(m.tables.yields) for m in self.members if m.tables)
        return jenkins + (STATES if any(m.law is not None and m.kind == MEMORY for m in self.members) else 0)

    @property
    def states(self) -> int:
        return self.linear_states + self.hidden_states

    @property
    def beside(self) -> bool:
        return any(m.tables or m.law is not None for m in self.members)


def _place(member: Member) -> int:
    """Order of the kernel's parameters: tables by what they hold, laws, what is done afterwards."""
    if member.tables:
        return 2 if len(member.tables.yields) else 1 if len(member.tables.kinds) else 0
    return 3 if member.law is not None else 4


def matrices(node: Node, values: Array, seen: Seen) -> tuple[Array, ...]:
    """A, what the drive and a force beside do to the states, and channels over states, drive and force.

    Parameters
    ----------
    node : Node
    values : (…, linear) float
        Of the baseline and the linear members; axes in front are those of what is returned.
    seen : Seen
    """
    layout, count, n, lead = node.layout, len(node.layout.bodies), node.linear_states, values.shape[:-1]
    rates = slice(count, 2 * count)
    mass, damping, stiffness = layout.matrices(values[..., : len(layout.keys)])
    mass = np.diagonal(mass, axis1=-2, axis2=-1)
    if layout == ONE:
        mass = mass + armature(values[..., : len(node.baseline)])[..., None]
    stretch = layout.stretch
    a = np.zeros((*lead, n, n))
    at, place = len(node.baseline), 2 * count
    share = np.zeros((*lead, count))
    places: dict[str, list[tuple[int, int, Array]]] = {}
    for member in (m for m in node.members if m.linear):
        size = len(member.coordinates)
        own = np.moveaxis(values[..., at : at + size], -1, 0)
        names = layout.springs if member.linear == BRANCH else layout.bodies
        element = names.index(member.element) if member.element else 0
        places.setdefault(member.linear, []).append((place, element, own))
        at, place = at + size, place + STATES_OF[member.linear]
        if member.linear == RIDER:
            share[..., element] += own[0]
    body = mass * (1.0 - share)
    a[..., :count, rates] = np.eye(count)
    a[..., rates, :count], a[..., rates, rates] = -stiffness / body[..., None], -damping / body[..., None]
    for i, spring, (stiff, tau) in places.get(BRANCH, []):
        a[..., rates, i] = -stiff[..., None] * stretch[spring] / body
        a[..., i, rates], a[..., i, i] = stretch[spring], -1.0 / tau
    kick, drive = np.zeros((*lead, n)), np.zeros((*lead, n))
    kick[..., rates] = stretch[node.site] / body
    drive[..., count + seen.into] = 1.0 / body[..., seen.into]
    if seen.based:
        drive[..., rates] = -1.0
    pulls = {i: _pull(hz, ratio) for i, _, (_, hz, ratio) in places.get(RIDER, [])}
    for i, on, (own, _, _) in places.get(RIDER, []):
        a[..., count + on, i : i + 2] += pulls[i] * (own * mass[..., on] / body[..., on])[..., None]
    for i, on, _ in places.get(RIDER, []):
        at = count + on
        a[..., i, i + 1] = 1.0
        a[..., i + 1, :] = -a[..., at, :]
        a[..., i + 1, i : i + 2] -= pulls[i]
        kick[..., i + 1] = -kick[..., at]
        drive[..., i + 1] = 0.0 if seen.based else -drive[..., at]
    channels = len(seen.orders)
    rows = np.zeros((*lead, channels, n))
    by_drive, by_force = np.zeros((*lead, channels)), np.zeros((*lead, channels))
    felt = 1.0 if seen.based else 0.0
    lagging: list[tuple[int, Array, dict[int, Array]]] = []
    for c, (order, on) in enumerate(zip(seen.orders, seen.bodies, strict=True)):
        at = count + on
        if order < 2:
            rows[..., c, on + count * order] = 1.0
        else:
            rows[..., c, :], by_drive[..., c], by_force[..., c] = a[..., at, :], drive[..., at] + felt, -kick[..., at]
    for i, on, (hz, *known) in places.get(LAG, []):
        turning, at = 2.0 * math.pi * hz, count + on
        a[..., i, i + 1] = turning
        a[..., i + 1, :] = turning[..., None] * a[..., at, :]
        a[..., i + 1, i] -= turning
        a[..., i + 1, i + 1] -= math.sqrt(2.0) * turning
        kick[..., i + 1] = turning * kick[..., at]
        drive[..., i + 1] = turning * (drive[..., at] + felt)
        once, twice = _undone(turning, known)
        lagging.append((on, twice, {i: 1.0 - twice, i + 1: once - math.sqrt(2.0) * twice}))
    for i, on, (hz, _, *known) in places.get(LAG_1, []):
        turning, at = 2.0 * math.pi * hz, count + on
        a[..., i, :] = turning[..., None] * a[..., at, :]
        a[..., i, i] -= turning
        kick[..., i] = turning * kick[..., at]
        drive[..., i] = turning * (drive[..., at] + felt)
        once, _ = _undone(turning, known)
        lagging.append((on, once, {i: 1.0 - once}))
    for on, passed, states in lagging:
        for c in (c for c, order in enumerate(seen.orders) if order == 2 and seen.bodies[c] == on):
            rows[..., c, :] = passed[..., None] * rows[..., c, :]
            by_drive[..., c] = passed * by_drive[..., c]
            by_force[..., c] = passed * by_force[..., c]
            for state, share in states.items():
                rows[..., c, state] += share
    return a, drive, kick, rows, by_drive, by_force


def _undone(turning: Array, known: Sequence[Array]) -> tuple[Array, Array]:
    """What a slow sensor's rate and its rate's rate count in a log that is rid of the low-pass that is known, which it
    takes the place of: 1 + sqrt(2) s/w + (s/w)^2 of that, in powers of its own turning rate; nought where none is."""
    over = sum((turning / (2.0 * math.pi * f) for f in known), np.zeros_like(turning))
    return math.sqrt(2.0) * over, over**2


def _pull(hz: Array, ratio: Array) -> Array:
    """What a rider's spring and damper do to it, of its displacement and its rate, per mass."""
    turning = 2.0 * math.pi * hz
    return np.stack([turning**2, 2.0 * ratio * turning], axis=-1)


def stepped(node: Node, values: Array, seen: Seen, step: float) -> tuple[tuple[Array, ...], tuple[Array, ...]]:
    """Exact step under a drive in a straight line, and the channels: ((T, now, later, kick, aside), rows).

    Parameters
    ----------
    values : (…, linear) float
        Axes in front are those of what is returned.
    """
    a, drive, force, rows, by_drive, by_force = matrices(node, values, seen)
    n = a.shape[-1]
    blocks = np.zeros((*a.shape[:-2], n + 2, n + 2))
    blocks[..., :n, :n], blocks[..., :n, n], blocks[..., n, n + 1] = a * step, drive * step, 1.0
    e = exponentials(blocks.reshape(-1, n + 2, n + 2)).reshape(blocks.shape)
    later = e[..., :n, n + 1].copy()
    kick, aside = kicks(a, force, step)
    lin = e[..., :n, :n].copy(), e[..., :n, n] - later, later, kick, aside
    return lin, (rows, by_drive, *seen_by(rows, by_force, kick, aside))


def stepped_with_slopes(node: Node, values: Array, slopes: Array, seen: Seen, step: float):
    """``stepped`` and its derivatives over the linear coordinates by central differences of the small matrices."""
    changes = APART * np.maximum(np.abs(values), 1e-3 * np.abs(slopes))
    aside, count = np.diag(changes), len(values)
    found = stepped(node, np.vstack([values[None], values + aside, values - aside]), seen, step)
    scales = slopes / (2.0 * changes)

    def slope(x: Array) -> Array:
        return (x[1 : count + 1] - x[count + 1 :]) * scales.reshape(-1, *[1] * (x.ndim - 1))

    lin, rows = (tuple(np.ascontiguousarray(x[0]) for x in part) for part in found)
    d_lin, d_rows = (tuple(slope(x) for x in part) for part in found)
    return lin, d_lin, rows, d_rows


def law_places(node: Node) -> tuple[Array, Array]:
    """Slots of the laws' coordinates in the effect vector, and their scales."""
    index, scale = [], []
    for member in node.members:
        if member.law is None:
            continue
        for c in member.coordinates:
            index.append(SLOTS.index(f"{member.id}.{c.name}"))
            scale.append(abs(c.scale))
    return np.array(index, dtype=np.int64), np.array(scale)


def effects_of(node: Node, point: Array) -> dict[str, dict[str, float]]:
    """The members that the simulator knows, with their parameters."""
    given: dict[str, dict[str, float]] = {}
    for member in (m for m in node.members if m.law is not None or m.linear or m.after):
        declared = {p.name for p in CATALOGUE[member.id].parameters}
        own = {**(member.law or {}), **node.of(member, point)}
        given[member.id] = {**given.get(member.id, {}), **{n: v for n, v in own.items() if n in declared}}
    return {effect: CATALOGUE[effect].begun(values) for effect, values in given.items()}


def law_vector(node: Node, point: Array) -> Array:
    return effect_vector({m.id: effects_of(node, point)[m.id] for m in node.members if m.law is not None})


def merged(node: Node) -> Tables:
    """The tables of a node's generic members side by side; each kind fills places of its own."""
    found = Tables()
    for own in (m.tables for m in node.members if m.tables):
        if own.size > len(own.kinds) + len(own.yields):
            found = replace(own, courses=found.courses, kinds=found.kinds, yields=found.yields)
        if len(own.kinds):
            found = replace(found, courses=own.courses, kinds=own.kinds)
        if len(own.yields):
            found = replace(found, yields=own.yields)
    return found
