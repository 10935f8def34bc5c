"""Where in a log something is let go or struck: a logger is started first, and a hammer is used more than once."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from ssmr_ident.signals.noise import median_std, white_std

Array = np.ndarray

RISE = 2.0
"""Choice: ratio of the motion of a period to that of the one before from which something new began. A ring that dies
away only falls; a hit that doubles it is seen."""

ABRUPT = 0.35
"""Choice: share of the new motion that its first quarter period must show. A beat grows over many periods."""

LASTING = 0.5
"""Choice: the first period over the two that follow it. What was let go dies away; a beat goes on growing."""

LOUD = 5.0
"""Standard deviations of the noise that a motion stands above it to count."""

CLEAR = 20.0
"""The same, from which nobody doubts that it has begun."""

CLEARLY = 6.0
"""Choice: fall of the sum of squares, in variances of the noise, by which an earlier beginning is believed."""

SHORTEST = 8
"""Samples in a period at least."""

UNFORESEEN = 5.0
"""Standard deviations by which a sample departs from what later ones foretell of it while a hammer still touches."""

ORDER = 6
"""Of that linear prediction: three modes."""


@dataclass(frozen=True)
class Release:
    """One release or hit.

    Parameters
    ----------
    at_s : float [s]
        First sample that it shows in.
    settled_s : float [s]
        First sample of the free decay; later than ``at_s`` while a hammer touches.
    """

    at_s: float
    settled_s: float


def find_releases(time: Array, samples: Array) -> tuple[Release, ...]:
    """Releases and hits in one channel of a free response; none where the log begins within the decay.

    Parameters
    ----------
    time : (n,) float [s]
        Evenly spaced.
    samples : (n,) float
        Of a motion, in any derivative.

    Examples
    --------
    >>> time = np.arange(2000) / 500
    >>> ring = np.where(time < 1.2, 0.0, np.exp(-(time - 1.2)) * np.cos(40 * (time - 1.2)))
    >>> noise = 0.01 * np.random.default_rng(0).normal(size=2000)
    >>> [round(found.at_s, 3) for found in find_releases(time, ring + noise)]
    [1.2]
    """
    samples = np.asarray(samples, float)
    period = _period(samples)
    if period < SHORTEST or len(samples) < 4 * period:
        return ()
    noise = white_std(samples) + 1e-9 * float(np.ptp(samples))
    sums = np.concatenate([[0.0], np.cumsum(samples)]), np.concatenate([[0.0], np.cumsum(samples**2)])
    motion = _deviation(sums, period)  # of the period that begins at a sample
    places = np.arange(period, len(samples) - period)
    rise = motion[places] / np.maximum(motion[places - period], noise)
    rise[motion[places] < LOUD * noise] = 0.0
    found: list[Release] = []
    while len(rise) and np.max(rise) > RISE:
        place = int(places[int(np.argmax(rise))])
        rise[np.abs(places - place) < 2 * period] = 0.0
        at = _onset(samples, place, period, noise)
        if at is not None and _is_release(samples, at, period, noise):
            found.append(Release(float(time[at]), float(time[_settled(samples, at, period)])))
    return tuple(sorted(found, key=lambda one: one.at_s))


def _period(samples: Array) -> int:
    """Samples in a period of the strongest frequency, by the highest bin of a tapered transform."""
    tapered = (samples - samples.mean()) * np.hanning(len(samples))
    power = np.abs(np.fft.rfft(tapered, 4 * len(samples))) ** 2
    lowest = 4 * 2  # two periods in the record at least
    if len(power) <= lowest + 1:
        return 0
    peak = lowest + int(np.argmax(power[lowest:]))
    return round(4 * len(samples) / peak)


def _deviation(sums: tuple[Array, Array], width: int) -> Array:
    """Standard deviation over the ``width`` samples from each on."""
    mean = (sums[0][width:] - sums[0][:-width]) / width
    result: Array = np.sqrt(np.maximum((sums[1][width:] - sums[1][:-width]) / width - mean**2, 0.0))
    return result


def _continued(samples: Array, first: int, until: int, last: int, period: int) -> Array:
    """What rang before, from ``first`` to ``until``, continued to ``last``: its level and one frequency, fitted."""
    place = np.arange(first, last)
    angle = 2.0 * math.pi * place / period
    columns = np.stack([np.ones(len(place)), np.cos(angle), np.sin(angle)], axis=1)
    columns = np.hstack([columns, columns[:, 1:] * ((place - until) / period)[:, None]])
    known = until - first
    if known < 2 * period:
        columns = columns[:, :1]
    result: Array = columns @ np.linalg.lstsq(columns[:known], samples[first:until], rcond=None)[0]
    return result


def _onset(samples: Array, place: int, period: int, noise: float) -> int | None:
    """The sample from which the log leaves what it did before: a jump, a bend or a curve that begins there."""
    quarter = max(3, period // 4)
    first = max(0, place - 3 * period)
    last = min(len(samples), place + period)
    until = max(first + 4, place - period // 2)
    left = samples[first:last] - _continued(samples, first, until, last, period)
    known = until - first
    level = max(noise, float(median_std(left[:known])))
    out = np.flatnonzero(np.abs(left[known // 2 :]) > LOUD * level) + known // 2
    if not len(out):
        return None
    seen = int(out[0])
    clear = np.flatnonzero(np.abs(left[seen:]) > CLEAR * level)  # beyond it the form of a blow would rule the fit
    end = min(len(left), seen + (min(quarter, int(clear[0]) + 1) if len(clear) else quarter))
    window = left[max(0, seen - 2 * quarter) : end]
    best, least = seen, math.inf
    for begin in range(seen, max(2, seen - quarter), -1):  # the later one, unless an earlier one fits clearly better
        since = np.arange(len(window)) - (begin - max(0, seen - 2 * quarter))
        for powers in ((0, 1), (1, 2), (2, 3)):
            columns = np.stack([np.where(since >= 0, (since / quarter) ** power, 0.0) for power in powers], axis=1)
            rest = window - columns @ np.linalg.lstsq(columns, window, rcond=None)[0]
            misfit = float(np.sum(rest**2)) / level**2
            if misfit < least - CLEARLY:
                best, least = begin, misfit
    return first + best


def _is_release(samples: Array, at: int, period: int, noise: float) -> bool:
    """Whether the motion after it is there at once, larger than before, and does not go on growing."""
    after = samples[at : at + period]
    later = samples[at + period : at + 3 * period]
    before = samples[max(0, at - period) : at]
    if len(after) < period or len(before) < 3:
        return False
    size = float(np.std(after))
    start = float(np.ptp(samples[at : at + max(3, period // 4) + 1]))
    grows = len(later) >= period and size < LASTING * float(np.std(later))
    return size > max(LOUD * noise, RISE * float(np.std(before))) and start > ABRUPT * 2.0 * size and not grows


def _settled(samples: Array, at: int, period: int) -> int:
    """First sample from which on later ones foretell every one: backward linear prediction."""
    calm, end = at + period // 2, min(len(samples), at + 8 * period)
    if end - calm < 6 * ORDER:
        return at
    rows = np.lib.stride_tricks.sliding_window_view(samples[at:end], ORDER + 1)
    ahead = np.hstack([rows[:, 1:], np.ones((len(rows), 1))])
    learnt = slice(calm - at, None)
    weights = np.linalg.lstsq(ahead[learnt], rows[learnt, 0], rcond=None)[0]
    error = np.abs(rows[:, 0] - ahead @ weights)
    level = float(median_std(error[learnt])) + 1e-12 * float(np.ptp(samples))
    wrong = np.flatnonzero(error[: calm - at] > UNFORESEEN * level)
    return at + (int(wrong[-1]) + 1 if len(wrong) else 0)
