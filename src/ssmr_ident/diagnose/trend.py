"""Whether values with errors rise or fall along an axis: bins, scatter beyond the errors, and chance."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

Array = np.ndarray

BINS, PER_BIN = 8, 3
PERMUTATIONS = 1999


def shapes(position: Array) -> list[Array]:
    """What a drift may look like along an axis: straight, and where it has no sign as A², ln A and 1/A."""
    if np.all(position > 0.0) and len(np.unique(position)) > 2:
        return [position, position**2, np.log(position), 1.0 / position]
    return [position]


def bins(position: Array) -> Array:
    """Bin of every part: its own level where there are few, else bins of equal number."""
    levels = np.unique(position)
    if len(levels) <= BINS // 2:
        return np.searchsorted(levels, position)
    bins = min(BINS, max(2, len(position) // PER_BIN))
    return np.argsort(np.argsort(position, kind="stable"), kind="stable") * bins // len(position)


def scatter(moves: Array, stds: Array) -> float:
    """Variance between parts beyond their own (DerSimonian and Laird 1986): a straight line's error, mostly."""
    weight = stds**-2.0
    mean = np.average(moves, weights=weight)
    excess = float(weight @ (moves - mean) ** 2) - (len(moves) - 1)
    return max(excess, 0.0) / float(weight.sum() - (weight @ weight) / weight.sum())


def chance(position: Array, moves: Array, weight: Array, rng: np.random.Generator) -> float:
    """p-value of the shape that a drift follows best, by exchanging the parts' moves (with their weights)."""
    candidates = shapes(position)
    found = _explained(candidates, moves[None], weight[None])[0]
    orders = np.stack([rng.permutation(len(moves)) for _ in range(PERMUTATIONS)])
    beaten = int(np.sum(_explained(candidates, moves[orders], weight[orders]) >= found))
    return (beaten + 1) / (PERMUTATIONS + 1)


def _explained(shapes: Sequence[Array], moves: Array, weight: Array) -> Array:
    """Fall of the weighted sum of squares by the best of the shapes beside a constant; rows of (r, n), (r,)."""
    total = weight.sum(axis=1, keepdims=True)
    moves = moves - np.sum(weight * moves, axis=1, keepdims=True) / total
    falls = []
    for shape in shapes:
        x = shape - np.sum(weight * shape, axis=1, keepdims=True) / total
        falls.append(np.sum(weight * x * moves, axis=1) ** 2 / np.sum(weight * x**2, axis=1))
    return np.max(falls, axis=0)
