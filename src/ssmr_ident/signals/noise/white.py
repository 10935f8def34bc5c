"""How large white noise is: by differences, a median, the quietest part of a spectrum, or a converter's steps."""

from __future__ import annotations

import math

import numpy as np

from ssmr_ident.signals.spectra import power_density

Array = np.ndarray

NORMAL = 1.4826
"""Standard deviation of normal numbers over the median of their absolute values."""


def white_std(samples: Array, least: float | None = None) -> float:
    """Standard deviation of white noise by the median of second differences, which a slow motion hardly enters.

    Parameters
    ----------
    samples : (n,) float [any unit]
    least : float, optional
        The answer at the least. None: above zero, where samples have no differences at all.

    Examples
    --------
    >>> noise = np.random.default_rng(0).standard_normal(2000)
    >>> bool(abs(white_std(noise + np.linspace(0.0, 500.0, 2000)) - 1.0) < 0.05)
    True
    """
    spread = NORMAL * float(np.median(np.abs(np.diff(samples, 2)))) / np.sqrt(6.0)
    if least is not None:
        result: float = max(spread, least)
        return result
    return spread if spread > 0 else max(float(np.std(samples)), 1e-300) * 1e-6


def third_difference_std(samples: Array) -> float:
    """As ``white_std``, by third differences, in which a motion shows less yet; above zero always."""
    return float(np.median(np.abs(np.diff(samples, 3)))) / 0.6745 / math.sqrt(20.0) + 1e-300


def force_noise(force: Array) -> float:
    """Standard deviation of a pull's noise [N]; ramps do not enter second differences, and few teeth disturb them."""
    return white_std(force, 1e-9 * (float(np.ptp(force)) + 1e-12))


def median_std(residual: Array) -> Array:
    """Standard deviation by the median of absolute values, few large ones notwithstanding; of each column, (…,)."""
    result: Array = NORMAL * np.median(np.abs(residual), axis=0)
    return result


def quietest_density(samples: Array, sample_rate: float) -> Array:
    """One-sided density of white noise per channel, from the quietest tenth of the spectrum above 1 Hz.

    An upper bound where motion fills the whole band.

    Parameters
    ----------
    samples : (n, c) float [any unit]
    sample_rate : float [Hz]

    Returns
    -------
    (c,) float [unit²/Hz]
    """
    density = power_density(samples, sample_rate, band_hz=(1.0, 0.45 * sample_rate), width_hz=2.0).density
    return np.asarray(np.quantile(density, 0.1, axis=0))


def rounding(samples: np.ndarray) -> float:
    """Standard deviation of what a converter, or the digits of a log, rounded away; 0 where values hardly repeat.

    The step is the least distance of two values that occur. The deviation is that of rounding errors spread evenly,
    step/√12 (Widrow 1956).

    Parameters
    ----------
    samples : (n,) float [any unit]
        As logged.

    Examples
    --------
    >>> round(rounding(np.round(np.sin(np.arange(99.0)), 1)) * 12**0.5, 6)
    0.1
    """
    values = np.unique(samples)
    if not 1 < len(values) <= len(samples) / 2:
        return 0.0
    steps = np.diff(values)
    return float(np.min(steps[steps > 1e-9 * (values[-1] - values[0])])) / math.sqrt(12.0)


def usable_band(position: Array, step: float) -> float:
    """Highest frequency [Hz] at which the motion stands ten times above the position's noise, in amplitude."""
    centred = position - np.linspace(position[0], position[-1], len(position))
    power = np.abs(np.fft.rfft(centred * np.hanning(len(position)))) ** 2
    frequency = np.fft.rfftfreq(len(position), step)
    width = max(3, len(power) // 400)
    smooth = np.convolve(power, np.ones(width) / width, mode="same")
    floor = float(np.median(smooth[len(smooth) // 2 :]))
    below = np.flatnonzero(smooth[width:] < 100 * floor)
    first = frequency[width + below[0]] if len(below) else 0.1 / step
    return float(np.clip(first, 5.0 / (len(position) * step), 0.2 / step))
