"""What of a record lies in a band: filtered as it was, or as a shorter series that holds just that."""

from __future__ import annotations

import math

import numpy as np
from scipy.fft import dct, idct

from ssmr_ident.signals.filters import design, low_pass
from ssmr_ident.signals.noise import median_std

Array = np.ndarray
Band = tuple[float, float]
"""Frequencies [Hz] from and to."""

BESIDE = 0.25
"""Share of a band's width on either side over which a filter that leaves the band as it is falls to nought."""

RAMP = 2.0
"""Length of the ramps at the ends of a record, in periods of a frequency as high as the band is wide."""


def inside(samples: Array, sample_rate: float, band_hz: Band) -> Array:
    """Samples with what lies in a band as it is, and what lies ``BESIDE`` it or further taken away.

    Parameters
    ----------
    samples : (n,) or (n, c) float [any unit]
    sample_rate : float [Hz]
    band_hz : (float, float)
        From 0 where it has no lower end.
    """
    low, high = band_hz
    beside = BESIDE * (high - low)
    around = min(len(samples) - 1, math.ceil(4.0 * sample_rate / beside))
    padded = np.pad(samples, [(around, around)] + [(0, 0)] * (samples.ndim - 1), mode="reflect")
    frequency = np.fft.rfftfreq(len(padded), 1.0 / sample_rate)
    gain = _falling((frequency - high) / beside)
    if low > 0.0:
        gain *= _falling((low - frequency) / beside)
    spectrum = np.fft.rfft(padded, axis=0)
    shaped = gain.reshape(-1, *[1] * (samples.ndim - 1)) * spectrum
    result: Array = np.fft.irfft(shaped, len(padded), axis=0)[around : around + len(samples)]
    return result


def _falling(beyond: Array) -> Array:
    """From 1 at 0 to 0 at 1, half a cosine between."""
    return np.asarray(0.5 + 0.5 * np.cos(math.pi * np.clip(beyond, 0.0, 1.0)))


def series(samples: Array, sample_rate: float, band_hz: Band, skipped: int = 0) -> Array:
    """What lies in a band as a series of its own, at twice the band's width.

    White noise stays white noise of the same standard deviation, frequencies count from the band's lower end, and a
    swing that dies out dies out as fast: rows of the discrete cosine transform, turned back without the others.

    Parameters
    ----------
    samples : (n, …) float [any unit]
    sample_rate : float [Hz]
    band_hz : (float, float)
    skipped : int
        Samples at the begin that do not count.

    Returns
    -------
    (m, …) float
    """
    count = len(samples)
    window = np.zeros(count)
    window[skipped:] = _ramps(count - skipped, round(RAMP * sample_rate / (band_hz[1] - band_hz[0])))
    windowed = window.reshape(-1, *[1] * (samples.ndim - 1)) * samples
    result: Array = idct(dct(windowed, axis=0, norm="ortho")[_rows(count, sample_rate, band_hz)], axis=0, norm="ortho")
    return result


def _ramps(count: int, length: int) -> Array:
    length = min(length, count // 4)
    if not length:
        return np.ones(count)
    ramp = np.sin(0.5 * math.pi * (np.arange(length) + 0.5) / length) ** 2
    return np.concatenate([ramp, np.ones(count - 2 * length), ramp[::-1]])


def _rows(count: int, sample_rate: float, band_hz: Band) -> slice:
    """Of the transform of so many samples; its k-th is at k·rate/2n."""
    first, after = (math.ceil(2.0 * count * edge / sample_rate) for edge in band_hz)
    return slice(min(first, count - 2), max(min(after, count), min(first, count - 2) + 2))


def lines_in(count: int, sample_rate: float, band_hz: Band) -> int:
    """Length of the series of a record of so many samples."""
    rows = _rows(count, sample_rate, band_hz)
    return int(rows.stop - rows.start)


def quiet_std(samples: Array, sample_rate: float, band_hz: Band) -> Array:
    """Standard deviation of white noise as dense as samples are in the band, but for lines, (c,) float; by a median."""
    own = samples - samples.mean(axis=0)
    return np.asarray(median_std(dct(series(own, sample_rate, band_hz), axis=0, norm="ortho")))


def passed(samples: Array, sample_rate: float, band_hz: Band) -> Array:
    """Samples through the metric's filter: Butterworth, forward and backward."""
    if band_hz[0] <= 0.0:
        return low_pass(samples, sample_rate, band_hz[1])
    chain = design(sample_rate, *band_hz)
    return samples.copy() if chain is None else chain.apply(samples)
