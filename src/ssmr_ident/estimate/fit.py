"""One fit for every model of a rig: multiple shooting from far away, then the exact simulation to the end."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from enum import Enum

import numpy as np
from scipy.signal import lfilter

from ssmr_ident.estimate.motion_kernel import run
from ssmr_ident.estimate.node import Coordinate, Node, Tables, law_places, law_vector, merged, stepped_with_slopes
from ssmr_ident.estimate.pieces import Piece
from ssmr_ident.estimate.shoot_kernel import eliminate
from ssmr_ident.signals.noise import AutoregressiveNoise

Array = np.ndarray

CONTINUITY = (0.3, 0.1, 0.03, 0.01, 1e-3, 1e-4)
"""Standard deviations of the jumps between stretches, in the size of the motion: from loose to as good as exact."""

LOOSE_STEPS, LAST_STEPS = 6, 12
CLOSE = 0.02
"""Share of the motion below which noise is not believed while stretches are joined."""

GAIN = 0.02
"""Standard deviation of what a force cell's or a sensor's gain changes by from one recording to the next."""

ZERO_SHARE = 0.3
"""Standard deviation of a drive's zero, in the drive's own."""


REMEMBER = ("dry_friction", "hysteresis", "viscoelastic_relaxation", "unlisted")
"""Laws by the hidden state of an element that they use; the last one by its terms."""


class Stop(Enum):
    CONVERGED = "no step lowers the cost by a thousandth of a unit"
    STEPS = "more steps would lower the cost further: begin nearer, or allow more"
    LOST = "the simulation left the finite numbers"


@dataclass(frozen=True, eq=False)
class Problem:
    """Recordings as one inverse problem.

    Parameters
    ----------
    pieces : tuple of Piece
    baseline : tuple of Coordinate
        Mass, damping, stiffness.
    noises : tuple of tuple of AutoregressiveNoise
        Per piece and channel.
    frequency : float [Hz]
        Of the motion.
    size : float [m]
        RMS deflection.
    """

    pieces: tuple[Piece, ...]
    baseline: tuple[Coordinate, ...]
    noises: tuple[tuple[AutoregressiveNoise, ...], ...]
    frequency: float
    size: float

    @property
    def speed(self) -> float:
        return 2.0 * math.pi * self.frequency * self.size

    @property
    def samples(self) -> int:
        return sum(int(p.counts.sum()) for p in self.pieces)


@dataclass(frozen=True, eq=False)
class Fit:
    """A node at its best.

    Parameters
    ----------
    node : Node
    point : (p,) float
        Coordinates.
    nuisances : tuple of (k,) float
        Per piece: states at its begin (linear, hidden), where it is driven the drive's
        zero and what the gain is off by, zeros of the channels.
    covariance : (p, p) float
        Of the coordinates.
    residuals : tuple of (n, c) float
        Model less measured, SI.
    chi2 : float
        Of the whitened residuals.
    prior : float
        What the priors of the physics add to it.
    dof : float
        Parameters that the data decide, of those with a prior in part.
    stop : Stop
    """

    node: Node
    point: Array
    nuisances: tuple[Array, ...]
    covariance: Array
    residuals: tuple[Array, ...]
    chi2: float
    prior: float
    dof: float
    stop: Stop = Stop.CONVERGED

    @property
    def cost(self) -> float:
        return self.chi2 + self.prior

    def value(self, name: str) -> float:
        names = [c.name for c in self.node.coordinates]
        return float(self.node.values(self.point)[names.index(name)])


@dataclass(frozen=True, eq=False)
class Start:
    """Where a fit begins: a point, and nuisances or a path per piece."""

    point: Array
    nuisances: tuple[Array, ...] | None = None
    paths: tuple[Array, ...] | None = None


@dataclass(frozen=True, eq=False)
class _Simulated:
    y: Array
    dy: Array
    ends: Array
    dends: Array


@dataclass(frozen=True, eq=False)
class _Compiled:
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
    def of(cls, problem: Problem, node: Node, point: Array, pieces: Sequence[Piece]) -> _Compiled:
        places, scales = law_places(node)
        return cls(
            node, node.values(point), node.slopes(point), merged(node, len(pieces)), law_vector(node, point), places,
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

    def delay(self) -> tuple[float, int] | None:
        for member in self.node.members:
            if member.after == "delay":
                at = [id(c) for c in self.node.coordinates].index(id(member.coordinates[0]))
                return float(self.values[at]), at
        return None


def simulate(model: _Compiled, index: int, starts: Array, borders: Array, zero: float) -> _Simulated:
    """A piece in stretches, with slopes over (states, coordinates, zero of the drive)."""
    node, piece, problem = model.node, model.pieces[index], model.problem
    lin, d_lin, rows, d_rows = model.stepping(piece)
    n_lin = 3 + node.count("linear")
    n_tab, n_law = node.count("tables"), node.count("law")
    tables = model.tables
    generic = model.values[n_lin : n_lin + n_tab]
    g = (
        tables.reach, (tables.low, tables.top, 0.0 if piece.based else 1.0), tables.by_position, tables.by_velocity,
        tables.by_both, tables.courses[index], tables.kinds, np.ascontiguousarray(generic),
        np.stack([model.values[:n_lin], model.slopes[:n_lin]]), tables.yields, n_law > 0 or _has_law(node), model.law,
        model.places, model.scales, problem.size, problem.speed, model.remembers,
    )  # fmt: skip
    drive, drives = piece.drive, np.ones((1, len(piece.drive)))
    delay = model.delay()
    if delay is not None:
        late, _ = delay
        grid = np.arange(len(drive))
        drive = np.interp(grid - late / piece.step, grid, piece.drive)
        drives = np.stack([drives[0], -np.gradient(drive) / piece.step])
    drive = drive + zero
    states = starts.shape[1]
    columns = states + n_lin + n_tab + n_law + len(drives)
    y, dy = np.empty(piece.y.shape), np.empty((*piece.y.shape, columns))
    ends, dends = np.empty(starts.shape), np.empty((*starts.shape, columns))
    begin = float(piece.time[0])
    run(lin, d_lin, rows, d_rows, g, node.beside, starts, borders, drive, drives, piece.every, piece.step, begin,
        y, dy, ends, dends)  # fmt: skip
    return _arranged(model, index, _Simulated(y, dy, ends, dends), states, n_lin, n_tab + n_law, delay)


def _has_law(node: Node) -> bool:
    return any(m.law is not None for m in node.members)


def _arranged(model: _Compiled, index: int, s: _Simulated, states: int, n_lin: int, rest: int, delay) -> _Simulated:
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
    return _Simulated(y, dy, s.ends, order(s.dends))


def nuisance_scales(problem: Problem, node: Node, piece: Piece) -> Array:
    """Prior standard deviations of a piece's nuisances."""
    sizes = 10.0 * state_sizes(problem, node)
    # what holds a mass aside has loaded its friction; a driven one begins at rest
    sizes[node.linear_states :] *= 1e-6 if piece.driven else 0.1
    zero, offsets = _zeros(piece)
    return np.concatenate([sizes, zero, np.full(len(zero), GAIN), offsets])


def _zeros(piece: Piece) -> list[Array]:
    spread = np.std(piece.drive) if piece.driven else 0.0
    zero = np.array([max(ZERO_SHARE * spread, 1e-12)]) if piece.driven else np.zeros(0)
    return [zero, 3.0 * piece.y.std(axis=0) + np.abs(piece.y.mean(axis=0))]


def state_sizes(problem: Problem, node: Node) -> Array:
    """Sizes of linear and hidden states in SI."""
    x, turning = problem.size, 2.0 * math.pi * problem.frequency
    sizes = [x, x * turning]
    for member in (m for m in node.members if m.linear):
        sizes += {"lag": [x * turning**2, x * turning**3], "branch": [x], "rider": [x, x * turning]}[member.linear]
    return np.array(sizes + [x] * node.hidden_states)


def priors(node: Node) -> tuple[Array, Array]:
    """Means and precisions of the coordinates."""
    coordinates = node.coordinates
    mean = np.array([c.mean for c in coordinates])
    return mean, np.array([1.0 / c.std**2 if math.isfinite(c.std) else 0.0 for c in coordinates])


def bounded(node: Node, point: Array) -> Array:
    return np.array([c.at(c.value(float(p))) for c, p in zip(node.coordinates, point, strict=True)])


# ---------------------------------------------------------------------------------------------- exact simulation


def _whitened(problem: Problem, index: int, columns: Array) -> Array:
    """(n, c, …) through each channel's whitening filter, in its standard deviation; uncounted samples are nought."""
    piece = problem.pieces[index]
    out = np.where(piece.counts.reshape(*piece.counts.shape, *[1] * (columns.ndim - 2)), columns, 0.0)
    for c, noise in enumerate(problem.noises[index]):
        own = out[:, c] if noise.order == 0 else lfilter(noise.filter, [1.0], out[:, c], axis=0)
        out[:, c] = own / noise.std
    return out


def _exact(problem: Problem, node: Node, point: Array, nuisances: Sequence[Array]):
    """Normal equations by exact simulation: chi2, residuals, and per piece (J, r) over (nuisance, coordinates)."""
    model = _Compiled.of(problem, node, point, problem.pieces)
    n = node.states
    chi2, residuals, parts = 0.0, [], []
    for index, (piece, nuisance) in enumerate(zip(problem.pieces, nuisances, strict=True)):
        start = nuisance[None, :n].copy()
        zero = float(nuisance[n]) if piece.driven else 0.0
        s = simulate(model, index, start, np.array([0, len(piece.y)]), zero)
        c = piece.y.shape[1]
        gain = 1.0 + nuisance[n + 1] if piece.driven else 1.0
        rest = gain * s.y + nuisance[-c:] - piece.y
        if not np.isfinite(rest).all():
            return math.inf, [], []
        states = start.shape[1]
        flat = np.zeros((*piece.y.shape, len(nuisance) + len(point)))
        flat[..., :n] = gain * s.dy[..., :n]
        if piece.driven:
            flat[..., n] = gain * s.dy[..., -1]
            flat[..., n + 1] = s.y
        for k in range(c):
            flat[:, k, len(nuisance) - c + k] = 1.0
        flat[..., len(nuisance) :] = gain * s.dy[..., states:-1]
        white = _whitened(problem, index, np.concatenate([flat, rest[..., None]], axis=2)).reshape(
            -1, flat.shape[2] + 1
        )
        chi2 += float(white[:, -1] @ white[:, -1])
        residuals.append(rest)
        normal = white.T @ white
        parts.append((normal[:-1, :-1], normal[:-1, -1], len(nuisance)))
    return chi2, residuals, parts


def polish(problem: Problem, node: Node, start: Start, steps: int = 30, freeze: Sequence[int] = ()) -> Fit:
    """Levenberg-Marquardt on the exact simulation, nuisances eliminated piece by piece."""
    point = bounded(node, start.point)
    nuisances = list(start.nuisances if start.nuisances is not None else starts_of(problem, node, start))
    mean, precision = priors(node)
    scales = [nuisance_scales(problem, node, piece) for piece in problem.pieces]
    held = np.zeros(len(point), dtype=bool)
    held[list(freeze)] = True

    def total(chi2: float, at: Array, local: Sequence[Array]) -> float:
        own = sum(float(np.sum((v / s) ** 2)) for v, s in zip(local, scales, strict=True))
        return chi2 + float(np.sum(precision * (at - mean) ** 2)) + own

    chi2, residuals, parts = _exact(problem, node, point, nuisances)
    cost = total(chi2, point, nuisances)
    if not math.isfinite(cost):
        return _failed(problem, node, point, nuisances)
    damping, stop = 1e-3, Stop.STEPS
    for _ in range(steps):
        lower_any = False
        for _ in range(6):
            solved = _step(parts, point, nuisances, mean, precision, scales, damping, held)
            new_point = bounded(node, point + solved[0])
            new = [v + d for v, d in zip(nuisances, solved[1], strict=True)]
            with np.errstate(over="ignore", invalid="ignore"):
                trial = _exact(problem, node, new_point, new)
            lower = total(trial[0], new_point, new)
            if lower < cost:
                lower_any = True
                break
            damping = max(damping * 8.0, 1e-4)
        if not lower_any:
            stop = Stop.CONVERGED
            break
        gain, cost = cost - lower, lower
        point, nuisances, (chi2, residuals, parts) = new_point, new, trial
        damping = damping / 5.0 if damping > 1e-9 else 0.0
        if gain < 1e-3 + 1e-7 * cost:
            stop = Stop.CONVERGED
            break
    return _finished(node, point, nuisances, mean, precision, scales, chi2, residuals, parts, stop, held)


def _step(parts, point, nuisances, mean, precision, scales, damping, held):
    p = len(point)
    left = np.diag(precision + 1e-12)
    right = -precision * (point - mean)
    eliminated = []
    for (h, g, k), nuisance, scale in zip(parts, nuisances, scales, strict=True):
        own = h[:k, :k] + np.diag(1.0 / scale**2)
        own = own + damping * np.diag(np.diag(own))
        cross, line = h[:k, k:], g[:k] + nuisance / scale**2
        solved = np.linalg.solve(own, np.column_stack([cross, line]))
        left = left + h[k:, k:] - cross.T @ solved[:, :-1]
        right = right - g[k:] + cross.T @ solved[:, -1]
        eliminated.append(solved)
    left = left + damping * np.diag(np.maximum(np.diag(left), 1e-12))
    free = ~held
    step = np.zeros(p)
    step[free] = _solved(left[np.ix_(free, free)], right[free])
    return step, [-(solved[:, :-1] @ step) - solved[:, -1] for solved in eliminated]


def _solved(left: Array, right: Array) -> Array:
    """Symmetric equations, rows and columns first brought to one size."""
    size = np.sqrt(np.maximum(np.diag(left), 1e-300))
    return np.linalg.lstsq(left / np.outer(size, size), right / size, rcond=1e-13)[0] / size


def _finished(node, point, nuisances, mean, precision, scales, chi2, residuals, parts, stop, held) -> Fit:
    information = np.zeros((len(point), len(point)))
    for (h, _, k), scale in zip(parts, scales, strict=True):
        own = h[:k, :k] + np.diag(1.0 / scale**2)
        information += h[k:, k:] - h[:k, k:].T @ np.linalg.solve(own, h[:k, k:])
    free = ~held
    covariance = np.zeros_like(information)
    covariance[np.ix_(free, free)] = np.linalg.pinv(
        (information + np.diag(precision + 1e-12))[np.ix_(free, free)], rcond=1e-14, hermitian=True
    )
    # shapes of a generic member count as far as the data decide them, laws with every parameter that moves
    shapes = {id(c) for m in node.members if m.tables for c in m.coordinates}
    decided = np.where(free, np.diag(covariance @ information), 0.0)
    moving = [float(f and c.std > 1e-6) for c, f in zip(node.coordinates, free, strict=True)]
    dof = sum(float(d) if id(c) in shapes else m for c, d, m in zip(node.coordinates, decided, moving, strict=True))
    prior = float(np.sum(precision * (point - mean) ** 2))
    return Fit(node, point, tuple(nuisances), covariance, tuple(residuals), chi2, prior, dof, stop)


def _failed(problem: Problem, node: Node, point: Array, nuisances: Sequence[Array]) -> Fit:
    rest = tuple(np.full(p.y.shape, math.nan) for p in problem.pieces)
    return Fit(node, point, tuple(nuisances), np.zeros((len(point),) * 2), rest, math.inf, 0.0, 0.0, Stop.LOST)


# -------------------------------------------------------------------------------------------- multiple shooting


def regressed(problem: Problem, paths: Sequence[Array], node: Node) -> Array:
    """A node's coordinates by regressing the force on a path: where fits begin, whatever the file says.

    Mass, damping, stiffness and the tables of generic members enter linearly; all else begins at its usual value.

    Parameters
    ----------
    problem : Problem
    paths : sequence of (n, 3) float
        Position, velocity, acceleration per piece.
    node : Node
    """
    mass, tables = problem.baseline[0], merged(node, len(problem.pieces))
    rows, right = [], []
    for index, (piece, path) in enumerate(zip(problem.pieces, paths, strict=True)):
        own = piece.drive[:: piece.every][: len(path)] if piece.driven else np.zeros(len(path))
        if piece.based:  # relative to the base, whose motion acts as a force on the mass
            own = -mass.scale * own
        beside = tables.along(path, tables.courses[index], mass.scale)
        rows.append(np.column_stack([path[:, ::-1], np.ones(len(path)), beside]))
        right.append(own)
    design, force = np.vstack(rows), np.concatenate(right)
    known = mass.std < 1e-6 or not any(p.driven and not p.based for p in problem.pieces)
    if known:
        force, design = force - mass.scale * design[:, 0], design[:, 1:]
    size = np.sqrt(np.mean(design**2, axis=0)) + 1e-300
    ridge = np.diag([0.0] * (3 if known else 4) + [1e-3 * math.sqrt(len(force))] * tables.linear)
    padded = np.vstack([design / size, ridge])
    found = np.linalg.lstsq(padded, np.concatenate([force, np.zeros(len(ridge))]), rcond=None)[0] / size
    m, d, k = (mass.scale, *found[:2]) if known else found[:3]
    usual = [c.value(c.mean) for c in problem.baseline]
    values = [m if m > 0.1 * usual[0] else usual[0], max(d, 0.0), k if k > 0.0 else usual[2]]
    point = np.array([c.mean for c in node.coordinates])
    point[:3] = [c.at(v) if c.std > 1e-6 else c.mean for c, v in zip(problem.baseline, values, strict=True)]
    first, coefficients = 3 + node.count("linear"), found[3 if known else 4 :]
    for at, value in enumerate(coefficients.tolist(), first):
        point[at] = node.coordinates[at].at(value)
    return point


def starts_of(problem: Problem, node: Node, start: Start) -> list[Array]:
    """Nuisances from the begin of the paths."""
    found = []
    assert start.paths is not None
    for piece, path in zip(problem.pieces, start.paths, strict=True):
        states = np.zeros(node.states)
        states[:2] = path[0, :2]
        found.append(np.concatenate([states, np.zeros(2 * int(piece.driven) + piece.y.shape[1])]))
    return found


def shot(problem: Problem, node: Node, start: Start, continuity: Sequence[float] = CONTINUITY) -> Start:
    """Multiple shooting from paths: stretches of a period, whose borders are joined from loose to as good as exact.

    Parameters
    ----------
    problem : Problem
    node : Node
    start : Start
        With paths, (n, 3) per piece.
    continuity : sequence of float

    Returns
    -------
    Start
        Point and nuisances for the exact simulation.
    """
    assert start.paths is not None
    point, sizes, n = bounded(node, start.point), state_sizes(problem, node), node.linear_states
    mean, precision = priors(node)
    pieces = problem.pieces
    borders, states, local, weights = [], [], [], []
    for piece, path in zip(pieces, start.paths, strict=True):
        length = max(4, round(piece.rate / problem.frequency))
        edge = np.append(np.arange(0, max(len(piece.y) - length // 2, 1), length), len(piece.y))
        own = np.zeros((len(edge) - 1, len(sizes)))
        own[:, :2] = path[edge[:-1], :2]
        borders.append(edge)
        states.append(own)
        local.append(np.zeros(int(piece.driven) + piece.y.shape[1]))
        weights.append(1.0 / np.maximum(np.array([noise.std for noise in problem.noises[len(borders) - 1]]),
                                        CLOSE * piece.y.std(axis=0)))  # fmt: skip
    local_scales = [np.concatenate(_zeros(piece)) for piece in pieces]
    gain_floor = 1e-3
    for level, tight in enumerate(continuity):
        weight = 1.0 / (tight * sizes) ** 2
        current = _shooting(
            problem, node, point, states, local, borders, weights, weight, local_scales, mean, precision
        )
        if not math.isfinite(current[0]):
            break
        damping = 1e-4
        for _ in range(LAST_STEPS if level == len(continuity) - 1 else LOOSE_STEPS):
            better = False
            for _ in range(4):
                trial = _joined(current, point, states, local, mean, precision, weight, sizes, damping)
                moved = bounded(node, trial[0])
                with np.errstate(over="ignore", invalid="ignore"):
                    new = _shooting(
                        problem,
                        node,
                        moved,
                        trial[1],
                        trial[2],
                        borders,
                        weights,
                        weight,
                        local_scales,
                        mean,
                        precision,
                    )
                if new[0] < current[0]:
                    better = True
                    break
                damping = max(damping * 10.0, 1e-4)
            if not better:
                break
            gain = current[0] - new[0]
            point, states, local, current = moved, trial[1], trial[2], new
            damping /= 5.0
            if gain < gain_floor * max(current[0], 1.0):
                break
    for piece, own in zip(pieces, states, strict=True):
        own[0, n:] *= 0.0 if piece.driven else 1.0
    nuisances = []
    for piece, own, extra in zip(pieces, states, local, strict=True):
        driven = int(piece.driven)
        nuisances.append(np.concatenate([own[0], extra[:driven], np.zeros(driven), extra[driven:]]))
    return Start(point, tuple(nuisances))


def _shooting(problem, node, point, states, local, borders, weights, weight, local_scales, mean, precision):
    """Cost of stretches and defects, and what their elimination takes."""
    model = _Compiled.of(problem, node, point, problem.pieces)
    cost = float(np.sum(precision * (point - mean) ** 2))
    systems = []
    for index, piece in enumerate(problem.pieces):
        driven, c = int(piece.driven), piece.y.shape[1]
        zero = float(local[index][0]) if driven else 0.0
        s = simulate(model, index, states[index], borders[index], zero)
        rest = (s.y + local[index][driven:] - piece.y) * weights[index] * piece.counts
        defect = s.ends[:-1] - states[index][1:]
        cost += float(np.sum(rest**2) + np.sum(weight * defect**2) + np.sum((local[index] / local_scales[index]) ** 2))
        if not math.isfinite(cost):
            return math.inf, ()
        k, p = states[index].shape[1], len(point)
        count, edge = len(borders[index]) - 1, borders[index]
        longest = int(np.diff(edge).max())
        jac = np.zeros((count, longest, c, k + p + driven + c + 1))
        for low, high in {(0, count - 1), (count - 1, count)}:
            if high <= low:
                continue
            rows = slice(edge[low], edge[high])
            shape = (high - low, -1, c)
            take = edge[low + 1] - edge[low]
            block = jac[low:high, :take]
            block[..., : k + p] = s.dy[rows, :, : k + p].reshape(*shape, k + p)
            if driven:
                block[..., k + p] = s.dy[rows, :, -1].reshape(shape)
            for i in range(c):
                block[:, :, i, k + p + driven + i] = 1.0
            block[..., :-1] *= (weights[index] * piece.counts[rows]).reshape(*shape, 1)
            block[..., -1] = rest[rows].reshape(shape)
        jac = jac.reshape(count, longest * c, -1)
        normal = np.matmul(jac.transpose(0, 2, 1), jac)
        f = np.zeros((count, k, k + p + driven + c))
        f[..., : k + p] = s.dends[..., : k + p]
        if driven:
            f[..., k + p] = s.dends[..., -1]
        gap = np.vstack([defect, np.zeros((1, k))])
        systems.append((normal[:, :-1, :-1].copy(), normal[:, :-1, -1].copy(), f, gap, driven + c, local_scales[index]))
    return cost, systems


def _joined(current, point, states, local, mean, precision, weight, sizes, damping):
    """One Gauss-Newton step of everything: parameters, nuisances, states at the borders."""
    p, kept = len(point), []
    left, right = np.diag(precision + 1e-12), -precision * (point - mean)
    for index, (h, g, f, gap, _, scale) in enumerate(current[1]):
        k = states[index].shape[1]
        soft = damping * np.diagonal(h[:, :k, :k], axis1=1, axis2=2).mean(axis=0) + 1e-6 / sizes**2
        a, b, gain, by_par, base = eliminate(h, g, f, gap, weight, k, soft)
        own = a[p:, p:] + np.diag(1.0 / scale**2)
        line = b[p:] + local[index] / scale**2
        solved = np.linalg.solve(own, np.column_stack([a[p:, :p], line]))
        left = left + a[:p, :p] - a[:p, p:] @ solved[:, :-1]
        right = right - b[:p] + a[:p, p:] @ solved[:, -1]
        kept.append((gain, by_par, base, solved))
    step = _solved(left + damping * np.diag(np.maximum(np.diag(left), 1e-12)), right)
    new_states, new_local = [], []
    for index, (gain, by_par, base, solved) in enumerate(kept):
        extra = -(solved[:, :-1] @ step) - solved[:, -1]
        full = np.concatenate([step, extra])
        moves = base + by_par @ full
        for s in range(len(moves) - 2, -1, -1):
            moves[s] += gain[s] @ moves[s + 1]
        new_states.append(states[index] + moves)
        new_local.append(local[index] + extra)
    return point + step, new_states, new_local


def motion(problem: Problem, found: Fit) -> list[Array]:
    """(n, 3) per piece: position, velocity, acceleration (absolute on a driven base) of a fit at the samples."""
    pieces = [
        replace(p, channels=("position", "velocity", "acceleration"), orders=np.arange(3), y=np.zeros((len(p.y), 3)))
        for p in problem.pieces
    ]
    node, paths = found.node, []
    bare = Node(node.baseline, tuple(m for m in node.members if m.linear != "lag" and m.after != "clip"))
    names = [id(c) for c in node.coordinates]
    point = np.array([found.point[names.index(id(c))] for c in bare.coordinates])
    model = _Compiled.of(problem, bare, point, pieces)
    for index, (piece, nuisance) in enumerate(zip(pieces, found.nuisances, strict=True)):
        start = np.zeros((1, bare.linear_states + bare.hidden_states))
        own, at = [], 2
        for member in (m for m in node.members if m.linear):
            size = {"lag": 2, "branch": 1, "rider": 2}[member.linear]
            own += list(nuisance[at : at + size]) if member.linear != "lag" else []
            at += size
        start[0] = [*nuisance[:2], *own, *nuisance[node.linear_states : node.states]]
        zero = float(nuisance[node.states]) if piece.driven else 0.0
        paths.append(simulate(model, index, start, np.array([0, len(piece.y)]), zero).y)
    return paths


def fit(problem: Problem, node: Node, start: Start, steps: int = 30) -> Fit:
    """A node's best, from a start with paths (by multiple shooting) or with nuisances (by exact simulation alone)."""
    if start.nuisances is None:
        start = shot(problem, node, start)
    return polish(problem, node, start, steps)


def with_noises(problem: Problem, noises: Sequence[tuple[AutoregressiveNoise, ...]]) -> Problem:
    return replace(problem, noises=tuple(noises))
