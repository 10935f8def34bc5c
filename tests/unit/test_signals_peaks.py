"""Peak search: spacing, band, plateaus, order; amplitude of a log; the two modes of a real hammer test."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from ssmr_ident.core.errors import InputError
from ssmr_ident.signals.peaks import find_peaks, log_amplitude
from ssmr_ident.signals.spectra import Spectrum, amplitude_spectrum, select_range


def spectrum_of(lines: dict[float, float], resolution: float = 0.25) -> Spectrum:
    """Single bins raised over a falling floor."""
    frequency = np.arange(0, 100 + resolution / 2, resolution)
    amplitude = 1e-3 / (1 + frequency)
    for place, height in lines.items():
        amplitude[round(place / resolution)] = height
    return Spectrum(frequency, amplitude, 200.0, 2 * (len(frequency) - 1))


def test_three_highest_sorted_by_height() -> None:
    found = find_peaks(spectrum_of({5: 0.3, 12: 0.9, 20: 0.1, 30: 0.5}))
    np.testing.assert_allclose(found.frequency, [12, 30, 5])
    np.testing.assert_allclose(found.amplitude, [0.9, 0.5, 0.3])


def test_spacing_counts_from_one_hertz_on() -> None:
    found = find_peaks(spectrum_of({10: 1.0, 10.5: 0.9, 11: 0.8, 11.75: 0.7}))
    np.testing.assert_allclose(found.frequency, [10, 11])


def test_a_dropped_peak_drops_nobody() -> None:
    """10.75 falls to 10; 11.5 is near 10.75 only and stays."""
    found = find_peaks(spectrum_of({10: 1.0, 10.75: 0.9, 11.5: 0.7}))
    np.testing.assert_allclose(found.frequency, [10, 11.5])


def test_band_edges_belong_to_the_band() -> None:
    found = find_peaks(spectrum_of({0.75: 3.0, 2.0: 1.0, 50.0: 0.5, 60.0: 9.0}))
    np.testing.assert_allclose(found.frequency, [2.0, 50.0])


def test_a_slope_reaching_into_the_band_is_no_peak() -> None:
    spectrum = spectrum_of({})
    assert len(find_peaks(spectrum)) == 0
    assert str(find_peaks(spectrum)) == "no peak"


def test_a_plateau_is_one_peak_at_its_middle() -> None:
    found = find_peaks(spectrum_of({10.0: 1.0, 10.25: 1.0, 10.5: 1.0}))
    np.testing.assert_allclose(found.frequency, [10.25])


def test_silence_has_no_peak() -> None:
    assert len(find_peaks(amplitude_spectrum(np.zeros(1024), 1000.0))) == 0


def test_nonsense_is_refused() -> None:
    with pytest.raises(InputError, match="no search"):
        find_peaks(spectrum_of({}), count=0)


def test_amplitude_of_a_log_leaves_out_the_mains() -> None:
    t = np.arange(20000) / 1000
    log = 9.8 + 0.4 * np.sin(2 * np.pi * 8 * t) + 0.4 * np.sin(2 * np.pi * 60 * t)
    assert log_amplitude(log, 1000.0) == pytest.approx(0.4, abs=0.015)
    np.testing.assert_allclose(log_amplitude(np.stack([log, 2 * log], axis=1), 1000.0)[1], 0.8, atol=0.03)


def test_two_modes_of_the_hammer_test(shared: Path) -> None:
    """19.76 and 21.15 Hz by a two-mode fit; the bins of 8 s are 0.125 Hz wide."""
    table = np.genfromtxt(shared / "recordings/lvm_hammer/hit-1.csv", delimiter=",", skip_header=1)
    rate = (len(table) - 1) / (table[-1, 0] - table[0, 0])
    part = select_range(len(table), rate, "all")
    for column in (2, 3):
        found = find_peaks(amplitude_spectrum(table[part.indices, column], rate), count=2)
        np.testing.assert_allclose(np.sort(found.frequency), [19.76, 21.15], atol=0.125)
