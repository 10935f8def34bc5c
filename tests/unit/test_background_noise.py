"""Noise of any colour, told from stretches in some of which something else is left."""

from __future__ import annotations

import math

import numpy as np
import pytest
from scipy.signal import lfilter

from ssmr_ident.signals.noise import background_noise, independent_samples

STRETCHES, LENGTH = 9, 400


def noise_of(share: float, corner_hz: float, random: np.random.Generator) -> list[np.ndarray]:
    """White noise of unit variance, a share of it first-order coloured; sampled at 200 Hz."""
    keep = math.exp(-2.0 * math.pi * corner_hz / 200.0)
    found = []
    for _ in range(STRETCHES):
        slow = lfilter([1.0], [1.0, -keep], math.sqrt(1.0 - keep**2) * random.standard_normal(LENGTH + 500))[500:]
        found.append(math.sqrt(1.0 - share) * random.standard_normal(LENGTH) + math.sqrt(share) * slow)
    return found


@pytest.mark.parametrize(("share", "corner_hz"), [(0.0, 10.0), (0.5, 5.0), (0.9, 10.0), (0.9, 30.0)])
def test_noise_is_white_through_its_own_filter(share: float, corner_hz: float) -> None:
    stretches = noise_of(share, corner_hz, np.random.default_rng(1))
    model = background_noise(stretches, 8)
    white = [model.whiten(s) for s in stretches]
    assert np.std(np.concatenate(white)) == pytest.approx(1.0, abs=0.06)
    assert sum(map(independent_samples, white)) > 0.9 * sum(map(len, white))
    assert (model.order == 0) is (share == 0.0)


def test_few_windows_know_the_size_without_bias() -> None:
    """Nine stretches of little more than a window, a hundred times, by noise that was not looked at."""
    random = np.random.default_rng(3)
    sizes = []
    for _ in range(100):
        model = background_noise([s[:170] for s in noise_of(0.0, 10.0, random)], 8)
        sizes.append(np.mean([model.whiten(s).var() for s in noise_of(0.0, 10.0, random)]))
    assert np.mean(sizes) == pytest.approx(1.0, abs=0.03)


def test_what_most_windows_hold_beside_it_is_no_noise() -> None:
    """A decaying line ten times as loud as the noise where it begins."""
    random = np.random.default_rng(2)
    quiet = noise_of(0.5, 10.0, random)
    time = np.arange(LENGTH) / 200.0
    loud = [s + 10.0 * np.exp(-4.0 * time) * np.sin(2.0 * np.pi * 6.0 * time + random.uniform(0.0, 6.0)) for s in quiet]
    frequency = np.linspace(2.0, 95.0, 80)
    of_quiet, of_loud = (background_noise(s, 8).density(frequency, 1.0 / 200.0) for s in (quiet, loud))
    plain = background_noise([s[:128] for s in loud], 8).density(frequency, 1.0 / 200.0)
    assert np.max(of_loud / of_quiet) < 2.0
    assert np.max(plain / of_quiet) > 20.0  # windows that all hold it tell nothing
