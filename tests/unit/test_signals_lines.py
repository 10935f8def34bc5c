"""A peak between the bins: sines and decays of any frequency, phase and noise, and the errors stated of them."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pytest

from ssmr_ident.signals.lines import Lines, read_lines
from ssmr_ident.signals.peaks import find_peaks
from ssmr_ident.signals.spectra import amplitude_spectrum

RATE = 1000.0


def highest(samples: np.ndarray) -> Lines:
    spectrum = amplitude_spectrum(samples, RATE)
    return read_lines(samples, spectrum, find_peaks(spectrum, count=1))


def test_one_second_of_a_sine_is_known_to_the_last_digits() -> None:
    time = np.arange(1000) / RATE
    found = highest(2.6 + np.sin(2 * np.pi * 8.35 * time + 0.4))
    assert found.frequency[0] == pytest.approx(8.35, abs=1e-6)


def test_a_damped_line_is_read_as_its_pole_and_called_wide() -> None:
    time = np.arange(2000) / RATE
    found = highest(np.exp(-4.0 * time) * np.cos(2 * np.pi * 7.13 * time + 2.0))
    assert found.frequency[0] == pytest.approx(7.13, abs=1e-6)
    assert found.width[0] == pytest.approx(4.0 / np.pi, rel=1e-5)
    assert found.wide(0)


def test_a_maximum_of_noise_says_so_by_its_error() -> None:
    found = highest(np.random.default_rng(5).standard_normal(1000))
    assert found.frequency_std[0] > 0.1
    assert not found.wide(0)


def plain(random: np.random.Generator, time: np.ndarray, f: float) -> np.ndarray:
    return np.cos(2 * np.pi * f * time + random.uniform(0, 2 * np.pi))


def damped(random: np.random.Generator, time: np.ndarray, f: float) -> np.ndarray:
    rate = 10 ** random.uniform(-0.5, 1.0) * np.pi / time[-1]
    return np.exp(-rate * time) * plain(random, time, f)


def among_others(random: np.random.Generator, time: np.ndarray, f: float) -> np.ndarray:
    """Beside a second line two to five bins away, mains, a trend and a mean."""
    beside = plain(random, time, f + random.uniform(2, 5) / time[-1]) * random.uniform(0.3, 0.5)
    return plain(random, time, f) + beside + 2 * plain(random, time, 60.0) + random.uniform(-1, 1) * time + 2.6


@pytest.mark.slow
@pytest.mark.parametrize(("signal", "periods", "worst"), [(plain, 3, 0.1), (damped, 8, 0.4), (among_others, 3, 0.25)])
def test_the_stated_error_covers_the_truth(
    signal: Callable[[np.random.Generator, np.ndarray, float], np.ndarray], periods: int, worst: float
) -> None:
    random = np.random.default_rng(20)
    missed, bins = [], []
    for _ in range(150):
        time = np.arange(random.integers(700, 4000)) / RATE
        f = random.uniform(periods / time[-1], 45.0)
        clean = signal(random, time, f)
        noise = np.linalg.norm(clean) / 10 ** random.uniform(1.2, 4)
        found = highest(clean + noise * random.standard_normal(len(time)))
        missed.append((found.frequency[0] - f) / found.frequency_std[0])
        bins.append(abs(found.frequency[0] - f) / found.resolution)
    assert np.mean(np.abs(missed) < 2) > 0.88
    assert np.mean(np.abs(missed) < 1) < 0.85
    assert np.quantile(bins, 0.95) < worst
