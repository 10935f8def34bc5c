"""Noise that goes on all the time, told from what else is left by where that is least."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np

from ssmr_ident.signals.noise.autoregressive import AutoregressiveNoise, schwarz_order

Array = np.ndarray

WINDOW = 128
"""Samples of a window, at the most: what changes within a fourth of it shows as a spectrum's shape."""

QUANTILE = 0.25
"""Of the periodograms of all windows: what is no noise may fill three windows out of four at any frequency."""


def background_noise(stretches: Sequence[Array], largest_order: int) -> AutoregressiveNoise:
    """Autoregressive model of the noise that stretches of one sensor have in common.

    At every frequency the lower quartile of all windows' periodograms: of noise alone these are exponentially
    distributed, which says how far below its mean the quartile lies.

    Parameters
    ----------
    stretches : sequence of (n,) float
        What is left of them, in sizes of the noise.
    largest_order : int
    """
    width = min(WINDOW, *(len(s) for s in stretches))
    taper = np.hanning(width + 2)[1:-1]
    parts = np.array([s[at : at + width] for s in stretches for at in range(0, len(s) - width + 1, max(width // 2, 1))])
    power = np.abs(np.fft.rfft(parts * taper, axis=1)) ** 2 / float(taper @ taper)
    density = np.quantile(power, QUANTILE, axis=0) / _expected(len(parts))
    density[0] = density[1]  # a zero is not noise
    covariance = np.fft.irfft(density, width)[: min(largest_order, width // 8) + 1]
    if not covariance[0] > 0.0:
        return AutoregressiveNoise(np.ones(1), 1e-300)
    # a quartile says as much as the mean of a fourth of the samples does
    efficiency = math.log1p(-QUANTILE) ** 2 * (1.0 - QUANTILE) / QUANTILE
    coefficients, variance = schwarz_order(covariance, round(efficiency * sum(map(len, stretches))))
    return AutoregressiveNoise(coefficients, math.sqrt(variance))


def _expected(count: int) -> float:
    """Mean of the quantile of so many exponential numbers of mean 1: between two of them in order, of which the k-th
    has Σ 1/(n − j), j < k (Rényi 1953)."""
    ordered = np.cumsum(1.0 / np.arange(count, 0, -1))
    return float(np.quantile(ordered, QUANTILE))
