"""Mains hum: found with its amplitude, phase and frequency, taken off without touching anything else."""

from __future__ import annotations

import numpy as np
import pytest

from ssmr_ident.core.errors import InputError
from ssmr_ident.signals.noise.hum import mains_frequency, mains_line, offset, remove_mains

RATE = 1000.0
TIME = np.arange(20000) / RATE


def test_amplitude_and_its_spread_are_honest() -> None:
    """Over 200 noisy records the estimate scatters as its own standard deviation says."""
    rng = np.random.default_rng(11)
    t = TIME[:2000]
    lines = [mains_line(0.02 * np.cos(2 * np.pi * 60 * t) + 0.1 * rng.standard_normal(2000), RATE) for _ in range(200)]
    amplitudes = np.array([line.amplitude for line in lines])
    spread = 0.1 * np.sqrt(2 / 2000)
    bias = spread**2 / (2 * 0.02)  # a length is never shorter for its noise (Rice)
    assert np.mean(amplitudes) == pytest.approx(0.02 + bias, abs=3 * spread / np.sqrt(200))
    assert np.std(amplitudes) == pytest.approx(spread, rel=3 / np.sqrt(2 * 200))
    assert np.mean([line.amplitude_std for line in lines]) == pytest.approx(spread, rel=0.05)


def test_removal_leaves_the_rest() -> None:
    decay = np.exp(-2 * TIME[:4096]) * np.sin(2 * np.pi * 6 * TIME[:4096])
    hum = 0.05 * np.cos(2 * np.pi * 60 * TIME[:4096] + 1.2) + 0.02 * np.cos(2 * np.pi * 120 * TIME[:4096])
    cleaned = remove_mains(2.6 + decay + hum, RATE, harmonics=2)
    np.testing.assert_allclose(cleaned, 2.6 + decay, atol=5e-4)


def test_a_wandering_mains_is_followed() -> None:
    rng = np.random.default_rng(3)
    log = 0.05 * np.cos(2 * np.pi * 59.963 * TIME + 0.4) + 0.02 * rng.standard_normal(len(TIME))
    log += np.sin(2 * np.pi * 7.1 * TIME)
    found = mains_frequency(log, RATE)
    assert found == pytest.approx(59.963, abs=0.001)
    assert mains_line(log, RATE, found).amplitude == pytest.approx(0.05, rel=0.02)


def test_the_line_reproduces_itself() -> None:
    line = mains_line(0.3 * np.cos(2 * np.pi * 60 * TIME - 0.8), RATE)
    np.testing.assert_allclose(line.samples(len(TIME), RATE), 0.3 * np.cos(2 * np.pi * 60 * TIME - 0.8), atol=1e-9)


def test_offset_before_the_event() -> None:
    log = np.where(TIME < 0.5, 0.24, 5.0)
    assert offset(log, RATE, until=0.5) == pytest.approx(0.24)
    assert offset(np.stack([log, log], axis=1), RATE, until=0.4).shape == (2,)


@pytest.mark.parametrize(
    ("call", "word"),
    [
        (lambda: mains_line(np.zeros(500), 100.0), "cannot show 60 Hz"),
        (lambda: mains_line(np.zeros(50), RATE), "four periods"),
        (lambda: offset(np.zeros(50), RATE, until=0.0), "no sample before"),
        (lambda: mains_line(np.zeros((500, 2)), RATE), "one channel"),
    ],
)
def test_what_cannot_be_done_says_why(call, word: str) -> None:
    with pytest.raises(InputError, match=word):
        call()
