"""Where a decay begins, and from which poles to start its fit: spectrum, matrix pencil, mains line."""

from __future__ import annotations

import math

import numpy as np
from scipy.linalg import hankel

Array = np.ndarray

MAINS_SPREAD_HZ = 0.3
"""How far from its nominal frequency a mains line is sought; grids hold ±0.05 Hz, a logger's clock ±1e-3."""


def spectral_poles(samples: Array, step: float, modes: int, width: int, low_hz: float = 0.0) -> Array:
    """Poles of the highest spectral peak by a rational fit to the bins around it, (modes,) complex [1/s].

    Parameters
    ----------
    samples : (n, c) float
        Channels; those bins are fitted together.
    step : float [s]
    modes : int
        Poles sought among these bins.
    width : int
        Bins taken on each side of the peak.
    low_hz : float [Hz]
        Peaks below are not looked at.

    Notes
    -----
    On the bins of a DFT a damped sinusoid is exactly c/(iω_k − s) however the record cuts it, so
    Y_k·Π(x_k − x_j) is a polynomial in the bin's position x: linear least squares, re-weighted twice
    (Sanathanan and Koerner 1963).
    """
    count = len(samples)
    spectrum = np.fft.rfft(samples - samples.mean(axis=0), axis=0)
    height = np.sum(np.abs(spectrum) ** 2, axis=1)
    first = max(2, math.ceil(low_hz * count * step))
    if first >= len(height) - 2:
        return np.empty(0, complex)
    peak = first + int(np.argmax(height[first:-1]))
    bins = np.arange(max(1, peak - width), min(len(height) - 1, peak + width + 1))
    if len(bins) < 2 * modes + 2:
        return np.empty(0, complex)
    position = (bins - peak) / max(width, 1)
    powers = position[:, None] ** np.arange(modes + 1)
    weight = np.ones(len(bins))
    denominator = np.zeros(modes)
    for _ in range(3):
        rows, targets = [], []
        channels = samples.shape[1]
        for channel in range(channels):
            value = spectrum[bins, channel] * weight
            numerator = np.zeros((len(bins), channels * (modes + 1)), complex)
            numerator[:, channel * (modes + 1) : (channel + 1) * (modes + 1)] = -powers * weight[:, None]
            rows.append(np.hstack([powers[:, :modes] * value[:, None], numerator]))
            targets.append(-powers[:, modes] * value)
        solution = np.linalg.lstsq(np.vstack(rows), np.concatenate(targets), rcond=None)[0]
        denominator = solution[:modes]
        weight = 1.0 / np.maximum(np.abs(powers[:, :modes] @ denominator + powers[:, modes]), 1e-9)
    roots = np.roots(np.concatenate([[1.0], denominator[::-1]]))
    spacing = 2 * np.pi / (count * step)
    return 1j * spacing * (peak + roots * max(width, 1))


def matrix_pencil(samples: Array, step: float, modes: int, pencil: int | None = None) -> Array:
    """Poles of damped sinusoids by the matrix pencil, (modes,) complex [1/s], positive frequencies only.

    Parameters
    ----------
    samples : (n,) float
        Offset removed; a few hundred samples at most, for the cost grows with n³.
    step : float [s]
    modes : int
    pencil : int, optional
        Pencil parameter, n // 3 by default.

    Notes
    -----
    Source: Hua and Sarkar, IEEE Trans. ASSP 38 (1990).
    """
    count = len(samples)
    pencil = pencil or count // 3
    data = hankel(samples[: count - pencil], samples[count - pencil - 1 :])
    right = np.linalg.svd(data, full_matrices=False)[2][: 2 * modes].T
    values = np.linalg.eigvals(np.linalg.lstsq(right[:-1], right[1:], rcond=None)[0].T)
    poles = np.log(values[np.abs(values) > 1e-12].astype(complex)) / step
    # The right singular vectors span conjugated exponentials as well, so the sign of ω is free.
    poles = poles[poles.imag > 0]
    return poles[np.argsort(-np.abs(poles.imag))][:modes]


def mains_frequency(samples: Array, step: float, nominal: float = 60.0) -> float | None:
    """Frequency of the mains line [Hz], or None where no line stands above the noise around it.

    Parameters
    ----------
    samples : (n, c) float
        A stretch without transients is best; the line's own frequency is refined to a fraction of a bin.
    step : float [s]
    nominal : float [Hz]
    """
    count = len(samples)
    if count * step < 0.25 or nominal + 2 > 0.45 / step:
        return None
    taper = np.hanning(count)[:, None]
    centred = (samples - samples.mean(axis=0)) * taper
    times = step * (np.arange(count) - count / 2)

    def power(frequency: float) -> float:
        return float(np.sum(np.abs(np.exp(-2j * np.pi * frequency * times) @ centred) ** 2))

    resolution = 1.0 / (count * step)
    around = [power(nominal + sign * offset * resolution) for sign in (-1, 1) for offset in (4.5, 6.5, 8.5)]
    # Bins of noise are exponential in power; their median is 0.69 of the mean, and 12 means are passed by
    # chance once in 160 000.
    if power(nominal) < 12 * np.median(around) / 0.69:
        return None
    low, high = nominal - MAINS_SPREAD_HZ, nominal + MAINS_SPREAD_HZ
    grid = np.linspace(low, high, max(7, math.ceil((high - low) / (0.5 * resolution))))
    best = float(grid[int(np.argmax([power(f) for f in grid]))])
    width = min(0.25 * resolution, MAINS_SPREAD_HZ / 4)
    for _ in range(25):
        left, middle, right = power(best - width), power(best), power(best + width)
        curvature = left - 2 * middle + right
        if curvature < 0:
            best += float(np.clip(0.5 * (left - right) / curvature, -1, 1)) * width
        width *= 0.5
    return best


def nuisance_columns(times: Array, lines_hz: tuple[float, ...]) -> Array:
    """Offset, and sine and cosine of each line, (n, 1 + 2·lines)."""
    columns = [np.ones(len(times))]
    for line in lines_hz:
        phase = 2 * np.pi * line * times
        columns += [np.cos(phase), np.sin(phase)]
    return np.column_stack(columns)


def rest_after(samples: Array, times: Array, lines_hz: tuple[float, ...], share: float = 0.2) -> Array:
    """Samples with the offset and lines of their last part removed, (n, c); also tells noise from motion.

    Parameters
    ----------
    samples : (n, c) float
    times : (n,) float [s]
    lines_hz : tuple of float [Hz]
    share : float
        Last part of the record that is taken as being at rest.
    """
    columns = nuisance_columns(times, lines_hz)
    tail = slice(int(len(times) * (1 - share)), None)
    solution = np.linalg.lstsq(columns[tail], samples[tail], rcond=None)[0]
    return samples - columns @ solution
