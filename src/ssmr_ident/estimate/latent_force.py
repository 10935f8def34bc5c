"""Paths of a network by a Kalman smoother whose bodies are pushed by forces that nobody measured.

The linear network as it is known, with a first-order Gauss-Markov force on every body (Rogers and Friis 2022) for what
is not known of it. It begins fits and sees no decision.
"""

from __future__ import annotations

import math

import numpy as np
from scipy.linalg import expm

from ssmr_ident.core.kernel import kernel
from ssmr_ident.estimate.node import Node, matrices
from ssmr_ident.estimate.pieces import Piece
from ssmr_ident.estimate.values import Problem

Array = np.ndarray

PUSH = 1.0
"""Standard deviation of a latent force, in the force that moves its body."""


def network_paths(problem: Problem, node: Node, point: Array) -> list[Array]:
    """(n, 2·bodies) float per piece: coordinates of the bodies, then their rates, at the samples.

    Parameters
    ----------
    problem : Problem
    node : Node
        Of which the baseline counts alone.
    point : (k,) float
        Its coordinates begin with those of the baseline.
    """
    bare = Node(node.baseline, layout=node.layout)
    values = bare.values(point[: len(node.baseline)])
    return [_path(problem, bare, values, piece) for piece in problem.pieces]


def _path(problem: Problem, node: Node, values: Array, piece: Piece) -> Array:
    bodies = len(node.layout.bodies)
    a, drive, _, rows, by_drive, _ = matrices(node, values, piece.seen)
    n, turning, step = 3 * bodies, 2.0 * math.pi * problem.frequency, piece.step * piece.every
    mass = values[:bodies]
    spread = PUSH * mass * problem.size * turning**2
    whole, added = np.zeros((n, n)), np.zeros(n)
    whole[: 2 * bodies, : 2 * bodies] = a
    whole[bodies : 2 * bodies, 2 * bodies :] = np.diag(1.0 / mass)
    whole[2 * bodies :, 2 * bodies :] = -turning * np.eye(bodies)
    added[: 2 * bodies] = drive
    seen = np.zeros((len(rows), n))
    seen[:, : 2 * bodies] = rows
    for c, (order, body) in enumerate(zip(piece.seen.orders, piece.seen.bodies, strict=True)):
        seen[c, 2 * bodies + body] = 1.0 / mass[body] if order == 2 else 0.0
    random = np.zeros((n, n))
    random[2 * bodies :, 2 * bodies :] = np.diag(2.0 * turning * spread**2)
    loan = np.zeros((2 * n, 2 * n))  # Van Loan (1978)
    loan[:n, :n], loan[:n, n:], loan[n:, n:] = -whole, random, whole.T
    e = expm(loan * step)
    transition = np.ascontiguousarray(e[n:, n:].T)
    noise = transition @ e[:n, n:]
    lines = np.zeros((n + 2, n + 2))
    lines[:n, :n], lines[:n, n], lines[n, n + 1] = whole * step, added * step, 1.0
    e = expm(lines)
    force = piece.drive[:: piece.every] if piece.driven else np.zeros(len(piece.y) + 1)
    force = force[np.minimum(np.arange(len(piece.y) + 1), len(force) - 1)]
    later = e[:n, n + 1]
    moved = np.outer(force[:-1], e[:n, n] - later) + np.outer(force[1:], later)
    y = piece.y - piece.y.mean(axis=0) - np.outer(force[: len(piece.y)], by_drive)
    white = np.maximum(piece.white, 1e-3 * piece.y.std(axis=0))
    variance = np.where(piece.counts, white**2, 1e6 * piece.y.var(axis=0))
    begin = np.concatenate([np.full(bodies, 10.0 * problem.size), np.full(bodies, 10.0 * problem.speed), spread]) ** 2
    means = _smooth(y, np.ascontiguousarray(seen), variance, transition, moved, 0.5 * (noise + noise.T), begin)
    return np.ascontiguousarray(means[:, : 2 * bodies])


@kernel
def _smooth(y, rows, variance, transition, moved, noise, begin):
    count, n = len(y), len(begin)
    means, covs = np.zeros((count, n)), np.zeros((count, n, n))
    ahead, ahead_cov = np.zeros((count, n)), np.zeros((count, n, n))
    m, p = np.zeros(n), np.diag(begin)
    for t in range(count):
        if t:
            m = transition @ m + moved[t - 1]
            p = transition @ p @ transition.T + noise
        ahead[t], ahead_cov[t] = m, p
        for c in range(len(rows)):
            across = p @ rows[c]
            gain = across / (rows[c] @ across + variance[t, c])
            m = m + gain * (y[t, c] - rows[c] @ m)
            p = p - np.outer(gain, across)
            p = 0.5 * (p + p.T)
        means[t], covs[t] = m, p
    for t in range(count - 2, -1, -1):
        # states of another size each: pseudo-inverse in their own units
        size = np.sqrt(np.diag(ahead_cov[t + 1]))
        even = ahead_cov[t + 1] / np.outer(size, size) + 1e-12 * np.eye(n)
        back = np.linalg.solve(even, (transition @ covs[t]) / size.reshape((n, 1))) / size.reshape((n, 1))
        means[t] = means[t] + back.T @ (means[t + 1] - ahead[t + 1])
    return means
