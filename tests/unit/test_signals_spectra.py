"""Ranges, amplitude spectra and power densities against closed forms (Parseval, a sine on a bin, white noise)."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from ssmr_ident.core.errors import InputError
from ssmr_ident.signals.spectra import amplitude_spectrum, power_density, select_range

RATE = 1000.0


@pytest.mark.parametrize("n", [512, 513])
def test_power_is_kept(n: int) -> None:
    samples = np.random.default_rng(n).standard_normal(n) + 3
    amplitude = amplitude_spectrum(samples, RATE).amplitude
    power = amplitude[0] ** 2 + np.sum(amplitude[1:] ** 2) / 2
    if n % 2 == 0:
        power += amplitude[-1] ** 2 / 2  # the bin at half the rate is not doubled
    assert power == pytest.approx(np.mean(samples**2), rel=1e-12)


def test_the_bin_at_half_the_rate_shows_its_amplitude() -> None:
    spectrum = amplitude_spectrum(0.3 * np.cos(np.pi * np.arange(64)), RATE)
    assert spectrum.frequency[-1] == RATE / 2
    assert spectrum.amplitude[-1] == pytest.approx(0.3)


@given(st.integers(8, 400), st.floats(0.1, 10.0), st.integers(0, 10_000))
@settings(max_examples=40, deadline=None)
def test_doubling_the_samples_doubles_the_spectrum(n: int, factor: float, seed: int) -> None:
    samples = np.random.default_rng(seed).standard_normal(n)
    one, many = amplitude_spectrum(samples, RATE), amplitude_spectrum(factor * samples, RATE)
    np.testing.assert_allclose(many.amplitude, factor * one.amplitude, rtol=1e-9, atol=1e-12)


@pytest.mark.parametrize(
    ("wanted", "first", "count"),
    [
        ("middle", 1808, 16384),
        ("beginning", 0, 16384),
        ("end", 3616, 16384),
        ("all", 0, 20000),
        ("2:4.5", 2000, 2500),
        (":1", 0, 1000),
        ("19:", 19000, 1000),
        ("18:99", 18000, 2000),
    ],
)
def test_ranges_of_a_swivel(wanted: str, first: int, count: int) -> None:
    part = select_range(20000, RATE, wanted)
    assert (part.first, part.count) == (first, count)


def test_a_short_record_gives_the_largest_power_of_two() -> None:
    part = select_range(1599, 100.0)
    assert (part.first, part.count) == (287, 1024)


def test_the_clock_of_the_record_counts() -> None:
    assert select_range(1000, 100.0, "20:22", start=16.0).first == 400


@pytest.mark.parametrize("wanted", ["midle", "3:2", "a:b", "nan:2", "30:40", "0:0.005", ""])
def test_bad_ranges_are_refused(wanted: str) -> None:
    with pytest.raises(InputError, match="--range"):
        select_range(20000, RATE, wanted)


@pytest.mark.parametrize("rate", [100.0, 512.5, 1000.0, 1023.541])
def test_white_noise_has_the_density_of_its_variance(rate: float) -> None:
    samples = 2.0 * np.random.default_rng(7).standard_normal(int(200 * rate))
    density = power_density(samples, rate)
    assert np.mean(density.density) == pytest.approx(4.0 / (rate / 2), rel=0.03)
    last = 50 if rate > 101 else 49
    np.testing.assert_array_equal(density.frequency, np.arange(1.0, last + 1))


def test_short_or_slow_records_have_no_density() -> None:
    with pytest.raises(InputError, match="too short"):
        power_density(np.zeros(1999), RATE)
    with pytest.raises(InputError, match="holds nothing"):
        power_density(np.zeros(1999), 2.5)


def test_results_print_on_one_line() -> None:
    samples = np.sin(2 * np.pi * 8 * np.arange(4000) / RATE)
    assert "highest line 1 at 8 Hz" in str(amplitude_spectrum(samples, RATE))
    assert "1–50 Hz" in str(power_density(samples, RATE))
