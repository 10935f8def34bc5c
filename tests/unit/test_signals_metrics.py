"""The contract's two distances, against closed forms and the distances published with real recordings."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from ssmr_ident.core.errors import InputError
from ssmr_ident.signals.metrics import log_psd_db, nrmse_percent

RATE = 1000.0
TIME = np.arange(4096) / RATE
DECAY = np.exp(-2 * TIME) * np.sin(2 * np.pi * 6 * TIME)


def test_equal_is_zero_and_silence_is_hundred() -> None:
    assert nrmse_percent(DECAY, DECAY + 3.0, RATE) == pytest.approx(0, abs=1e-9)
    assert nrmse_percent(DECAY, np.zeros_like(DECAY), RATE) == pytest.approx(100)
    assert nrmse_percent(DECAY, 0.9 * DECAY, RATE) == pytest.approx(10)


def test_what_lies_above_fifty_hertz_does_not_count() -> None:
    """The hum is 0 at both ends: there a zero-phase filter keeps a sample as it is (see filters.py)."""
    t, decay = TIME[:4001], DECAY[:4001]
    hum = 0.5 * np.sin(2 * np.pi * 120 * t)
    assert nrmse_percent(decay, decay + hum, RATE) < 0.1
    assert nrmse_percent(decay, decay + hum, RATE, low_pass_hz=None) > 100


def test_a_pull_counts_its_level() -> None:
    force = 100 + 20 * np.sin(2 * np.pi * 0.5 * TIME)
    assert nrmse_percent(force, force + 20, RATE, low_pass_hz=None) == pytest.approx(0, abs=1e-9)
    expected = 100 * 20 / np.std(force)
    assert nrmse_percent(force, force + 20, RATE, low_pass_hz=None, remove_mean=False) == pytest.approx(expected)


def test_channels_share_one_norm() -> None:
    both = np.stack([DECAY, 0.1 * DECAY], axis=1)
    off = np.stack([DECAY, np.zeros_like(DECAY)], axis=1)
    assert nrmse_percent(both, off, RATE) == pytest.approx(100 * 0.1 / np.hypot(1, 0.1))


def test_a_constant_recording_cannot_be_explained() -> None:
    with pytest.raises(InputError, match="constant"):
        nrmse_percent(np.full(500, 9.8), np.zeros(500), RATE)
    with pytest.raises(InputError, match="shape"):
        nrmse_percent(DECAY, DECAY[:-1], RATE)


def test_a_gain_is_its_decibels() -> None:
    noise = np.random.default_rng(0).standard_normal((20000, 3))
    np.testing.assert_allclose(log_psd_db(noise, noise * [1, 2, 0.1], RATE), [0, 20 * np.log10(2), 20], atol=1e-9)


def test_chance_level_of_two_white_records() -> None:
    """10/ln 10·√(1.06/T), the figure that the docstring states."""
    rng = np.random.default_rng(1)
    distances = [log_psd_db(*rng.standard_normal((2, 20000)), RATE) for _ in range(40)]
    assert np.mean(distances) == pytest.approx(10 / np.log(10) * np.sqrt(1.06 / 20), rel=0.05)


def test_different_rates_are_compared_on_the_common_band() -> None:
    slow, fast = np.arange(6000) / 100.0, np.arange(60000) / 1000.0
    lines = [np.sin(2 * np.pi * 7 * t) + 0.01 * np.sin(2 * np.pi * 33 * t) for t in (slow, fast)]
    near_lines = log_psd_db(lines[0], lines[1], 100.0, simulated_rate=1000.0, band_hz=(6.0, 8.0))
    assert near_lines == pytest.approx(0, abs=0.05)


def test_a_silent_simulation_is_far_but_finite() -> None:
    noise = np.random.default_rng(0).standard_normal(5000)
    assert 100 < log_psd_db(noise, np.zeros(5000), RATE) < 130
    with pytest.raises(InputError, match="silent"):
        log_psd_db(np.zeros(5000), noise, RATE)


@pytest.mark.parametrize(
    ("part", "published"),
    [("ice/ice-06a", 0.8), ("ice/ice-04a", 1.5), ("flooring/flooring-05a", 2.1), ("flooring/flooring-07a", 3.7)],
)
def test_halves_of_real_turns_are_as_far_apart_as_their_readme_says(shared: Path, part: str, published: float) -> None:
    """Printed to 0.1 dB in the README of the recordings, mean over ax ay az."""
    log = np.genfromtxt(shared / f"recordings/borealtc_{part}.csv", delimiter=",", skip_header=1)[:, 1:4]
    half = len(log) // 2
    distance = log_psd_db(log[:half], log[half : 2 * half], 100.0)
    assert np.mean(distance) == pytest.approx(published, abs=0.051)
