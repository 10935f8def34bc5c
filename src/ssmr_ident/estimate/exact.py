"""Levenberg-Marquardt on the exact simulation, nuisances eliminated piece by piece."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence

import numpy as np

from ssmr_ident.estimate.node import Node
from ssmr_ident.estimate.regression import starts_of
from ssmr_ident.estimate.scales import bounded, nuisance_count, nuisance_scales, priors
from ssmr_ident.estimate.simulated import Compiled, batches, simulate_whole
from ssmr_ident.estimate.values import Fit, Problem, Start, Stop

Array = np.ndarray


LEAST_CURVATURE = 1e-12
"""That every coordinate has, in its own units: of what the data do not see, round-off alone is left."""

BURST = 1e300
"""Sum of squares, or of slopes, from which a simulation has burst: sums of them would overflow."""

DAMPED = 1e-3
"""Share of the curvature by which a step is damped at first."""

TRIES = 6
"""Of a step, each four times as damped."""

REACH = 3.0
"""Of a logarithm in one step: what wants to go beyond a factor of twenty is hardly seen by the data, and stays where it
would keep all else from moving."""

LEAST_GAIN, LEAST_SHARE = 0.02, 5e-6
"""Of the cost, a step that lowers it by less than their sum is the last: a hundredth of what a decision looks at."""


@np.errstate(over="ignore", invalid="ignore")  # a cost that is not finite is refused
def _exact(problem: Problem, node: Node, point: Array, local: Array) -> tuple[float, list[Array], Array]:
    """Exact simulation: chi2, residuals (n, c) per piece, and per piece the normal equations.

    ``local`` : (pieces, k) float, nuisances, with room behind those of pieces that have fewer. The normal equations are
    (pieces, k + p + 1, k + p + 1) float: nuisances, coordinates, residual.
    """
    residuals: list[Array] = []
    spread = 0.0
    normal = np.empty((len(local), *[local.shape[1] + len(point) + 1] * 2))
    for k, (white, rest, jumps) in enumerate(whitened_columns(problem, node, point, local)):
        flat = white.reshape(-1, white.shape[2])
        np.matmul(flat.T, flat, out=normal[k])
        if not (np.abs(normal[k]) < BURST).all():
            return math.inf, [], normal
        residuals.append(rest)
        spread += jumps
    return float(normal[:, -1, -1].sum()) + spread, residuals, normal


def whitened_columns(problem: Problem, node: Node, point: Array, local: Array) -> Iterator[tuple[Array, Array, float]]:
    """Of each piece (m, c, k + p + 1) float, whitened slopes over nuisances and coordinates and what the piece leaves;
    (n, c) float, that before; and the logarithm that the likelihood has of samples within a force's jump."""
    model = Compiled.of(problem, node, point, problem.pieces)
    for batch in batches(problem.pieces):
        whole, unsure = _linearised(model, batch, local)
        row = 0
        for k in batch:
            columns, off = (x[row : row + len(problem.pieces[k].y)] for x in (whole, unsure))
            row += len(columns)
            passed = problem.passed_over(problem.pieces[k])
            within = (off / [noise.std for noise in problem.noises[k]]) ** 2
            columns /= np.sqrt(1.0 + within)[..., None]
            columns[:passed] = 0.0
            rest = columns[..., -1].copy()
            yield _whitened(problem, k, columns), rest, float(np.log1p(within[passed:]).sum())


def _linearised(model: Compiled, batch: range, local: Array) -> tuple[Array, Array]:
    """(n, c, columns) float: slopes of what pieces leave over nuisances and coordinates, and what they leave; (n, c)
    float: how far channels may be off where forces jump."""
    pieces, n, room = model.pieces[batch.start : batch.stop], model.node.states, local.shape[1]
    s = simulate_whole(model, batch, local)
    c, k = s.y.shape[1], nuisance_count(model.node, pieces[0])
    counts = [len(p.y) for p in pieces]
    own = np.repeat(local[batch.start : batch.stop, :k], counts, axis=0)
    course = np.concatenate([np.linspace(-1.0, 1.0, count) for count in counts])[:, None]
    gain = 1.0 + own[:, n + 1, None] if pieces[0].driven else np.ones((len(own), 1))
    whole = np.zeros((*s.y.shape, room + len(model.values) + 1))
    np.multiply(s.dy[..., :n], gain[..., None], out=whole[..., :n])
    np.multiply(s.dy[..., n:-1], gain[..., None], out=whole[..., room:-1])
    if pieces[0].driven:
        np.multiply(s.dy[..., -1], gain, out=whole[..., n])
        whole[..., n + 1] = s.y
    for channel in range(c):
        whole[:, channel, k - 2 * c + channel] = 1.0
        whole[:, channel, k - c + channel] = course[:, 0]
    measured = np.concatenate([p.y for p in pieces])
    whole[..., -1] = gain * s.y + own[:, k - 2 * c : k - c] + course * own[:, k - c :] - measured
    return whole, s.unsure


def _whitened(problem: Problem, index: int, columns: Array) -> Array:
    """(n, c, …) to (m, c, …): what counts, through each channel's whitening filter, in its standard deviation."""
    piece = problem.pieces[index]
    out = piece.counted(columns, problem.passed_over(piece))
    filtered = [noise.filtered(out[:, c]) for c, noise in enumerate(problem.noises[index])]
    return filtered[0][:, None] if len(filtered) == 1 else np.stack(filtered, axis=1)


def polish(problem: Problem, node: Node, start: Start, steps: int = 30, freeze: Sequence[int] = ()) -> Fit:
    """Levenberg-Marquardt on the exact simulation, nuisances eliminated piece by piece.

    Parameters
    ----------
    problem : Problem
    node : Node
    start : Start
    steps : int
        At the most.
    freeze : sequence of int
        Coordinates that stay.
    """
    point = bounded(node, start.point)
    begun = start.nuisances if start.nuisances is not None else starts_of(problem, node, start)
    counts = [len(own) for own in begun]
    local, scales = side_by_side(problem, node, begun)
    mean, precision = priors(node)
    free = np.ones(len(point), dtype=bool)
    free[list(freeze)] = False

    def total(chi2: float, at: Array, own: Array) -> float:
        return chi2 + float(np.sum(precision * (at - mean) ** 2)) + float(np.sum((own / scales) ** 2))

    chi2, residuals, normal = _exact(problem, node, point, local)
    cost = total(chi2, point, local)
    if not math.isfinite(cost):
        return _failed(problem, node, point, tuple(begun))
    far = np.array([REACH if c.log else math.inf for c in node.coordinates])
    damping, gain, promised, stop, step = DAMPED, 0.0, math.inf, Stop.STEPS, np.zeros(len(point))

    def lowered(moving: Array, enough: float) -> bool:
        """Whether a step of what may move lowers the cost, which it is then taken by."""
        nonlocal point, local, chi2, residuals, normal, cost, damping, gain, promised, step
        for _ in range(TRIES):
            step, moves, promised = _step(normal, point, local, mean, precision, scales, damping, moving)
            if promised < enough:  # not worth another simulation
                return False
            new_point, new = bounded(node, point + step), local + moves
            trial = _exact(problem, node, new_point, new)
            lower = total(trial[0], new_point, new)
            if lower < cost:
                gain, cost = cost - lower, lower
                point, local, (chi2, residuals, normal) = new_point, new, trial
                return True
            damping = max(damping * 4.0, 1e-4)
        return False

    for _ in range(steps):
        enough = LEAST_GAIN + LEAST_SHARE * cost
        if not lowered(free, enough):
            near, damping = free & (np.abs(step) < far), DAMPED
            if (near == free).all() or not lowered(near, enough):
                stop = Stop.CONVERGED
                break
        damping *= damped_next(gain / promised)
        if gain < enough:
            stop = Stop.CONVERGED
            break
    step, moves, further = _step(normal, point, local, mean, precision, scales, 0.0, free)
    further = max(gain, further) if stop is Stop.STEPS else further
    ahead = Start(bounded(node, point + step), _each(local + moves, counts))
    covariance, dof = _decided(node, normal, precision, scales, free)
    prior = float(np.sum(precision * (point - mean) ** 2))
    nuisances = _each(local, counts)
    left = float(normal[:, -1, -1].sum())
    return Fit(node, point, nuisances, covariance, tuple(residuals), chi2, prior, dof, stop, further, ahead, left)


def side_by_side(problem: Problem, node: Node, begun: Sequence[Array]) -> tuple[Array, Array]:
    """(pieces, k) float: every piece's own nuisances, zeros behind those of pieces that have fewer; and their sizes."""
    counts = [len(own) for own in begun]
    local, scales = np.zeros((len(begun), max(counts))), np.ones((len(begun), max(counts)))
    for k, (piece, own) in enumerate(zip(problem.pieces, begun, strict=True)):
        local[k, : counts[k]], scales[k, : counts[k]] = own, nuisance_scales(problem, node, piece)
    return local, scales


def _each(local: Array, counts: Sequence[int]) -> tuple[Array, ...]:
    """Every piece's own nuisances."""
    return tuple(own[:count].copy() for own, count in zip(local, counts, strict=True))


def damped_next(ratio: float) -> float:
    """Factor on the damping after a step that gained ``ratio`` times what a straight line promised: Nielsen's (1999),
    which lets go where the line holds and stays where it does not, lest every second step be in vain."""
    return max(0.2, 1.0 - (2.0 * min(ratio, 1.0) - 1.0) ** 3)


def _step(
    normal: Array, point: Array, local: Array, mean: Array, precision: Array, scales: Array, damping: float, free: Array
) -> tuple[Array, Array, float]:
    """Moves of point and nuisances, and by how much the cost falls where all is linear."""
    k = local.shape[1]
    cross, line = normal[:, :k, k:-1], normal[:, :k, -1] + local / scales**2
    own = curvature_of_nuisances(normal, scales, damping)
    solved = solved_positive(own, np.concatenate([cross, line[..., None]], axis=2))
    eliminated, last = solved[..., :-1], solved[..., -1]
    left = np.diag(precision + LEAST_CURVATURE) + _reduced(normal, cross, eliminated)
    right = -precision * (point - mean) - normal[:, k:-1, -1].sum(axis=0) + np.einsum("skp,sk->p", cross, last)
    _on_diagonal(left)[:] += damping * np.maximum(_on_diagonal(left), 1e-12)
    step = np.zeros(len(point))
    step[free] = solved_evenly(left[np.ix_(free, free)], right[free])
    return step, -(eliminated @ step) - last, float(np.sum(line * last)) + float(right @ step)


def _reduced(normal: Array, cross: Array, eliminated: Array) -> Array:
    """Curvature of the coordinates with every piece's nuisances at their best."""
    k = cross.shape[1]
    return np.asarray(normal[:, k:-1, k:-1].sum(axis=0) - np.tensordot(cross, eliminated, axes=([0, 1], [0, 1])))


def _on_diagonal(square: Array) -> Array:
    """Its diagonal, or those of several, to be written to."""
    return np.einsum("...ii->...i", square)


def curvature_of_nuisances(normal: Array, scales: Array, damping: float) -> Array:
    """Curvature of the pieces' nuisances with their priors."""
    k = scales.shape[1]
    own = normal[:, :k, :k].copy()
    diagonal = _on_diagonal(own)
    diagonal += 1.0 / scales**2
    diagonal *= 1.0 + damping
    return own


def solved_evenly(left: Array, right: Array) -> Array:
    """Symmetric equations, rows and columns first brought to one size."""
    size = np.sqrt(np.maximum(np.diag(left), LEAST_CURVATURE))
    return np.linalg.lstsq(left / np.outer(size, size), right / size, rcond=1e-13)[0] / size


def solved_positive(left: Array, columns: Array) -> Array:
    """Positive definite equations, rows and columns first brought to one size; what round-off alone decides stays."""
    size = np.sqrt(_on_diagonal(left))[..., None]
    even = left / (size * np.swapaxes(size, -1, -2))
    _on_diagonal(even)[...] += LEAST_CURVATURE
    return np.asarray(np.linalg.solve(even, columns / size) / size)


def _decided(node: Node, normal: Array, precision: Array, scales: Array, free: Array) -> tuple[Array, float]:
    """Covariance of the coordinates, and how many of them the data decide."""
    k = scales.shape[1]
    cross = normal[:, :k, k:-1]
    information = _reduced(normal, cross, solved_positive(curvature_of_nuisances(normal, scales, 0.0), cross))
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
    return covariance, dof


def _failed(problem: Problem, node: Node, point: Array, nuisances: Sequence[Array]) -> Fit:
    rest = tuple(np.full(p.y.shape, math.nan) for p in problem.pieces)
    return Fit(node, point, tuple(nuisances), np.zeros((len(point),) * 2), rest, math.inf, 0.0, 0.0, Stop.LOST)
