"""Thesis section 3.2 for one channel: filter, choose the samples, transform, and read off peaks and amplitude."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy import signal

from ssmr_ident.core.shown import Shown
from ssmr_ident.signals import filters
from ssmr_ident.signals.checks import checked_samples
from ssmr_ident.signals.lines import Lines, read_lines
from ssmr_ident.signals.noise import hum
from ssmr_ident.signals.peaks import BAND_HZ, Peaks, find_peaks
from ssmr_ident.signals.spectra import SWIVEL_LENGTH, SampleRange, Spectrum, amplitude_spectrum, select_range


@dataclass(frozen=True)
class AnalysisOptions:
    """Choices of an analysis; the defaults are the thesis' for swivel logs.

    Parameters
    ----------
    part : str
        Samples transformed, as ``select_range`` takes it.
    length : int
        Samples of ``middle``, ``beginning`` and ``end``.
    low_pass_hz : float [Hz]
        For the trace and the amplitude of the log.
    half_width_hz : float [Hz]
        Of the band-pass around the main peak.
    band_hz : (float, float) [Hz]
        Where peaks are searched.
    """

    part: str = "middle"
    length: int = SWIVEL_LENGTH
    low_pass_hz: float = filters.SWIVEL_LOW_PASS_HZ
    half_width_hz: float = filters.BAND_HALF_WIDTH_HZ
    band_hz: tuple[float, float] = BAND_HZ


@dataclass(frozen=True, eq=False)
class ChannelAnalysis(Shown):
    """What section 3.2 says of one channel of one log.

    Parameters
    ----------
    samples : (n,) float [unit of the channel]
        As logged.
    low_passed : (n,) float [unit of the channel]
        Without the mains line where the rate shows it: a zero-phase filter keeps the first and the last sample,
        and with it the hum in them, which at small vibration would decide (max − min)/2.
    band_passed : (n,) float or None [unit of the channel]
        Around the highest peak, without mean; None without a peak or for a log shorter than the band is narrow.
    sample_rate, start : float [Hz, s]
    part : SampleRange
    spectrum : Spectrum
        Of the unfiltered samples in ``part``: a line is shown with its own height up to the edge of the band,
        where the low-pass would have halved it.
    peaks : Peaks
        On the bins of the spectrum.
    lines : Lines
        The same peaks between the bins, with errors.
    amplitude : float [unit of the channel]
        (max − min)/2 of ``low_passed``.
    mains : Line or None
        The 60 Hz line; None where the rate cannot show it.
    """

    samples: np.ndarray
    low_passed: np.ndarray
    band_passed: np.ndarray | None
    sample_rate: float
    start: float
    part: SampleRange
    options: AnalysisOptions
    spectrum: Spectrum
    peaks: Peaks
    lines: Lines
    amplitude: float
    mains: hum.Line | None

    @property
    def time(self) -> np.ndarray:
        """(n,) float [s]."""
        return self.start + np.arange(len(self.samples)) / self.sample_rate

    @property
    def band_envelope(self) -> np.ndarray | None:
        """Momentary amplitude of ``band_passed``, (n,) float: the length of its analytic signal."""
        return None if self.band_passed is None else np.abs(signal.hilbert(self.band_passed))

    @property
    def slower_line_hz(self) -> float | None:
        """Frequency of a line under the searched band that is higher than every peak; None without one [Hz]."""
        below = (self.spectrum.frequency > 0) & (self.spectrum.frequency < self.options.band_hz[0])
        if not below.any():
            return None
        frequency, amplitude = self.spectrum.frequency[below], self.spectrum.amplitude[below]
        top = int(np.argmax(amplitude))
        highest = self.peaks.amplitude[0] if len(self.peaks) else 0.0
        return float(frequency[top]) if amplitude[top] > highest else None

    def __str__(self) -> str:
        mains = "not visible" if self.mains is None else str(self.mains)
        return f"amplitude {self.amplitude:.4g}, peaks {self.lines}, mains {mains}, {self.part}"


def analyse(
    samples: np.ndarray, sample_rate: float, options: AnalysisOptions | None = None, *, start: float = 0.0
) -> ChannelAnalysis:
    """Filter, transform and measure one channel.

    Parameters
    ----------
    samples : (n,) float [any unit]
    sample_rate : float [Hz]
    options : AnalysisOptions
    start : float [s]
        Time of the first sample, for ``T0:T1`` ranges.

    Raises
    ------
    InputError
        A log or a range too short (see the functions that this one calls).
    """
    options = options or AnalysisOptions()
    array = checked_samples(samples, sample_rate, least=8)
    part = select_range(len(array), sample_rate, options.part, length=options.length, start=start)
    spectrum = amplitude_spectrum(array[part.indices], sample_rate)
    peaks = find_peaks(spectrum, band_hz=options.band_hz)
    lines = read_lines(array[part.indices], spectrum, peaks)
    duration = len(array) / sample_rate
    mains = hum.mains_line(array, sample_rate) if hum.shows_mains(len(array), sample_rate) else None
    humless = array
    if mains is not None and options.low_pass_hz < hum.MAINS_HZ:
        humless = array - mains.samples(len(array), sample_rate)
    low_passed = filters.low_pass(humless, sample_rate, options.low_pass_hz)
    band_passed = None
    if len(peaks) and duration * 2 * options.half_width_hz >= 1:
        band_passed = filters.band_pass(
            array, sample_rate, float(lines.frequency[0]), half_width_hz=options.half_width_hz
        )
    return ChannelAnalysis(
        samples=array,
        low_passed=low_passed,
        band_passed=band_passed,
        sample_rate=float(sample_rate),
        start=float(start),
        part=part,
        options=options,
        spectrum=spectrum,
        peaks=peaks,
        lines=lines,
        amplitude=float(np.ptp(low_passed) / 2),
        mains=mains,
    )
