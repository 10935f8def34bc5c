"""Where a decay begins, and from which poles to start its fit: spectrum, matrix pencil, mains line."""

from __future__ import annotations

import math

import numpy as np
from scipy.linalg import hankel

Array = np.ndarray


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
    result: Array = poles[np.argsort(-np.abs(poles.imag))][:modes]
    return result
