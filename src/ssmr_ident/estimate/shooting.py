"""Multiple shooting: from far away, stretch by stretch."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np

from ssmr_ident.estimate.exact import solved_evenly
from ssmr_ident.estimate.node import Node
from ssmr_ident.estimate.scales import bounded, priors, state_sizes, zero_scales
from ssmr_ident.estimate.shoot_kernel import eliminate
from ssmr_ident.estimate.simulated import Compiled, simulate
from ssmr_ident.estimate.values import Problem, Start

Array = np.ndarray

CONTINUITY = (0.3, 0.1, 0.03, 0.01, 1e-3, 1e-4)
"""Standard deviations of the jumps between stretches, in the size of the motion: from loose to as good as exact."""

LOOSE_STEPS, LAST_STEPS = 6, 12
CLOSE = 0.02
"""Share of the motion below which noise is not believed while stretches are joined."""


def shot(
    problem: Problem, node: Node, start: Start, continuity: Sequence[float] = CONTINUITY, held: bool = False
) -> Start:
    """Multiple shooting from paths: stretches of a period, whose borders are joined from loose to as good as exact.

    Parameters
    ----------
    problem : Problem
    node : Node
    start : Start
        With paths, (n, 3) per piece; on a network (n, states), coordinates of the bodies before their rates.
    continuity : sequence of float
    held : bool
        Whether the point stays, and states and zeros alone are found.

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
        own[:, : node.motion_states] = path[edge[:-1], : node.motion_states]
        borders.append(edge)
        states.append(own)
        local.append(np.zeros(int(piece.driven) + piece.y.shape[1]))
        weights.append(1.0 / np.maximum(np.array([noise.std for noise in problem.noises[len(borders) - 1]]),
                                        CLOSE * piece.y.std(axis=0)))  # fmt: skip
    local_scales = [np.concatenate(zero_scales(piece)) for piece in pieces]
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
                trial = _joined(current, point, states, local, mean, precision, weight, sizes, damping, held)
                if trial is None:
                    break
                moved = bounded(node, trial[0])
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
        own[0, n:] *= 0.0 if piece.driven and piece.time[0] <= piece.begin else 1.0
    nuisances = []
    for piece, own, extra in zip(pieces, states, local, strict=True):
        driven = int(piece.driven)
        drifts = np.zeros(piece.y.shape[1])
        nuisances.append(np.concatenate([own[0], extra[:driven], np.zeros(driven), extra[driven:], drifts]))
    return Start(point, tuple(nuisances))


@np.errstate(over="ignore", invalid="ignore")  # what is not finite is refused
def _shooting(problem, node, point, states, local, borders, weights, weight, local_scales, mean, precision):
    """Cost of stretches and defects, and what their elimination takes."""
    model = Compiled.of(problem, node, point, problem.pieces)
    cost = float(np.sum(precision * (point - mean) ** 2))
    systems = []
    zeros = [float(own[0]) if piece.driven else 0.0 for piece, own in zip(problem.pieces, local, strict=True)]
    for index, (piece, s) in enumerate(zip(problem.pieces, simulate(model, states, borders, zeros), strict=True)):
        driven, c = int(piece.driven), piece.y.shape[1]
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
        if not (np.isfinite(normal).all() and np.isfinite(f).all()):
            return math.inf, ()
        gap = np.vstack([defect, np.zeros((1, k))])
        systems.append((normal[:, :-1, :-1].copy(), normal[:, :-1, -1].copy(), f, gap, driven + c, local_scales[index]))
    return cost, systems


@np.errstate(over="ignore", invalid="ignore")
def _joined(current, point, states, local, mean, precision, weight, sizes, damping, held):
    """One Gauss-Newton step of everything: parameters, nuisances, states at the borders; None where slopes have grown
    beyond all numbers, or a state's has no digits left beside another's."""
    p, kept = len(point), []
    left, right = np.diag(precision + 1e-12), -precision * (point - mean)
    for index, (h, g, f, gap, _, scale) in enumerate(current[1]):
        k = states[index].shape[1]
        soft = damping * np.diagonal(h[:, :k, :k], axis1=1, axis2=2).mean(axis=0) + 1e-6 / sizes**2
        try:
            a, b, gain, by_par, base = eliminate(h, g, f, gap, weight, k, soft)
        except np.linalg.LinAlgError:
            return None
        own = a[p:, p:] + np.diag(1.0 / scale**2)
        line = b[p:] + local[index] / scale**2
        solved = np.linalg.solve(own, np.column_stack([a[p:, :p], line]))
        left = left + a[:p, :p] - a[:p, p:] @ solved[:, :-1]
        right = right - b[:p] + a[:p, p:] @ solved[:, -1]
        kept.append((gain, by_par, base, solved))
    whole = left + damping * np.diag(np.maximum(np.diag(left), 1e-12))
    if not (np.isfinite(whole).all() and np.isfinite(right).all()):
        return None
    step = np.zeros(p) if held else solved_evenly(whole, right)
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
