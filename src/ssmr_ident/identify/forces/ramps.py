"""Straight stretches of a force log: change points by optimal partitioning, slopes with intervals.

Every partition of the log into straight lines is scored by Schwarz's criterion and the best one is found exactly
(dynamic programming; Bai and Perron 2003). Jumps between lines are free, so teeth, knees and plateaus all fit.
"""

from __future__ import annotations

from dataclasses import dataclass
from itertools import pairwise

import numpy as np

from ssmr_ident.signals.noise import force_noise, median_std

Array = np.ndarray

FINEST = 1200
"""Points to which a log is averaged before partitioning, whose cost grows with their square."""


@dataclass(frozen=True)
class Ramp:
    """One straight stretch.

    Parameters
    ----------
    first, last : int
        Samples of the log, the last one included.
    x_start, x_end : float [m]
    force_start, force_end : float [N]
        On the line.
    slope, slope_std : float [N/m]
        The standard deviation holds for noise correlated over neighbouring samples.
    scatter : float [N]
        Of the samples about the line.
    """

    first: int
    last: int
    x_start: float
    x_end: float
    force_start: float
    force_end: float
    slope: float
    slope_std: float
    scatter: float

    @property
    def samples(self) -> int:
        return self.last - self.first + 1


def partition(x: Array, y: Array, variance: float, shortest: int = 3) -> list[int]:
    """First points of the straight pieces of y over x, beginning with 0.

    Parameters
    ----------
    x, y : (n,) float
    variance : float
        Of one point, including what correlation adds.
    shortest : int
        Points in a piece.

    Notes
    -----
    Minimises Σ RSS/variance + 3·ln(n) per piece: a slope, a level and a place.
    """
    count = len(x)
    penalty = 3.0 * np.log(count)
    x = (x - x.mean()) / max(float(np.std(x)), 1e-300)
    y = (y - y.mean()) / np.sqrt(variance)
    sums = np.zeros((6, count + 1))
    sums[:, 1:] = np.cumsum([np.ones(count), x, y, x * x, x * y, y * y], axis=1)
    best = np.full(count + 1, np.inf)
    best[0] = -penalty
    origin = np.zeros(count + 1, int)
    for end in range(shortest, count + 1):
        begin = np.arange(0, end - shortest + 1)
        n, sx, sy, sxx, sxy, syy = sums[:, end][:, None] - sums[:, begin]
        spread = sxx - sx * sx / n
        joint = sxy - sx * sy / n
        rss = syy - sy * sy / n - np.where(spread > 1e-12, joint**2 / np.maximum(spread, 1e-12), 0.0)
        total = best[begin] + np.maximum(rss, 0.0) + penalty
        pick = int(np.argmin(total))
        best[end], origin[end] = total[pick], pick
    starts = []
    at = count
    while at > 0:
        at = int(origin[at])
        starts.append(at)
    return starts[::-1]


def straight_line(x: Array, y: Array) -> tuple[float, float, float, float]:
    """Slope, its standard deviation, level at the middle, and scatter of a line by least squares.

    The standard deviation is widened by the first-order correlation r of the residual, √((1 + r)/(1 − r)).
    """
    middle = float(x.mean())
    centred = x - middle
    spread = float(centred @ centred)
    if spread <= 0 or len(x) < 3:
        return 0.0, np.inf, float(y.mean()), 0.0
    slope = float(centred @ y) / spread
    residual = y - y.mean() - slope * centred
    scatter = float(np.sqrt(residual @ residual / max(len(x) - 2, 1)))
    power = float(residual @ residual)
    correlation = float(np.clip(residual[1:] @ residual[:-1] / power, 0.0, 0.95)) if power > 0 else 0.0
    widened = np.sqrt((1 + correlation) / (1 - correlation))
    return slope, scatter / np.sqrt(spread) * widened, float(y.mean()), scatter


def find_ramps(position: Array, force: Array) -> tuple[Ramp, ...]:
    """Straight stretches of a force log, in order.

    Parameters
    ----------
    position : (n,) float [m]
        Of the machine; where the log has none, time times speed.
    force : (n,) float [N]

    Returns
    -------
    tuple of Ramp
    """
    count = len(force)
    block = max(1, -(-count // FINEST))
    whole = count // block * block
    y = force[:whole].reshape(-1, block).mean(axis=1)
    variance = force_noise(y) ** 2
    # A first pass shows how far neighbouring points go together; the second one charges for it.
    for _ in range(2):
        starts = partition(np.arange(len(y), dtype=float), y, variance)
        edges = [*starts, len(y)]
        residual = np.concatenate(
            [y[a:b] - np.polyval(np.polyfit(np.arange(b - a), y[a:b], 1), np.arange(b - a)) for a, b in pairwise(edges)]
        )
        power = float(residual @ residual)
        correlation = float(np.clip(residual[1:] @ residual[:-1] / power, 0.0, 0.9)) if power > 0 else 0.0
        # The median keeps the few points that a jump smears from inflating the noise of all.
        level = float(median_std(residual))
        variance = max(variance, level**2) * (1 + correlation) / (1 - correlation)
    ramps = []
    for a, b in pairwise(edges):
        first, last = a * block, (b * block if b < len(y) else count) - 1
        first, last = _trimmed(force, first, last, block)
        xs, ys = position[first : last + 1], force[first : last + 1]
        slope, slope_std, level, scatter = straight_line(xs, ys)
        middle = float(xs.mean())
        ramps.append(
            Ramp(
                first,
                last,
                float(xs[0]),
                float(xs[-1]),
                level + slope * (float(xs[0]) - middle),
                level + slope * (float(xs[-1]) - middle),
                slope,
                slope_std,
                scatter,
            )
        )
    return tuple(ramps)


def _trimmed(force: Array, first: int, last: int, block: int) -> tuple[int, int]:
    """A stretch without the block at either end in which a jump may have been averaged."""
    if block > 1 and last - first > 6 * block:
        return first + block, last - block
    return first, last
