"""Intervals: of a mean over a few recordings, of a share over cases, of a median."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np
from scipy.stats import beta, binom, t

NAN = float("nan")


def mean_interval(values: Sequence[float], level: float = 0.95) -> tuple[float, float]:
    """Student's interval of a mean; NaN for fewer than two values."""
    if len(values) < 2:
        return NAN, NAN
    reach = float(t.ppf(0.5 + level / 2.0, len(values) - 1) * np.std(values, ddof=1) / math.sqrt(len(values)))
    centre = float(np.mean(values))
    return centre - reach, centre + reach


def between(low: float, high: float, digits: str = ".2f") -> str:
    """An interval in brackets; nothing where there is none.

    >>> between(1.0, 1.25), between(NAN, NAN)
    (' (1.00 … 1.25)', '')
    """
    return "" if math.isnan(low) else f" ({low:{digits}} … {high:{digits}})"


def share_interval(hits: int, total: int, level: float = 0.95) -> tuple[float, float]:
    """Clopper and Pearson's interval of a share.

    >>> [round(x, 4) for x in share_interval(0, 25)]
    [0.0, 0.1372]
    """
    if total == 0:
        return NAN, NAN
    tail = (1.0 - level) / 2.0
    low = float(beta.ppf(tail, hits, total - hits + 1)) if hits else 0.0
    high = float(beta.ppf(1.0 - tail, hits + 1, total - hits)) if hits < total else 1.0
    return low, high


def median_interval(values: Sequence[float], level: float = 0.95) -> tuple[float, float]:
    """Of a median, from order statistics (no assumption on the distribution); NaN for fewer than six values."""
    ordered = np.sort(np.asarray(values, dtype=float))
    n = len(ordered)
    if n < 6:
        return NAN, NAN
    k = int(binom.ppf((1.0 - level) / 2.0, n, 0.5))
    k = max(k, 1)
    return float(ordered[k - 1]), float(ordered[n - k])
