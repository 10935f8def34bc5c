"""Whether anything is left but white noise, and what noise that is not white does to estimates and comparisons."""

from __future__ import annotations

import numpy as np
from scipy.stats import chi2

Array = np.ndarray

SMOOTHED = 15
"""Bins of a periodogram over which its mean is taken: S is known to a quarter then. A decay is three to five wide."""


def whiteness(samples: Array, lags: int = 30, spent: int = 0) -> float:
    """p-value of the Ljung–Box test that samples are white; small means that something is left.

    Parameters
    ----------
    samples : (n,) float
    lags : int
    spent : int
        Autoregressive coefficients already fitted to these samples.
    """
    count = len(samples)
    lags = max(min(lags, count // 5), spent + 2)
    centred = samples - samples.mean()
    size = 1 << (2 * count - 1).bit_length()
    covariance = np.fft.irfft(np.abs(np.fft.rfft(centred, size)) ** 2, size)[: lags + 1]
    if covariance[0] <= 0:
        return 1.0
    correlation = covariance[1:] / covariance[0]
    statistic = count * (count + 2) * np.sum(correlation**2 / (count - np.arange(1, lags + 1)))
    return float(chi2.sf(statistic, lags - spent))


def long_run_variance(scores: Array, bandwidth: int) -> Array:
    """Covariance of the sum of autocorrelated scores (Newey and West 1987), (k, k).

    Parameters
    ----------
    scores : (n, k) float
        Contribution of each sample to a gradient.
    bandwidth : int
        Lags taken, with triangular weights.
    """
    total = scores.T @ scores
    for lag in range(1, min(bandwidth, len(scores) - 1) + 1):
        weight = 1.0 - lag / (bandwidth + 1.0)
        product = scores[lag:].T @ scores[:-lag]
        total += weight * (product + product.T)
    result: Array = total
    return result


def independent_samples(residual: Array) -> float:
    """Number of independent samples in a residual, n/(1 + 2 Σ ρ²) (Bartlett 1946)."""
    used = residual[residual != 0.0] if np.any(residual == 0.0) else residual
    count = len(used)
    if count < 8:
        return float(count)
    size = 1 << (2 * count - 1).bit_length()
    covariance = np.fft.irfft(np.abs(np.fft.rfft(used, size)) ** 2, size)[: max(2, count // 4)]
    if not covariance[0] > 0:
        return float(count)
    rho = covariance[1:] / covariance[0]
    excess = float(np.sum(rho**2)) - len(rho) / count  # what white noise shows of it by chance
    return count / (1.0 + 2.0 * max(excess, 0.0))


def samples_together(residual: Array) -> float:
    """How many neighbouring samples of a residual with structure count as one, 1 + 2 Σ ρ².

    Parameters
    ----------
    residual : (n,) float
    """
    size = 1 << (2 * len(residual) - 1).bit_length()
    covariance = np.fft.irfft(np.abs(np.fft.rfft(residual, size)) ** 2, size)[: len(residual) // 2]
    return 1.0 + 2.0 * float(np.sum((covariance[1:] / covariance[0]) ** 2))


def loudness_where_taken(left: Array, taken: Array) -> float:
    """How much louder noise is at the frequencies of what an explanation takes than it is on average.

    By the noise's power spectrum S, mean 1, and that of what is taken, D, the variance of their product is that in
    white noise times Σ D S / Σ D (Kay, Fundamentals of Statistical Signal Processing: Detection Theory, 1998,
    section 4.4).

    Parameters
    ----------
    left : (n, c) float
        What the explanation leaves, channel by channel: the noise.
    taken : (n, c) float
        What it takes.

    Returns
    -------
    float
        1 where nothing is left or taken.
    """
    power = [_smoothed(_power(column)) for column in left.T]
    removed = [_power(column) for column in taken.T]
    total, mean = float(np.sum(removed)), float(np.mean(power))
    return float(np.sum(np.multiply(removed, power))) / (total * mean) if total * mean > 0.0 else 1.0


def _power(column: Array) -> Array:
    return np.abs(np.fft.rfft(column)) ** 2


def _smoothed(power: Array) -> Array:
    width = min(SMOOTHED, len(power))
    kernel = np.ones(width)
    return np.convolve(power, kernel, "same") / np.convolve(np.ones(len(power)), kernel, "same")
