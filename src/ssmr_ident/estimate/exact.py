"""Levenberg-Marquardt on the exact simulation, nuisances eliminated piece by piece."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from ssmr_ident.estimate.node import Node
from ssmr_ident.estimate.regression import starts_of
from ssmr_ident.estimate.scales import bounded, nuisance_scales, priors
from ssmr_ident.estimate.simulated import Compiled, simulate
from ssmr_ident.estimate.values import Fit, Problem, Start, Stop

Array = np.ndarray


LEAST_CURVATURE = 1e-12
"""That every coordinate has, in its own units: of what the data do not see, round-off alone is left."""

LEAST_GAIN, LEAST_SHARE = 0.02, 5e-6
"""Of the cost, a step that lowers it by less than their sum is the last: a hundredth of what a decision looks at."""


def _whitened(problem: Problem, index: int, columns: Array) -> Array:
    """(n, c, …) to (m, c, …): what counts, through each channel's whitening filter, in its standard deviation."""
    piece = problem.pieces[index]
    out = piece.counted(columns, problem.passed_over(piece))
    filtered = [noise.filtered(out[:, c]) for c, noise in enumerate(problem.noises[index])]
    return np.stack(filtered, axis=1)


@np.errstate(over="ignore", invalid="ignore")  # a cost that is not finite is refused
def _exact(problem: Problem, node: Node, point: Array, nuisances: Sequence[Array]):
    """Normal equations by exact simulation: chi2, residuals, and per piece (J, r) over (nuisance, coordinates)."""
    model = Compiled.of(problem, node, point, problem.pieces)
    n = node.states
    chi2, residuals, parts = 0.0, [], []
    for index, (piece, nuisance) in enumerate(zip(problem.pieces, nuisances, strict=True)):
        start = nuisance[None, :n].copy()
        zero = float(nuisance[n]) if piece.driven else 0.0
        s = simulate(model, index, start, np.array([0, len(piece.y)]), zero)
        c, k, passed = piece.y.shape[1], len(nuisance), problem.passed_over(piece)
        gain = 1.0 + nuisance[n + 1] if piece.driven else 1.0
        course = np.linspace(-1.0, 1.0, len(piece.y))
        rest = gain * s.y + nuisance[-2 * c : -c] + course[:, None] * nuisance[-c:] - piece.y
        rest[:passed] = 0.0
        if not np.isfinite(rest).all():
            return math.inf, [], []
        whole = np.zeros((*piece.y.shape, k + len(point) + 1))  # nuisances, coordinates, residuals
        np.multiply(s.dy[..., :n], gain, out=whole[..., :n])
        if piece.driven:
            np.multiply(s.dy[..., -1], gain, out=whole[..., n])
            whole[..., n + 1] = s.y
        for channel in range(c):
            whole[:, channel, k - 2 * c + channel] = 1.0
            whole[:, channel, k - c + channel] = course
        np.multiply(s.dy[..., n:-1], gain, out=whole[..., k:-1])
        whole[..., -1] = rest
        whole[:passed] = 0.0
        white = _whitened(problem, index, whole).reshape(-1, whole.shape[2])
        normal = white.T @ white
        residuals.append(rest)
        if not np.isfinite(normal).all():
            return math.inf, [], []
        chi2 += float(normal[-1, -1])
        parts.append((normal[:-1, :-1], normal[:-1, -1], k))
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
    damping, gain, stop = 1e-3, 0.0, Stop.STEPS
    for _ in range(steps):
        lower_any, enough = False, LEAST_GAIN + LEAST_SHARE * cost
        for _ in range(6):
            solved = _step(parts, point, nuisances, mean, precision, scales, damping, held)
            if solved[2] < enough:  # not worth another simulation
                break
            new_point = bounded(node, point + solved[0])
            new = [v + d for v, d in zip(nuisances, solved[1], strict=True)]
            trial = _exact(problem, node, new_point, new)
            lower = total(trial[0], new_point, new)
            if lower < cost:
                lower_any = True
                break
            damping = max(damping * 4.0, 1e-4)
        if not lower_any:
            stop = Stop.CONVERGED
            break
        gain, cost = cost - lower, lower
        point, nuisances, (chi2, residuals, parts) = new_point, new, trial
        damping *= damped_next(gain / solved[2])
        if gain < enough:
            stop = Stop.CONVERGED
            break
    further = 0.0
    if stop is Stop.STEPS:
        further = max(gain, _step(parts, point, nuisances, mean, precision, scales, 0.0, held)[2])
    found = _finished(node, point, nuisances, mean, precision, scales, chi2, residuals, parts, stop, held)
    return replace(found, promised=further)


def damped_next(ratio: float) -> float:
    """Factor on the damping after a step that gained ``ratio`` times what a straight line promised: Nielsen's (1999),
    which lets go where the line holds and stays where it does not, lest every second step be in vain."""
    return max(0.2, 1.0 - (2.0 * min(ratio, 1.0) - 1.0) ** 3)


def _step(parts, point, nuisances, mean, precision, scales, damping, held):
    p = len(point)
    left = np.diag(precision + LEAST_CURVATURE)
    right = -precision * (point - mean)
    eliminated, promised = [], 0.0
    for (h, g, k), nuisance, scale in zip(parts, nuisances, scales, strict=True):
        cross, line = h[:k, k:], g[:k] + nuisance / scale**2
        solved = solved_positive(_own(h, k, scale, damping), np.column_stack([cross, line]))
        left = left + h[k:, k:] - cross.T @ solved[:, :-1]
        right = right - g[k:] + cross.T @ solved[:, -1]
        eliminated.append(solved)
        promised += float(line @ solved[:, -1])
    _on_diagonal(left)[:] += damping * np.maximum(_on_diagonal(left), 1e-12)
    step = np.zeros(p)
    if held.any():
        free = ~held
        step[free] = solved_evenly(left[np.ix_(free, free)], right[free])
    else:
        step = solved_evenly(left, right)
    promised += float(right @ step)
    return step, [-(solved[:, :-1] @ step) - solved[:, -1] for solved in eliminated], promised


def _on_diagonal(square: Array) -> Array:
    """Its diagonal, to be written to."""
    return np.einsum("ii->i", square)


def _own(h: Array, k: int, scale: Array, damping: float) -> Array:
    """Curvature of a piece's nuisances with their priors."""
    own = h[:k, :k].copy()
    diagonal = _on_diagonal(own)
    diagonal += 1.0 / scale**2
    diagonal *= 1.0 + damping
    return own


def solved_evenly(left: Array, right: Array) -> Array:
    """Symmetric equations, rows and columns first brought to one size."""
    size = np.sqrt(np.maximum(np.diag(left), LEAST_CURVATURE))
    return np.linalg.lstsq(left / np.outer(size, size), right / size, rcond=1e-13)[0] / size


def solved_positive(left: Array, columns: Array) -> Array:
    """Positive definite equations, rows and columns first brought to one size; what round-off alone decides stays."""
    size = np.sqrt(_on_diagonal(left))[:, None]
    even = left / (size * size.T)
    _on_diagonal(even)[:] += LEAST_CURVATURE
    return np.linalg.solve(even, columns / size) / size


def _finished(node, point, nuisances, mean, precision, scales, chi2, residuals, parts, stop, held) -> Fit:
    information = np.zeros((len(point), len(point)))
    for (h, _, k), scale in zip(parts, scales, strict=True):
        information += h[k:, k:] - h[:k, k:].T @ solved_positive(_own(h, k, scale, 0.0), h[:k, k:])
    free = ~held
    covariance = np.zeros_like(information)
    whole = (information + np.diag(precision + LEAST_CURVATURE))[np.ix_(free, free)]
    size = np.sqrt(np.maximum(np.diag(whole), LEAST_CURVATURE))
    covariance[np.ix_(free, free)] = np.linalg.pinv(whole / np.outer(size, size), rcond=1e-13, hermitian=True) / (
        np.outer(size, size)
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
