"""Which samples are analysed, and their one-sided amplitude spectrum or power density (thesis section 3.2)."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from scipy import signal

from ssmr_ident.core.errors import InputError, did_you_mean
from ssmr_ident.core.shown import Shown
from ssmr_ident.signals.checks import checked_samples

SWIVEL_LENGTH = 2**14
"""Samples analysed of a 20 000-sample swivel log (thesis 3.2)."""
FREE_RESPONSE_LENGTH = 2**11
"""Samples analysed of a 4096-sample free response, from its beginning (thesis 3.2)."""
RANGES = ("middle", "beginning", "end", "all")


@dataclass(frozen=True)
class SampleRange(Shown):
    """Part of a record: ``count`` samples from index ``first``.

    ``name`` is how it was asked for: one of ``RANGES`` or ``T0:T1`` in seconds.
    """

    name: str
    first: int
    count: int

    @property
    def indices(self) -> slice:
        return slice(self.first, self.first + self.count)

    def __str__(self) -> str:
        return f"{self.name} ({self.count} samples from {self.first})"


def select_range(
    n: int, sample_rate: float, wanted: str = "middle", *, length: int = SWIVEL_LENGTH, start: float = 0.0
) -> SampleRange:
    """Choose the samples to analyse.

    Parameters
    ----------
    n : int
        Samples in the record.
    sample_rate : float [Hz]
    wanted : str
        ``middle``, ``beginning``, ``end``: ``length`` samples, or where the record has fewer the largest power
        of two that it holds; ``all``: every sample; ``T0:T1`` [s]: the samples with T0 ≤ t < T1 on the
        record's own clock, either side left out meaning the end of the record.
    length : int
        2¹⁴ for swivels, 2¹¹ for free responses.
    start : float [s]
        Time of the first sample.

    Raises
    ------
    InputError
        An unknown range, or fewer than 8 samples inside it (less than which no local maximum can be judged).

    Examples
    --------
    >>> select_range(20000, 1000.0)
    SampleRange(name='middle', first=1808, count=16384)
    >>> print(select_range(20000, 1000.0, "2:4"))
    2:4 (2000 samples from 2000)
    """
    if wanted == "all":
        chosen = SampleRange(wanted, 0, n)
    elif wanted in RANGES:
        count = min(length, 2 ** int(math.log2(n))) if n else 0
        first = {"middle": (n - count) // 2, "beginning": 0, "end": n - count}[wanted]
        chosen = SampleRange(wanted, first, count)
    elif ":" in wanted:
        chosen = _time_range(n, sample_rate, wanted, start)
    else:
        raise InputError("--range", f"{wanted!r} is no range", did_you_mean(wanted, (*RANGES, "T0:T1")))
    if chosen.count < 8:
        raise InputError(
            "--range",
            f"{wanted} holds {chosen.count} samples of a record from {start:g} to {start + n / sample_rate:g} s; "
            "8 are the least",
            "Choose a longer range.",
        )
    return chosen


def _time_range(n: int, sample_rate: float, wanted: str, start: float) -> SampleRange:
    left, _, right = wanted.partition(":")
    try:
        from_time = float(left) if left.strip() else -math.inf
        to_time = float(right) if right.strip() else math.inf
    except ValueError:
        raise InputError("--range", f"{wanted!r}: T0 and T1 are seconds", "Write for example 0.5:4.5.") from None
    if math.isnan(from_time) or math.isnan(to_time) or to_time <= from_time:
        raise InputError("--range", f"{wanted!r} is empty", "T0 comes before T1.")
    # A time that is a sample's own up to rounding belongs to that sample.
    edges = [(t - start) * sample_rate - 1e-6 for t in (from_time, to_time)]
    first, stop = (int(np.clip(np.ceil(edge) if np.isfinite(edge) else edge, 0, n)) for edge in edges)
    return SampleRange(wanted, first, max(stop - first, 0))


@dataclass(frozen=True)
class Spectrum(Shown):
    """One-sided amplitude spectrum of a part of a record.

    Parameters
    ----------
    frequency : (m,) float [Hz]
        m = count//2 + 1, from 0 in steps of sample_rate/count.
    amplitude : (m,) float
        In the unit of the samples: a sine of amplitude A on a bin shows A. Not windowed, mean kept at 0 Hz.
    sample_rate : float [Hz]
    count : int
        Samples transformed.
    """

    frequency: np.ndarray
    amplitude: np.ndarray
    sample_rate: float
    count: int

    @property
    def resolution(self) -> float:
        """Distance of two bins [Hz]."""
        return self.sample_rate / self.count

    def __str__(self) -> str:
        top = 1 + int(np.argmax(self.amplitude[1:]))
        return (
            f"amplitude spectrum of {self.count} samples at {self.sample_rate:g} Hz, "
            f"bins of {self.resolution:.4g} Hz, mean {self.amplitude[0]:.4g}, "
            f"highest line {self.amplitude[top]:.4g} at {self.frequency[top]:.4g} Hz"
        )


def amplitude_spectrum(samples: np.ndarray, sample_rate: float) -> Spectrum:
    """|DFT|/n, doubled except at 0 Hz (appendix A) and, for even n, at half the sample rate.

    The bin at half the sample rate is its own mirror image, so doubling it (as "all other bins doubled" would say)
    would show twice the amplitude of what is there; it lies far above the 50 Hz of the peak search at 1 kHz.

    Parameters
    ----------
    samples : (n,) float [any unit]
    sample_rate : float [Hz]

    Examples
    --------
    >>> t = np.arange(1000) / 1000
    >>> spectrum = amplitude_spectrum(2.6 + 0.5 * np.sin(2 * np.pi * 8 * t), 1000.0)
    >>> [round(float(a), 12) for a in spectrum.amplitude[[0, 8]]]
    [2.6, 0.5]
    """
    array = checked_samples(samples, sample_rate, least=8)
    if array.ndim != 1:
        raise InputError("samples", f"shape {array.shape}; a spectrum is taken of one channel")
    n = len(array)
    amplitude = np.abs(np.fft.rfft(array)) / n
    mirrored = slice(1, -1) if n % 2 == 0 else slice(1, None)
    amplitude[mirrored] *= 2
    return Spectrum(np.arange(n // 2 + 1) * (sample_rate / n), amplitude, float(sample_rate), n)


@dataclass(frozen=True)
class PowerDensity(Shown):
    """Power spectral density.

    Parameters
    ----------
    frequency : (m,) float [Hz]
        Centres of bins ``width_hz`` apart.
    density : (m,) or (m, k) float [unit²/Hz]
    width_hz : float [Hz]
    """

    frequency: np.ndarray
    density: np.ndarray
    width_hz: float

    def __str__(self) -> str:
        return (
            f"power density {self.frequency[0]:g}–{self.frequency[-1]:g} Hz, bins of {self.width_hz:g} Hz, "
            f"{self.density.min():.3g} … {self.density.max():.3g} unit²/Hz"
        )


def power_density(
    samples: np.ndarray,
    sample_rate: float,
    *,
    band_hz: tuple[float, float] = (1.0, 50.0),
    width_hz: float = 1.0,
) -> PowerDensity:
    """Welch's estimate, bins ``width_hz`` apart: Hann segments of 1/width_hz seconds, half overlapping.

    Records of any rate and length give the same bins (1, 2, … 50 Hz), so two of them can be compared bin by
    bin; at rates of 100 Hz and below the bins end under half the sample rate. Each segment's mean is taken off.
    Where 1/width_hz is not a whole number of samples, segments are up to one sample longer and the density is
    read at the bin centres by interpolation.

    Parameters
    ----------
    samples : (n,) or (n, k) float [any unit]
    sample_rate : float [Hz]
    band_hz : (float, float) [Hz]
    width_hz : float [Hz]

    Raises
    ------
    InputError
        A record shorter than two segments (a variance needs more than one), or a rate too low for the band.
    """
    array = checked_samples(samples, sample_rate)
    segment = math.ceil(sample_rate / width_hz - 1e-6)
    if len(array) < 2 * segment:
        raise InputError(
            "samples",
            f"{len(array) / sample_rate:.3g} s are too short for a power density {width_hz:g} Hz fine; "
            f"{2 / width_hz:g} s are needed",
            "Take a longer part of the log.",
        )
    centres = np.arange(band_hz[0], band_hz[1] + 1e-9 * width_hz, width_hz)
    centres = centres[centres <= sample_rate / 2 - width_hz / 2]
    if not len(centres):
        raise InputError(
            "sample rate",
            f"{sample_rate:g} Hz holds nothing of the band {band_hz[0]:g}–{band_hz[1]:g} Hz",
            "Log faster or compare a lower band.",
        )
    frequency, density = signal.welch(array, sample_rate, "hann", segment, segment // 2, detrend="constant", axis=0)
    columns = density.reshape(len(frequency), -1).T
    read = np.stack([np.interp(centres, frequency, column) for column in columns], axis=-1)
    return PowerDensity(centres, read.reshape((len(centres), *array.shape[1:])), width_hz)
