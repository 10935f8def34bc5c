"""All pulls of a block as one inverse problem: Gauss and Newton over shared and own unknowns, and its evidence.

The recordings touch each other through the shared unknowns alone, so own ones are eliminated recording by recording
(Schur's complement). Evidence is Laplace's: a moment of letting go that the log decides costs what it narrows.
"""

from __future__ import annotations

import itertools
import math
from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from ssmr_ident.identify.blocks.log import PulledLog
from ssmr_ident.identify.blocks.model import FALLING, KINETIC, KNOTS, STATIC, STIFFNESS, Blocks

Array = np.ndarray

ROUNDS, SETTLED = 30, (1e-2, 1e-5)
"""Steps at the most; a step is the last that gains less than this, and than this share of the cost."""
HALVINGS = 8
LONGEST = 2.0
"""Step of a logarithm, at the most: a straight line says nothing of a stiffness a hundred times as large."""
SUDDEN = 0.2
"""Share of the load that comes up within a sample."""


@dataclass(frozen=True, eq=False)
class Fitted:
    """A model at its most probable.

    Parameters
    ----------
    blocks : Blocks
    shared : (p,) float
    own : tuple of (q,) float
    covariance : (p, p) float
        Of the shared unknowns, own ones integrated over.
    cost : float
        Squares of the whitened residuals and of what is known beforehand.
    log_evidence : float
        But for what all models of the same logs and noise share.
    simulated : tuple of (n,) float [N]
    tops : tuple of (k,) float [N]
    """

    blocks: Blocks
    shared: Array
    own: tuple[Array, ...]
    covariance: Array
    cost: float
    log_evidence: float
    simulated: tuple[Array, ...]
    tops: tuple[Array, ...]

    @property
    def values(self) -> dict[str, float]:
        return self.blocks.values(self.shared)

    def left(self, index: int) -> Array:
        """Measured less simulated [N]."""
        result: Array = self.blocks.logs[index].force - self.simulated[index]
        return result

    def stds(self) -> dict[str, float]:
        """Standard deviations of the numbers by their keys."""
        base = self.values
        slopes = {name: np.zeros(len(self.shared)) for name in base}
        for k in range(len(self.shared)):
            moved = self.shared.copy()
            moved[k] += 1e-5
            other = self.blocks.values(moved)
            for name in base:
                slopes[name][k] = (other[name] - base[name]) / 1e-5
        return {name: math.sqrt(max(float(s @ self.covariance @ s), 0.0)) for name, s in slopes.items()}


def fitted(
    blocks: Blocks,
    noise: Sequence[float],
    start: tuple[Array, Sequence[Array]] | None = None,
    held: bool = False,
) -> Fitted:
    """The most probable unknowns.

    Parameters
    ----------
    blocks : Blocks
    noise : sequence of float [N]
        Standard deviation of a sample of each log.
    start : (shared, own), optional
    held : bool
        Shared unknowns stay where they start.
    """
    shared = np.array([u.mean for u in blocks.shared]) if start is None else np.array(start[0], dtype=float)
    own = [blocks.own_start(k) for k in range(len(blocks.logs))] if start is None else [o.copy() for o in start[1]]
    now = _cost(blocks, noise, shared, own)
    system = None
    for _ in range(ROUNDS):
        system = [_linear(blocks, noise, k, shared, own[k], held) for k in range(len(own))]
        step, own_steps, _ = _solved(blocks, system, shared, held)
        furthest = max((abs(s) for s, u in zip(step, blocks.shared, strict=True) if u.logarithmic), default=0.0)
        size = min(1.0, LONGEST / max(furthest, LONGEST))
        for _ in range(HALVINGS):
            trial = shared + size * step, [o + size * s for o, s in zip(own, own_steps, strict=True)]
            cost = _cost(blocks, noise, *trial)
            if cost < now:
                break
            size *= 0.4
        else:
            break
        gained, now = now - cost, cost
        shared, own = trial[0], trial[1]
        if gained < SETTLED[0] + SETTLED[1] * now:
            break
    system = [_linear(blocks, noise, k, shared, own[k], held) for k in range(len(own))]
    _, _, (covariance, log_det) = _solved(blocks, system, shared, held)
    runs = [blocks.simulated(k, blocks.values(shared), o) for k, o in enumerate(own)]
    widths = 0.0 if held else sum(math.log(u.std) for u in blocks.shared)
    evidence = -0.5 * now - widths - 0.5 * log_det
    return Fitted(
        blocks, shared, tuple(own), covariance, now, evidence, tuple(r[0] for r in runs), tuple(r[1] for r in runs)
    )


def with_scatter(found: Fitted, noise: Sequence[float]) -> Fitted:
    """The same with the scatter that the forces of letting go really have, where there are enough of them."""
    values, blocks = found.values, found.blocks
    away = [
        (tops - blocks.static_at(k, values, own)[: len(tops)])[1:]
        for k, (tops, own) in enumerate(zip(found.tops, found.own, strict=True))
    ]
    count, mean = sum(len(a) for a in away), values[STATIC] * blocks.weight
    if count < 3:
        return found
    root = math.sqrt(sum(float(a @ a) for a in away) / count)
    spread = float(np.clip(root, 2e-3 * mean, 0.5 * mean))
    return fitted(replace(found.blocks, spread=spread), noise, (found.shared, found.own))


def _residuals(blocks: Blocks, noise: Sequence[float], index: int, shared: Array, own: Array) -> Array:
    """Whitened: samples, forces of letting go, and own unknowns by what is known of them."""
    values = blocks.values(shared)
    force, tops = blocks.simulated(index, values, own)
    mean, std = blocks.own_prior(index)
    known = (own - mean) / std
    away = tops - blocks.static_at(index, values, own)[: len(tops)]
    known[blocks.let_go(index)][: len(tops)] = away / blocks.spread
    log = blocks.logs[index]
    sudden = log.rise * log.step > SUDDEN * log.load  # else the rise itself is in the log
    left = (log.force - force) / noise[index]
    return np.concatenate([left * log.counts if sudden else left, known])


def _cost(blocks: Blocks, noise: Sequence[float], shared: Array, own: Sequence[Array]) -> float:
    values = blocks.values(shared)
    if not all(math.isfinite(v) for v in values.values()) or values[STATIC] <= 0.0 or values[KINETIC] <= 0.0:
        return math.inf
    if any(np.any(np.diff(o[blocks.let_go(k)]) <= 0.0) for k, o in enumerate(own)):
        return math.inf
    total = sum(float(((s - u.mean) / u.std) ** 2) for s, u in zip(shared, blocks.shared, strict=True))
    for k, one in enumerate(own):
        r = _residuals(blocks, noise, k, shared, one)
        total += float(r @ r)
    return total if math.isfinite(total) else math.inf


def _linear(
    blocks: Blocks, noise: Sequence[float], index: int, shared: Array, own: Array, held: bool
) -> tuple[Array, Array, Array]:
    """Residuals and their slopes over shared and own unknowns."""
    base = _residuals(blocks, noise, index, shared, own)
    over_shared = np.zeros((len(base), len(shared)))
    for k in range(0 if held else len(shared)):
        moved = shared.copy()
        moved[k] += 1e-4 * blocks.shared[k].std if blocks.shared[k].std < 1.0 else 1e-4
        over_shared[:, k] = (_residuals(blocks, noise, index, moved, own) - base) / (moved[k] - shared[k])
    over_own = np.empty((len(base), len(own)))
    sizes = _sizes(blocks, index, own)
    for k in range(len(own)):
        moved = own.copy()
        moved[k] += sizes[k]
        over_own[:, k] = (_residuals(blocks, noise, index, shared, moved) - base) / sizes[k]
    return base, over_shared, over_own


def _sizes(blocks: Blocks, index: int, own: Array) -> Array:
    """Steps of the differences."""
    log = blocks.logs[index]
    sizes = np.full(len(own), 0.02 * log.step)
    sizes[1] = 1e-3 * log.load
    if blocks.shape.changes:
        sizes[-KNOTS:] = 1e-3 * log.load
    return sizes


def _solved(
    blocks: Blocks, system: Sequence[tuple[Array, Array, Array]], shared: Array, held: bool
) -> tuple[Array, list[Array], tuple[Array, float]]:
    """Step of the shared and of the own unknowns; covariance of the shared ones, and the log determinant of all over
    that of what is known of the own ones beforehand, whose slopes are the last rows."""
    precision = np.diag([1.0 / u.std**2 for u in blocks.shared])
    pulled = -np.array([(s - u.mean) / u.std**2 for s, u in zip(shared, blocks.shared, strict=True)])
    log_det, parts = 0.0, []
    for base, over_shared, over_own in system:
        scale = np.maximum(np.linalg.norm(over_own, axis=0), 1e-300)
        own = over_own / scale
        least = 1e-12 * np.eye(own.shape[1])  # of an own unknown that nothing moves, before as after
        inner = own.T @ own + least
        known = own[len(own) - own.shape[1] :]
        cross, down = own.T @ over_shared, own.T @ base
        back = np.linalg.solve(inner, np.column_stack([cross, down]))
        precision = precision + over_shared.T @ over_shared - cross.T @ back[:, :-1]
        pulled = pulled - over_shared.T @ base + cross.T @ back[:, -1]
        log_det += float(np.linalg.slogdet(inner)[1] - np.linalg.slogdet(known.T @ known + least)[1])
        parts.append((back, scale))
    covariance = np.linalg.inv(precision)
    step = np.zeros(len(shared)) if held else covariance @ pulled
    if not held:
        log_det += float(np.linalg.slogdet(precision)[1])
    own_steps = [-(back[:, -1] + back[:, :-1] @ step) / scale for back, scale in parts]
    return step, own_steps, (covariance, log_det)


RATIOS, FALLS = (0.02, 0.2), (0.02, 1.0)
"""Damping ratios of the drive, and speeds over the pulls' in which friction falls, from which a search begins."""


LOST = 4.0
"""Mean square of what a model leaves, in sizes of noise, from which it has lost its way and tells nothing."""


def begun(blocks: Blocks, noise: Sequence[float], like: Fitted | None = None) -> Fitted:
    """The best of fits from several starts: what a poorer model has found, and what is known beforehand where that does
    not follow the logs."""
    if like is None or like.cost < LOST * sum(len(log.force) for log in like.blocks.logs):
        return _begun(blocks, noise, like)
    return min(_begun(blocks, noise, like), _begun(blocks, noise, None), key=lambda f: f.cost)


def _begun(blocks: Blocks, noise: Sequence[float], like: Fitted | None) -> Fitted:
    """The best from drives that ring and that do not, and blocks let go where the force falls most or half a swing
    before, as they are where inertia carries the force on."""
    starts = []
    known = dict(zip((u.name for u in like.blocks.shared), like.shared, strict=True)) if like is not None else {}
    fall = height(blocks.logs, blocks.moments, blocks.mass) / (2.0 * blocks.weight)
    ratios, falling = (RATIOS if blocks.shape.stretches else (0.0,)), (FALLS if blocks.shape.smoothly else (0.0,))
    for ratio, over in itertools.product(ratios, falling):
        shared = np.array([known.get(u.name, u.mean) for u in blocks.shared])
        for k, u in enumerate(blocks.shared):
            if u.name == "ratio":
                shared[k] = math.log(ratio)
            elif u.name == FALLING:
                shared[k] = u.mean + math.log(over)
            elif u.name == "fall" and u.mean == 0.0:
                shared[k] = fall
            elif u.name == KINETIC and blocks.shape.changes:
                shared[k] = u.mean  # the level is begun about it
        starts.append(shared)
    found = []
    for shared in starts:
        values = blocks.values(shared)
        half = 0.5 * math.pi * math.sqrt(blocks.mass / values[STIFFNESS]) if blocks.shape.falls else 0.0
        for earlier in (0.0, half) if half else (0.0,):
            own = [blocks.own_start(k) for k in range(len(blocks.logs))]
            for k, o in enumerate(own):
                if like is not None and like.blocks.shape.stretches == blocks.shape.stretches:
                    o[:2] = like.own[k][:2]
                o[blocks.let_go(k)] -= earlier
            found.append(fitted(blocks, noise, (shared, own)))
    return min(found, key=lambda f: f.cost)


def height(logs: Sequence[PulledLog], all_moments: Sequence[Array], mass: float) -> float:
    """What the force falls by where a block is let go, about [N]: what the drive loads between two teeth, but for the
    half period in which it slides; without teeth, the first peak over what comes after it."""
    falls = []
    for log, moments in zip(logs, all_moments, strict=True):
        if len(moments) > 2:
            slides = math.pi * math.sqrt(mass * log.speed / log.rise)
            falls.append(log.rise * max(float(np.median(np.diff(moments))) - slides, 2.0 * log.step))
        else:
            width = max(1, len(log.force) // 500)
            at = round(float(moments[0]) / log.step)
            peak = float(np.mean(log.force[max(at - width, 0) : at + width + 1]))
            falls.append(max(peak - float(np.median(log.force[at:])), 0.02 * log.load))
    return float(np.median(falls))
