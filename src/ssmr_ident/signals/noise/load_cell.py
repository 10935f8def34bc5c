"""The noise of a load cell in averages over blocks, from all pulls of a session: white, and first-order coloured.

One cell has logged them all, each in blocks of its own length. What a slow pull leaves says little of its noise where
that is slow as well: neighbouring blocks then share it, and second differences of them see a third of its variance.
Differences of blocks taken together two by two, and four by four, tell how much slower than white it is.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from scipy.stats import chi2

from ssmr_ident.signals.noise.white import white_std

Array = np.ndarray

TOGETHER = (1, 2, 4)
"""Blocks that are taken together."""

FEWEST = 12
"""Second differences that a median is taken of at the least."""

SCATTER = 2.95
"""Standard deviation of the logarithm of a variance that is taken from the median of n second differences of white
noise, times √n: 2.95 in 20,000 simulated series of 36 to 150 (``tests/unit/test_noise_load_cell.py``)."""

OUTSIDE = 2.5
"""Standard deviations beyond which a recording's differences count as if they were so far off."""

CHANCE = 0.0027
"""Probability by chance, that of three standard deviations, up to which noise is coloured, or a recording's its own."""

TIMES = np.geomspace(0.01, 2.0, 16)
"""Correlation times that are tried [s]; what is longer is no noise, and what is shorter is white in blocks."""

SHARES = np.geomspace(0.1, 300.0, 28)
"""Densities of the coloured part at its slowest that are tried, over that of the white one."""


@dataclass(frozen=True, eq=False)
class Blocks:
    """What a recording leaves, in averages over blocks.

    Parameters
    ----------
    left : (n,) float [N]
    length : float [s]
        Of a block.
    """

    left: Array
    length: float


def block_noises(recordings: Sequence[Blocks]) -> Array:
    """Standard deviation of the noise in each recording's blocks, (t,) float [N].

    Parameters
    ----------
    recordings : sequence of Blocks
        All by one load cell.

    Notes
    -----
    White noise of density W and an Ornstein-Uhlenbeck process of variance c and correlation time τ, fitted to the
    logarithms of variances from second differences. Colour counts where it is not by chance; so does a recording that
    is louder or quieter than the others.
    """
    rows = [
        (index, k * one.length, 2.0 * np.log(white_std(together)), max(len(together) - 2, 1))
        for index, one in enumerate(recordings)
        for k in TOGETHER
        if len(together := _averages(one.left, k)) - 2 >= FEWEST or k == 1
    ]
    which, lengths, logs, counts = (np.array(column) for column in zip(*rows, strict=True))
    weights = counts / SCATTER**2
    shapes = [(0.0, 1.0), *((share, time) for time in TIMES for share in SHARES)]
    fits = [_level(logs - np.log(_differences(lengths, *shape)), weights) for shape in shapes]
    best = int(np.argmin([cost for _, cost in fits]))
    if fits[0][1] - fits[best][1] < chi2.isf(CHANCE, 2):
        best = 0
    level, shape = fits[best][0], shapes[best]
    away = logs - np.log(_differences(lengths, *shape)) - level
    found = []
    for index, one in enumerate(recordings):
        own = which == index
        sure = float(weights[own][0])  # averages of more blocks are of the same samples
        off = float(weights[own] @ away[own] / weights[own].sum())
        level_here = level + (off if off**2 * sure > chi2.isf(CHANCE, 1) else 0.0)
        found.append(np.exp(0.5 * level_here) * np.sqrt(float(_variance(np.array(one.length), *shape))))
    return np.array(found)


def _averages(left: Array, k: int) -> Array:
    count = len(left) // k
    result: Array = left[: count * k].reshape(count, k).mean(axis=1)
    return result


def _level(rest: Array, weights: Array) -> tuple[float, float]:
    """Logarithm of the white density, and the cost of a shape with it."""
    order = np.argsort(rest)
    reached = np.cumsum(weights[order])
    level = float(rest[order][np.searchsorted(reached, 0.5 * reached[-1])])
    for _ in range(5):
        inside = weights * ((rest - level) ** 2 * weights < OUTSIDE**2)
        if not inside.any():
            break
        level = float(inside @ rest / inside.sum())
    return level, float(np.sum(np.minimum((rest - level) ** 2 * weights, OUTSIDE**2)))


def _variance(length: Array, share: float, time: float) -> Array:
    """Variance of an average over a length, for white noise of density 1."""
    result: Array = 1.0 / length + share * _together(length, time) / length**2
    return result


def _differences(length: Array, share: float, time: float) -> Array:
    """Variance of second differences of averages over 6: 6, −8 and 2 times the covariance with itself, with the next
    and with the one after."""
    once, twice, thrice = (_together(n * length, time) for n in (1, 2, 3))
    neighbour, next_but_one = 0.5 * (twice - 2.0 * once), 0.5 * (thrice - 2.0 * twice + once)
    result: Array = 1.0 / length + share * (6.0 * once - 8.0 * neighbour + 2.0 * next_but_one) / (6.0 * length**2)
    return result


def _together(length: Array, time: float) -> Array:
    """Variance of the integral of an Ornstein-Uhlenbeck process over a length, for a density of 1 at its slowest."""
    x = length / time
    return time * (x + np.expm1(-x))
