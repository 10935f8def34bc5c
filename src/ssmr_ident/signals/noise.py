"""Coloured noise: an autoregressive model, whitening by it, and a test whether anything is left."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.signal import lfilter
from scipy.stats import chi2

Array = np.ndarray


@dataclass(frozen=True)
class AutoregressiveNoise:
    """Noise e with Σ a_k e(t−k) = w(t), w white.

    Parameters
    ----------
    filter : (p + 1,) float
        Whitening filter, first coefficient 1.
    std : float
        Standard deviation of w, in the signal's unit.
    least : float
        What it is at the least, whatever a record shows: what its converter rounds away.
    """

    filter: Array
    std: float
    least: float = 0.0

    @property
    def order(self) -> int:
        return len(self.filter) - 1

    def whiten(self, samples: Array) -> Array:
        """Samples through the whitening filter, in units of its standard deviation, (n − p, …).

        The first p samples, which the filter's start-up would spoil, are left out.
        """
        if not self.order:
            return samples / self.std
        return lfilter(self.filter, [1.0], samples, axis=0)[self.order :] / self.std

    def gain(self, poles: Array, step: float) -> Array:
        """What the whitening filter makes of e^(st), (k,) complex; without the division by ``std``.

        Parameters
        ----------
        poles : (k,) complex [1/s]
        step : float [s]
        """
        lags = np.arange(len(self.filter))
        return np.exp(-np.outer(np.asarray(poles), lags) * step) @ self.filter

    def density(self, frequency: Array, step: float) -> Array:
        """One-sided power spectral density at frequencies [Hz], (n,) float [unit²/Hz]."""
        response = np.abs(self.gain(2j * np.pi * np.asarray(frequency), step)) ** 2
        with np.errstate(divide="ignore"):  # what is white in its differences is infinitely dense where nothing changes
            return np.asarray(2.0 * step * self.std**2 / response)


def fit_noise(samples: Array, largest_order: int = 24, spent: int = 0) -> AutoregressiveNoise:
    """Autoregressive model of noise, its order by Schwarz's criterion (0 for white noise).

    Parameters
    ----------
    samples : (n,) float
        Residual or quiet stretch; its mean is taken as zero.
    largest_order : int
    spent : int
        Degrees of freedom that an earlier fit took out of the samples.

    Returns
    -------
    AutoregressiveNoise

    Notes
    -----
    Levinson's recursion on the biased autocovariance, whose filter is always stable. Source: Priestley,
    Spectral Analysis and Time Series (1981), section 5.4.
    """
    count = len(samples)
    largest_order = max(0, min(largest_order, count // 10))
    size = 1 << (2 * count - 1).bit_length()
    spectrum = np.fft.rfft(samples, size)
    covariance = np.fft.irfft(np.abs(spectrum) ** 2, size)[: largest_order + 1] / count
    if covariance[0] <= 0:
        return AutoregressiveNoise(np.ones(1), 1e-300)
    best, best_score = (np.ones(1), float(covariance[0])), count * np.log(covariance[0])
    coefficients, variance = np.ones(1), float(covariance[0])
    for order in range(1, largest_order + 1):
        reflection = -float(coefficients @ covariance[order:0:-1]) / variance
        extended = np.append(coefficients, 0.0)
        coefficients = extended + reflection * extended[::-1]
        variance *= 1.0 - reflection**2
        if variance <= 1e-14 * covariance[0]:
            break
        score = count * np.log(variance) + order * np.log(count)
        if score < best_score:
            best, best_score = (coefficients, variance), score
    freedom = max(count - spent - len(best[0]) + 1, 1)
    return AutoregressiveNoise(best[0], float(np.sqrt(best[1] * count / freedom)))


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
    return total
