"""The usual ways to read a decay, for comparison: logarithmic decrement, half power, FFT grid, matrix pencil.

None of them knows its own uncertainty. ``decay.fit_decay`` is what the rest of the package uses.
"""

from __future__ import annotations

import numpy as np
from scipy.signal import find_peaks

from ssmr_ident.identify.decays.start import matrix_pencil

Array = np.ndarray


def logarithmic_decrement(samples: Array, step: float) -> tuple[float, float]:
    """ω_n [rad/s] and ξ from the first peaks of one sign, down to a fifth of the highest.

    Parameters
    ----------
    samples : (n,) float
        Offset removed.
    step : float [s]

    Returns
    -------
    (omega_n, xi)
        ``nan`` with fewer than three peaks.
    """
    highest = float(np.max(samples))
    spectrum = np.abs(np.fft.rfft(samples - samples.mean()))
    period = len(samples) / max(int(np.argmax(spectrum)), 1)
    peaks, _ = find_peaks(samples, height=0.2 * highest, distance=max(1, int(0.7 * period)))
    if len(peaks) < 3:
        return np.nan, np.nan
    slope = float(np.polyfit(np.arange(len(peaks)), np.log(samples[peaks]), 1)[0])
    damped = 2 * np.pi / (float(np.polyfit(np.arange(len(peaks)), peaks, 1)[0]) * step)
    rate = -slope * damped / (2 * np.pi)
    natural = float(np.hypot(damped, rate))
    return natural, rate / natural


def half_power(samples: Array, step: float) -> tuple[float, float]:
    """ω_n [rad/s] and ξ from the width of the amplitude spectrum at 1/√2 of its peak, zero-padded 8 times."""
    size = 8 * len(samples)
    amplitude = np.abs(np.fft.rfft(samples - samples.mean(), size))
    frequency = np.fft.rfftfreq(size, step)
    first = int(np.searchsorted(frequency, 1.0))
    peak = first + int(np.argmax(amplitude[first:]))
    level = amplitude[peak] / np.sqrt(2.0)
    below, above = np.flatnonzero(amplitude[:peak] < level), np.flatnonzero(amplitude[peak:] < level)
    if len(below) == 0 or len(above) == 0:
        return np.nan, np.nan
    width = frequency[peak + above[0]] - frequency[below[-1]]
    return 2 * np.pi * float(frequency[peak]), float(width / (2 * frequency[peak]))


def fft_grid(samples: Array, step: float) -> tuple[float, float]:
    """ω_n [rad/s] and ξ as the thesis does: highest FFT bin, and λ read off the envelope (5.9).

    The eye is replaced by a line through the logarithm of the peaks.
    """
    amplitude = np.abs(np.fft.rfft(samples - samples.mean()))
    frequency = np.fft.rfftfreq(len(samples), step)
    first = int(np.searchsorted(frequency, 1.0))
    damped = 2 * np.pi * float(frequency[first + int(np.argmax(amplitude[first:]))])
    natural, xi = logarithmic_decrement(samples, step)
    rate = natural * xi
    total = float(np.hypot(damped, rate))
    return total, rate / total


def pencil(samples: Array, step: float, modes: int = 1, points: int = 256) -> list[tuple[float, float]]:
    """ω_n [rad/s] and ξ of each mode by the matrix pencil on block averages, slowest first."""
    block = max(1, len(samples) // points)
    whole = len(samples) // block * block
    poles = matrix_pencil((samples - samples.mean())[:whole].reshape(-1, block).mean(axis=1), step * block, modes)
    poles = poles[np.argsort(np.abs(poles))]
    return [(float(abs(pole)), float(-pole.real / abs(pole))) for pole in poles]
