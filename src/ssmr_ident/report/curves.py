"""What of a long course to draw: the part that matters, and no more points than a line can show."""

from __future__ import annotations

from itertools import pairwise

import numpy as np

POINTS = 1200
"""Points per line; a panel is some 300 pixels wide on a phone and 500 on a desk."""


def thinned(x: np.ndarray, y: np.ndarray, points: int = POINTS) -> tuple[np.ndarray, np.ndarray]:
    """At most ``points`` points of a course, its extremes kept: lowest and highest of each stretch, in their order.

    >>> x, y = thinned(np.arange(10_000.0), np.sin(np.arange(10_000.0)))
    >>> len(x) <= 1200, bool(y.max() > 0.9999)
    (True, True)
    """
    n = len(y)
    if n <= points:
        return x, y
    edges = np.linspace(0, n, points // 2 + 1).astype(int)
    kept = {0, n - 1}
    for begin, end in pairwise(edges):
        stretch = y[begin:end]
        kept |= {begin + int(np.argmin(stretch)), begin + int(np.argmax(stretch))}
    order = np.sort(list(kept))[:points]
    return x[order], y[order]


def busiest_part(course: np.ndarray, matter: np.ndarray, cycles: int) -> slice:
    """The stretch of at most ``cycles`` swings in which ``matter`` has most power; the whole where there are fewer.

    Parameters
    ----------
    course : (n,) float
        Its swings are counted at the mean frequency of its power: a long tail of noise adds next to none.
    matter : (n,) float
    cycles : int
    """
    n = len(course)
    density = np.abs(np.fft.rfft(course - course.mean())) ** 2
    total = float(density.sum())
    swings = float(np.arange(len(density)) @ density) / total if total > 0 else 0.0
    if swings <= cycles:
        return slice(0, n)
    length = max(16, round(n * cycles / swings))
    power = np.cumsum(np.concatenate([[0.0], matter**2]))
    gathered = power[length:] - power[:-length]
    first = int(np.argmax(gathered))
    return slice(first, first + length)
