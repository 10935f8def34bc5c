"""The mains hum of a record and its offset: found and taken off by least squares, never by a filter that rings."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from ssmr_ident.core.errors import InputError
from ssmr_ident.core.shown import Shown
from ssmr_ident.signals.checks import checked_samples

MAINS_HZ = 60.0


@dataclass(frozen=True)
class Line(Shown):
    """A sine ``amplitude·cos(2π·frequency·t + phase)`` in a record, t from its first sample.

    Parameters
    ----------
    frequency : float [Hz]
    amplitude : float
        In the unit of the samples.
    phase : float [rad]
    amplitude_std : float
        Standard deviation of the amplitude, from the power around the line (not of the whole record).
    """

    frequency: float
    amplitude: float
    phase: float
    amplitude_std: float

    def __str__(self) -> str:
        return f"{self.amplitude:.4g} ± {self.amplitude_std:.2g} at {self.frequency:.3f} Hz"

    def samples(self, n: int, sample_rate: float) -> np.ndarray:
        """The sine itself, (n,) float in the unit of the samples."""
        result: np.ndarray = self.amplitude * np.cos(
            2 * np.pi * self.frequency * np.arange(n) / sample_rate + self.phase
        )
        return result


def offset(samples: np.ndarray, sample_rate: float, until: float = math.inf) -> float | np.ndarray:
    """Mean of the samples before ``until`` [s]; the sensor's zero when nothing has happened by then.

    Parameters
    ----------
    samples : (n,) or (n, k) float [any unit]
    sample_rate : float [Hz]
    until : float [s]
        From the first sample.
    """
    array = checked_samples(samples, sample_rate, least=1)
    count = len(array) if math.isinf(until) else round(until * sample_rate)
    if count < 1:
        raise InputError("offset", f"no sample before {until:g} s", "Take a later time.")
    mean = array[:count].mean(axis=0)
    return float(mean) if np.ndim(mean) == 0 else mean


def shows_mains(count: int, sample_rate: float, mains_hz: float = MAINS_HZ) -> bool:
    """Whether a record of so many samples is dense and long enough for ``mains_line``."""
    return sample_rate > 2 * mains_hz and count * mains_hz >= 4 * sample_rate


def mains_line(samples: np.ndarray, sample_rate: float, mains_hz: float = MAINS_HZ) -> Line:
    """Amplitude and phase of the mains hum: least squares of offset, slope, cosine and sine at ``mains_hz``.

    Parameters
    ----------
    samples : (n,) float [any unit]
    sample_rate, mains_hz : float [Hz]
        Where the mains may wander, pass ``mains_frequency``'s answer.

    Raises
    ------
    InputError
        ``mains_hz`` at or above half the sample rate (the hum then shows elsewhere and cannot be told from
        vibration), or a record shorter than four periods (the four unknowns are then poorly told apart).

    Examples
    --------
    >>> t = np.arange(2000) / 1000
    >>> round(mains_line(2.6 + 0.02 * np.cos(2 * np.pi * 60 * t + 1), 1000.0).amplitude, 9)
    0.02
    """
    array = checked_samples(samples, sample_rate)
    if array.ndim != 1:
        raise InputError("samples", f"shape {array.shape}; the mains line is taken of one channel")
    if mains_hz >= sample_rate / 2:
        raise InputError(
            "sample rate",
            f"{sample_rate:g} Hz cannot show {mains_hz:g} Hz",
            "The hum is folded to another frequency in such a log.",
        )
    n = len(array)
    if n * mains_hz < 4 * sample_rate:
        raise InputError("samples", f"{n / sample_rate:.3g} s hold fewer than four periods of {mains_hz:g} Hz")
    angle = 2 * np.pi * mains_hz * np.arange(n) / sample_rate
    columns = np.stack([np.ones(n), np.linspace(-1, 1, n), np.cos(angle), np.sin(angle)], axis=1)
    solution = np.linalg.lstsq(columns, array, rcond=None)[0]
    cosine, sine = solution[2:]
    rest = array - columns @ solution
    return Line(
        float(mains_hz),
        float(np.hypot(cosine, sine)),
        float(np.arctan2(-sine, cosine)),
        _amplitude_std(rest, sample_rate, mains_hz),
    )


def _amplitude_std(rest: np.ndarray, sample_rate: float, mains_hz: float) -> float:
    """From the mean power of the bins within ±16 of the line: a bin's cosine part has the variance 2·|X|²/n²."""
    n = len(rest)
    centre = round(mains_hz * n / sample_rate)
    power = np.abs(np.fft.rfft(rest)) ** 2
    around = power[max(1, centre - 16) : centre + 17]
    return float(np.sqrt(2 * around.mean()) / n)


def mains_frequency(
    samples: np.ndarray, sample_rate: float, mains_hz: float = MAINS_HZ, within_hz: float = 0.2
) -> float:
    """Frequency of the mains hum near its nominal value [Hz].

    The highest point of the transform within ``within_hz`` (grids hold ±0.2 Hz in ordinary operation), on a grid
    eight times finer than the bins and then by a parabola: the grid's own step is 1/(8·T).
    """
    array = checked_samples(samples, sample_rate)
    n = len(array)
    mains_line(array, sample_rate, mains_hz)  # the same demands on record and rate
    step = sample_rate / (8 * n)
    half = max(1, math.ceil(within_hz / step))
    grid = mains_hz + step * np.arange(-half, half + 1)
    # A Hann window keeps a neighbouring vibration's side lobes from pulling the line.
    tapered = (array - array.mean()) * np.hanning(n)
    turns = np.arange(n) / sample_rate
    height = np.array([abs(np.vdot(np.exp(2j * np.pi * f * turns), tapered)) for f in grid])
    top = int(np.argmax(height))
    if top in (0, len(grid) - 1):
        return float(grid[top])
    left, middle, right = height[top - 1 : top + 2]
    curvature = left - 2 * middle + right
    return float(grid[top] + (0.0 if curvature == 0 else step * (left - right) / (2 * curvature)))


def remove_mains(
    samples: np.ndarray, sample_rate: float, mains_hz: float = MAINS_HZ, *, harmonics: int = 1
) -> np.ndarray:
    """Samples without the mains line (and its multiples below half the sample rate).

    Takes off one sine per harmonic and leaves everything else as it was: no notch, so no ringing at the edges or
    after a shock.

    Parameters
    ----------
    samples : (n,) float [any unit]
    sample_rate, mains_hz : float [Hz]
    harmonics : int
        1: the line itself; 2: also twice its frequency; …
    """
    array = checked_samples(samples, sample_rate)
    cleaned = array.copy()
    for multiple in range(1, harmonics + 1):
        if multiple == 1 or multiple * mains_hz < sample_rate / 2:
            cleaned -= mains_line(cleaned, sample_rate, multiple * mains_hz).samples(len(array), sample_rate)
    return cleaned
