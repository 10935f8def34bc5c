"""The path of a rig by a Kalman smoother: position, velocity and acceleration from whatever was measured.

No rig is assumed; the acceleration is a first-order Gauss-Markov process (Singer 1970). It begins fits and sees no
decision.
"""

from __future__ import annotations

import math

import numpy as np
from scipy.linalg import expm

from ssmr_ident.core.kernel import kernel
from ssmr_ident.estimate.pieces import Piece

Array = np.ndarray

SWING = 3.0
"""How far a path may go, in the size that the motion has at its frequency: what keeps a doubly integrated
acceleration from drifting away."""
SPREAD = 2.0
"""Of its acceleration, in the same."""


def smoothed(piece: Piece, frequency: float, size: float) -> Array:
    """(n, 3) float: position, velocity, acceleration at the samples; of a driven base relative to it.

    Parameters
    ----------
    piece : Piece
    frequency : float [Hz]
        Of the motion.
    size : float [m]
        RMS deflection.
    """
    turning = 2.0 * math.pi * frequency
    units = size * turning ** np.arange(3.0)  # the motion's own, in which no step depends on how large it is
    angle = turning * piece.step * piece.every
    a = np.array([[0.0, 1.0, 0.0], [0.0, 0.0, 1.0], [0.0, 0.0, -1.0]])
    block = np.zeros((6, 6))
    block[:3, :3], block[:3, 3:], block[3:, 3:] = -a, np.diag([0.0, 0.0, 2.0 * SPREAD**2]), a.T
    e = expm(block * angle)
    transition = np.ascontiguousarray(e[3:, 3:].T)
    noise = transition @ e[:3, 3:]
    y = piece.y.copy()
    if piece.based:
        own = piece.drive[:: piece.every][: len(y)]
        y[:, piece.orders == 2] -= own[:, None]
    y /= units[piece.orders]
    size_of = piece.y.std(axis=0) / units[piece.orders]
    white = np.maximum(piece.white / units[piece.orders], 1e-3 * size_of)
    variance = np.where(piece.counts, white**2, 1e6 * np.maximum(size_of**2, white**2))
    free = 0 not in piece.orders
    swing = SWING**2 * max(1.0, piece.rate / turning) if free else math.inf
    begin = np.array([10.0, 10.0, SPREAD]) ** 2
    noise = 0.5 * (noise + noise.T)
    return units * _smooth(y, piece.orders.astype(np.int64), variance, transition, noise, begin, swing)


@kernel
def _smooth(y, orders, variance, transition, noise, begin, swing):
    n = len(y)
    means, covs = np.zeros((n, 3)), np.zeros((n, 3, 3))
    ahead, ahead_cov = np.zeros((n, 3)), np.zeros((n, 3, 3))
    m, p = np.zeros(3), np.diag(begin)
    for t in range(n):
        if t:
            m = transition @ m
            p = transition @ p @ transition.T + noise
        ahead[t], ahead_cov[t] = m, p
        for c in range(len(orders) + 1):
            if c == len(orders):
                k, r, value = 0, swing, 0.0
                if not np.isfinite(swing):
                    continue
            else:
                k, r, value = orders[c], variance[t, c], y[t, c]
            gain = p[:, k] / (p[k, k] + r)
            m = m + gain * (value - m[k])
            p = p - np.outer(gain, p[k])
            p = 0.5 * (p + p.T)
        means[t], covs[t] = m, p
    for t in range(n - 2, -1, -1):
        back = covs[t] @ transition.T @ np.linalg.inv(ahead_cov[t + 1])
        means[t] = means[t] + back @ (means[t + 1] - ahead[t + 1])
    return means
