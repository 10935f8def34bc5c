"""Moments at which a block was let go: teeth of five samples and more, found by how much the force falls there.

A fall is what mean forces before and after a moment differ by. Where each is far above chance it counts by itself;
teeth that noise half hides still come at about one distance, which is a line in the spectrum of the sliding force. The
moments are then the chain of falls that is most of a fall at about that distance (dynamic programming).
"""

from __future__ import annotations

import itertools

import numpy as np
from scipy.signal import find_peaks

from ssmr_ident.identify.blocks.log import PulledLog

Array = np.ndarray

CLEAR = 6.0
"""Standard deviations of chance from which a fall counts by itself."""

LINE = 8.0
"""Times the median of its neighbourhood from which a line of the sliding force is no chance."""

FEWEST, LEAST = 3, 5
"""Teeth, and samples of one."""

LOADS = 0.2
"""Share of what the drive loads in the time of a tooth that the force falls by at least, on average."""

PROMINENT = 0.5
"""Share of the prominence of the most prominent peak from which the first one is a peak as well."""

UNEVEN = 0.15
"""Of distances between teeth."""


def first_let_go(log: PulledLog) -> int:
    """Sample of the first peak of those that stand out at least half as far as the highest, or of the knee where none
    stands out of noise."""
    begin = round(log.starts / log.step)
    level = log.rests + 0.6 * log.load
    up = begin + int(np.argmax(log.force[begin:] > level))
    expected = max(round(0.5 * log.load / max(log.rise * log.step, 1e-300)), LEAST)
    part = log.force[up : up + 2 * expected + LEAST]
    width = max(1, min(len(part) // 8, 5))
    smooth = np.convolve(part, np.full(width, 1.0 / width), "same")
    inner = smooth[: max(len(smooth) - width // 2, 1)]
    peaks, found = find_peaks(inner, prominence=CLEAR * log.noise / np.sqrt(width))
    if not len(peaks):
        return up + int(np.argmax(inner))
    return up + int(peaks[np.argmax(found["prominences"] > PROMINENT * found["prominences"].max())])


def moments(log: PulledLog) -> Array:
    """Moments of letting go from the first sample [s], (k,) float: the first peak alone where there are no teeth."""
    first = first_let_go(log)
    sliding = log.force[first:]
    if len(sliding) < 4 * LEAST:
        return np.array([first * log.step])
    period = _line_period(sliding) or _clear_period(log, sliding)
    if period is None:
        return np.array([first * log.step])
    width = max(2, int(period / 4))
    fall = _falls(sliding, width)
    places = _maxima(fall)
    chain = _chain(places, fall[places], period)
    # a tooth comes up as the drive's first rise does; a level that wanders does not
    loads = log.rise * log.step * float(np.median(np.diff(chain))) if len(chain) >= FEWEST else np.inf
    if float(np.mean(fall[chain])) < LOADS * loads:
        return np.array([first * log.step])
    begun = [] if chain[0] < 0.5 * period else [0]
    return (_even(np.array([*begun, *chain], dtype=float)) + first + 0.5) * log.step


def _even(chain: Array) -> Array:
    """The chain with the teeth that noise has hidden: a gap of several usual ones holds as many."""
    gaps = np.diff(chain)
    usual = float(np.median(gaps))
    parts = [chain[:1]]
    for begin, gap in zip(chain[:-1], gaps, strict=True):
        count = max(round(gap / usual), 1)
        parts.append(begin + gap * np.arange(1, count + 1) / count)
    return np.concatenate(parts)


def _falls(force: Array, width: int) -> Array:
    """Mean before less mean after each sample, (n,) float."""
    total = np.concatenate([[0.0], np.cumsum(force)])
    n = len(force)
    index = np.arange(n)
    low, high = np.maximum(index + 1 - width, 0), np.minimum(index + 1 + width, n)
    before = (total[index + 1] - total[low]) / (index + 1 - low)
    after = (total[high] - total[np.minimum(index + 1, n)]) / np.maximum(high - index - 1, 1)
    fall: Array = np.where(high > index + 1, before - after, 0.0)
    return fall


def _maxima(values: Array) -> Array:
    inner = (values[1:-1] > values[:-2]) & (values[1:-1] >= values[2:]) & (values[1:-1] > 0.0)
    return np.flatnonzero(inner) + 1


def _clear_period(log: PulledLog, sliding: Array) -> float | None:
    """Median distance of falls that are far above chance and about as large as the largest [samples]."""
    widths = [2 * 2**k for k in range(12) if 2 * 2**k <= len(sliding) // (4 * FEWEST)] or [2]
    # as wide as a fall lasts, it stands out most
    width = max(widths, key=lambda w: float(_falls(sliding, w).max()) * np.sqrt(w))
    fall = _falls(sliding, width)
    least = max(CLEAR * log.noise * np.sqrt(2.0 / width), 0.3 * float(fall.max()))
    places = _maxima(fall)
    places = places[fall[places] > least]
    kept: list[int] = []
    for place in places:
        if kept and place - kept[-1] < max(LEAST, 2 * width):
            kept[-1] = int(place) if fall[place] > fall[kept[-1]] else kept[-1]
        else:
            kept.append(int(place))
    if len(kept) < FEWEST:
        return None
    gaps = np.diff(kept)
    period = float(np.median(gaps))
    # a drop that is no tooth is followed by no rise: between teeth the force comes back
    back = [
        float(sliding[a + width : b + 1].max() - sliding[a + 1 : a + 1 + 2 * width].min())
        for a, b in itertools.pairwise(kept)
    ]
    rises = np.median(back) > 0.5 * float(np.median(fall[kept]))
    return period if rises and period >= LEAST else None


def _line_period(sliding: Array) -> float | None:
    """Distance of teeth by the highest line of the sliding force [samples]."""
    n = len(sliding)
    start = min(n // 10, n - 4 * LEAST)
    rest = sliding[start:] - np.polyval(np.polyfit(np.arange(n - start), sliding[start:], 3), np.arange(n - start))
    spectrum = np.abs(np.fft.rfft(rest * np.hanning(len(rest))))
    first = 2 * FEWEST
    last = len(rest) // LEAST
    if last <= first + 8:
        return None
    searched = spectrum[first : last + 1]
    top = int(np.argmax(searched)) + first
    around = spectrum[max(top // 2, first) : min(2 * top, len(spectrum) - 1) + 1]
    if spectrum[top] < LINE * float(np.median(around)):
        return None
    return len(rest) / top


def _chain(places: Array, heights: Array, period: float) -> list[int]:
    """The chain of places at about one distance that has the most height in all."""
    best = heights.astype(float).copy()
    link = np.full(len(places), -1)
    usual = float(np.median(np.sort(heights)[-max(len(places) // 4, 1) :])) if len(places) else 0.0
    for k, place in enumerate(places):
        low, high = np.searchsorted(places, [place - 1.8 * period, place - 0.4 * period])
        if high <= low:
            continue
        gaps = (place - places[low:high]) / period
        scores = best[low:high] - 0.02 * usual * ((gaps - 1.0) / UNEVEN) ** 2
        top = int(np.argmax(scores))
        if scores[top] > 0.0:
            best[k] += scores[top]
            link[k] = low + top
    if not len(places):
        return []
    chain = []
    k = int(np.argmax(best))
    while k >= 0:
        chain.append(int(places[k]))
        k = int(link[k])
    return chain[::-1]
