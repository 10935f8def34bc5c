"""The highest lines of a spectrum, and the amplitude of a log (thesis section 3.2)."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from ssmr_ident.core.errors import InputError
from ssmr_ident.core.frame import frame
from ssmr_ident.core.shown import Shown
from ssmr_ident.signals.checks import checked_samples
from ssmr_ident.signals.filters import SWIVEL_LOW_PASS_HZ, low_pass
from ssmr_ident.signals.spectra import Spectrum

if TYPE_CHECKING:
    import pandas as pd

COUNT = 3
BAND_HZ = (1.0, 50.0)
SPACING_HZ = 1.0


@dataclass(frozen=True)
class Peaks(Shown):
    """Local maxima of an amplitude spectrum, highest first.

    Parameters
    ----------
    frequency : (k,) float [Hz]
        On the bins of the spectrum, as in the thesis' tables; k may be less than asked for.
    amplitude : (k,) float
        In the unit of the samples.
    resolution : float [Hz]
        Distance of two bins; a line between two bins is seen up to half of it off and up to 36 % too small.
    """

    frequency: np.ndarray
    amplitude: np.ndarray
    resolution: float

    def __len__(self) -> int:
        return len(self.frequency)

    def to_frame(self) -> pd.DataFrame:
        """A row a peak, the highest first: ``frequency_hz``, ``amplitude`` in the unit of the samples."""
        pairs = zip(self.frequency, self.amplitude, strict=True)
        rows = ({"frequency_hz": f, "amplitude": a} for f, a in pairs)
        return frame(rows, ("frequency_hz", "amplitude"), resolution_hz=self.resolution)

    def __str__(self) -> str:
        if not len(self):
            return "no peak"
        pairs = zip(self.frequency, self.amplitude, strict=True)
        return ", ".join(f"{f:.2f} Hz ({a:.3g})" for f, a in pairs) + f"; bins of {self.resolution:.3g} Hz"


def find_peaks(
    spectrum: Spectrum,
    *,
    count: int = COUNT,
    band_hz: tuple[float, float] = BAND_HZ,
    spacing_hz: float = SPACING_HZ,
) -> Peaks:
    """The ``count`` highest local maxima in a band, at least ``spacing_hz`` apart, sorted by height.

    The highest maximum is taken first and those closer to it than the spacing are dropped, then the next
    highest, as Matlab's ``findpeaks`` does. Neighbours outside the band count in judging whether a bin is a
    maximum. A plateau is one maximum, at its middle (the lower of two middles).

    Parameters
    ----------
    spectrum : Spectrum
    count : int
    band_hz : (float, float) [Hz]
        Both edges belong to the band.
    spacing_hz : float [Hz]

    Returns
    -------
    Peaks
    """
    if count < 1 or spacing_hz < 0 or band_hz[1] < band_hz[0]:
        raise InputError("peaks", f"count {count}, spacing {spacing_hz:g} Hz, band {band_hz} Hz make no search")
    frequency, amplitude = spectrum.frequency, spectrum.amplitude
    maxima = _local_maxima(amplitude)
    rounding = 1e-9 * spectrum.resolution
    inside = (frequency[maxima] >= band_hz[0] - rounding) & (frequency[maxima] <= band_hz[1] + rounding)
    maxima = maxima[inside]
    chosen: list[int] = []
    for index in maxima[np.argsort(-amplitude[maxima], kind="stable")]:
        if all(abs(frequency[index] - frequency[other]) >= spacing_hz - rounding for other in chosen):
            chosen.append(int(index))
        if len(chosen) == count:
            break
    return Peaks(frequency[chosen], amplitude[chosen], spectrum.resolution)


def _local_maxima(values: np.ndarray) -> np.ndarray:
    """Indices of values higher than what is left and right of them; the middle of a plateau."""
    starts = np.flatnonzero(np.r_[True, np.diff(values) != 0])
    levels = values[starts]
    ends = np.r_[starts[1:], len(values)] - 1
    top = np.flatnonzero((levels[1:-1] > levels[:-2]) & (levels[1:-1] > levels[2:])) + 1
    result: np.ndarray = (starts[top] + ends[top]) // 2
    return result


def log_amplitude(samples: np.ndarray, sample_rate: float, cutoff_hz: float = SWIVEL_LOW_PASS_HZ) -> float | np.ndarray:
    """Amplitude of a log: (max − min)/2 of the low-passed samples.

    The first and the last sample come through the filter as they are (see ``filters``): take the mains off first
    where the hum is not small beside the vibration, as ``analyse`` does.

    Parameters
    ----------
    samples : (n,) or (n, k) float [any unit]
    sample_rate, cutoff_hz : float [Hz]

    Returns
    -------
    float or (k,) float, in the unit of the samples

    Examples
    --------
    >>> t = np.arange(5000) / 1000
    >>> round(log_amplitude(9.8 + 0.5 * np.sin(2 * np.pi * 8 * t), 1000.0), 3)
    0.5
    """
    kept = low_pass(checked_samples(samples, sample_rate), sample_rate, cutoff_hz)
    half = np.ptp(kept, axis=0) / 2
    return float(half) if np.ndim(half) == 0 else half
