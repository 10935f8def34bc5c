"""Noise as an autoregressive process: told from differences where it is white, from what is quiet where it is not."""

from __future__ import annotations

from dataclasses import dataclass, field, replace

import numpy as np
from scipy.signal import lfilter

from ssmr_ident.signals.noise.white import white_std

Array = np.ndarray

WHITE = np.ones(1)
"""Whitening filter of noise that is white."""

SHORTEST_QUIET = 400
"""Samples of a quiet tail from which an autoregressive model of order up to 24 is taken; below, all that is left."""


@dataclass(frozen=True)
class AutoregressiveNoise:
    """Noise e with Σ a_k e(t−k) = Σ b_k w(t−k), w white.

    Parameters
    ----------
    filter : (p + 1,) float
        Whitening filter, first coefficient 1.
    std : float
        Standard deviation of w, in the signal's unit.
    least : float
        What it is at the least, whatever a record shows: what its converter rounds away.
    moving_average : (q + 1,) float
        b, first coefficient 1; all that there is where the noise is autoregressive.
    """

    filter: Array
    std: float
    least: float = 0.0
    moving_average: Array = field(default_factory=lambda: WHITE)

    @property
    def order(self) -> int:
        return len(self.filter) - 1

    def whiten(self, samples: Array) -> Array:
        """Samples through the whitening filter, in units of its standard deviation, (n − p, …).

        The first p samples, which the filter's start-up would spoil, are left out.
        """
        return self.filtered(samples)[self.order :]

    def filtered(self, samples: Array) -> Array:
        """All samples through the whitening filter, which begins at rest, in units of its standard deviation."""
        if not self.order:
            return samples / self.std
        result: Array
        if len(self.moving_average) == 1:  # no feedback: a sum of shifted copies, at the speed of memory
            result = self.filter[0] / self.std * samples
            for lag in range(1, len(self.filter)):
                result[lag:] += self.filter[lag] / self.std * samples[:-lag]
            return result
        result = lfilter(self.filter, self.moving_average, samples, axis=0) / self.std
        return result

    def louder(self, factor: float) -> AutoregressiveNoise:
        """The same, ``factor`` times as large."""
        return replace(self, std=self.std * factor)

    def gain(self, poles: Array, step: float) -> Array:
        """What the whitening filter makes of e^(st), (k,) complex; without the division by ``std``.

        Parameters
        ----------
        poles : (k,) complex [1/s]
        step : float [s]
        """
        lags = np.outer(np.asarray(poles), np.arange(max(len(self.filter), len(self.moving_average)))) * step
        whiten, back = (np.exp(-lags[:, : len(c)]) @ c for c in (self.filter, self.moving_average))
        result: Array = whiten / back
        return result

    def density(self, frequency: Array, step: float) -> Array:
        """One-sided power spectral density at frequencies [Hz], (n,) float [unit²/Hz]."""
        response = np.abs(self.gain(2j * np.pi * np.asarray(frequency), step)) ** 2
        with np.errstate(divide="ignore"):  # what is white in its differences is infinitely dense where nothing changes
            return np.asarray(2.0 * step * self.std**2 / response)


def white_noise(samples: Array, least: float = 0.0, whitening: Array = WHITE) -> AutoregressiveNoise:
    """Noise of a known colour, as large as samples have it at their fastest, where a slow motion hardly enters.

    Parameters
    ----------
    samples : (n,) float
    least : float
        What the noise is at the least: what is rounded away of such samples.
    whitening : (p + 1,) float
        Filter that makes it white, first coefficient 1.
    """
    order = len(whitening) - 1
    white = lfilter(whitening, [1.0], samples)[order:] if order else samples
    return AutoregressiveNoise(whitening, max(white_std(white), least), least)


def quiet_noise(residual: Array, quiet_from: int, spent: int, std: float) -> AutoregressiveNoise:
    """Noise from the quiet tail of a residual, or from all of it where too little is quiet.

    Parameters
    ----------
    residual : (n,) float
        In units of ``std``.
    quiet_from : int
        First sample of the tail.
    spent : int
        Degrees of freedom that a fit took out of the whole residual.
    std : float
    """
    tail = residual[quiet_from:]
    if len(tail) >= max(SHORTEST_QUIET, len(residual) // 8):
        return fit_noise(std * tail)
    return fit_noise(std * residual, spent=spent)


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
    By the biased autocovariance, whose filter is always stable and smooth: of what a model of few modes leaves it makes
    no more than a colour. Where noise has lines far above its rest, ``burg_noise`` reads it right.
    """
    count = len(samples)
    largest_order = max(0, min(largest_order, count // 10))
    size = 1 << (2 * count - 1).bit_length()
    spectrum = np.fft.rfft(samples, size)
    covariance = np.fft.irfft(np.abs(spectrum) ** 2, size)[: largest_order + 1] / count
    if covariance[0] <= 0:
        return AutoregressiveNoise(np.ones(1), 1e-300)
    return _unspent(*schwarz_order(covariance, count), count, spent)


def burg_noise(samples: Array, largest_order: int = 24, spent: int = 0) -> AutoregressiveNoise:
    """As ``fit_noise``, of the same parameters, for noise that spans many decades.

    Notes
    -----
    Burg's reflections, of the errors of prediction forwards and backwards: the filter is always stable, and nothing
    leaks from where noise is strong to where it is weak, as it does through an autocovariance of few samples. Source:
    Percival and Walden, Spectral Analysis for Physical Applications (1993), section 9.5.
    """
    count = len(samples)
    variance = float(np.mean(samples**2))
    if variance <= 0:
        return AutoregressiveNoise(np.ones(1), 1e-300)
    forward, backward, coefficients = samples, samples, np.ones(1)
    best, best_score = (coefficients, variance), count * np.log(variance)
    for order in range(1, max(0, min(largest_order, count // 10)) + 1):
        ahead, behind = forward[1:], backward[:-1]
        reflection = -2.0 * float(ahead @ behind) / max(float(ahead @ ahead + behind @ behind), 1e-300)
        forward, backward = ahead + reflection * behind, behind + reflection * ahead
        coefficients = extended(coefficients, reflection)
        variance *= 1.0 - reflection**2
        if variance <= 0.0:
            break
        score = count * np.log(variance) + order * np.log(count)
        if score < best_score:
            best, best_score = (coefficients, variance), score
    return _unspent(*best, count, spent)


def _unspent(coefficients: Array, variance: float, count: int, spent: int) -> AutoregressiveNoise:
    """Noise by its filter, what a fit and the filter itself took out of the samples' variance put back."""
    freedom = max(count - spent - len(coefficients) + 1, 1)
    return AutoregressiveNoise(coefficients, float(np.sqrt(variance * count / freedom)))


def extended(coefficients: Array, reflection: float) -> Array:
    """Levinson's step: a prediction filter of one order more."""
    longer = np.append(coefficients, 0.0)
    return np.asarray(longer + reflection * longer[::-1])


def schwarz_order(covariance: Array, count: int) -> tuple[Array, float]:
    """Whitening filter and innovation variance of an autocovariance, of the order that Schwarz's criterion prefers.

    Parameters
    ----------
    covariance : (p + 1,) float
        At lags 0, 1, … p, the largest order; positive definite.
    count : int
        Samples that it was taken from.

    Notes
    -----
    Levinson's recursion. Source: Priestley, Spectral Analysis and Time Series (1981), section 5.4.
    """
    best, best_score = (np.ones(1), float(covariance[0])), count * np.log(covariance[0])
    coefficients, variance = np.ones(1), float(covariance[0])
    for order in range(1, len(covariance)):
        reflection = -float(coefficients @ covariance[order:0:-1]) / variance
        coefficients = extended(coefficients, reflection)
        variance *= 1.0 - reflection**2
        if variance <= 1e-14 * covariance[0]:
            break
        score = count * np.log(variance) + order * np.log(count)
        if score < best_score:
            best, best_score = (coefficients, variance), score
    return best
