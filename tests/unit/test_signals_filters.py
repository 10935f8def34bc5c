"""Filters against closed forms: gain of a Butterworth run twice, no phase, edges, demands."""

from __future__ import annotations

import numpy as np
import pytest

from ssmr_ident.core.errors import InputError
from ssmr_ident.signals.filters import band_pass, design, low_pass

RATE = 1000.0
TIME = np.arange(20000) / RATE
INNER = slice(4000, -4000)


@pytest.mark.parametrize("frequency", [10.0, 45.0, 50.0, 55.0, 60.0])
def test_gain_is_the_square_of_one_pass(frequency: float) -> None:
    ratio = np.tan(np.pi * frequency / RATE) / np.tan(np.pi * 50.0 / RATE)
    gain = 1 / (1 + ratio**20)
    phase = 0.7
    kept = low_pass(np.cos(2 * np.pi * frequency * TIME + phase), RATE, 50.0)
    expected = gain * np.cos(2 * np.pi * frequency * TIME + phase)
    np.testing.assert_allclose(kept[INNER], expected[INNER], atol=1e-9)


def test_mains_falls_under_three_percent() -> None:
    hum = np.cos(2 * np.pi * 60 * TIME)
    assert np.abs(low_pass(hum, RATE)[INNER]).max() < 0.03


@pytest.mark.parametrize("half_width", [0.5, 1.0])
def test_band_pass_keeps_the_line_and_drops_neighbours(half_width: float) -> None:
    line = np.cos(2 * np.pi * 8.0 * TIME)
    kept = band_pass(9.8 + line + np.cos(2 * np.pi * 11.0 * TIME), RATE, 8.0, half_width_hz=half_width)
    inner = slice(6000, -6000)
    assert np.sqrt(np.mean((kept - line)[inner] ** 2)) < 0.01


@pytest.mark.parametrize("phase", np.linspace(0, 2 * np.pi, 6, endpoint=False))
def test_edges_of_a_short_record_are_kept(phase: float) -> None:
    """The padding rule is what makes the first 0.1 s of a free response usable; scipy's default leaves 2.7 %."""
    line = np.cos(2 * np.pi * 6.0 * TIME[:2048] + phase)
    assert np.sqrt(np.mean((low_pass(line, RATE, 20.0) - line) ** 2)) < 0.005


def test_columns_are_filtered_one_by_one() -> None:
    both = np.random.default_rng(0).standard_normal((3000, 2))
    np.testing.assert_array_equal(low_pass(both, RATE)[:, 1], low_pass(both[:, 1], RATE))


def test_input_is_left_alone() -> None:
    samples = np.random.default_rng(0).standard_normal(300)
    before = samples.copy()
    low_pass(samples, 100.0, 50.0)[:] = 0
    np.testing.assert_array_equal(samples, before)


@pytest.mark.parametrize("rate", [80.0, 100.0])
def test_a_log_of_100_hz_holds_nothing_above_50(rate: float) -> None:
    samples = np.random.default_rng(0).standard_normal(500)
    np.testing.assert_array_equal(low_pass(samples, rate, 50.0), samples)


@pytest.mark.parametrize("rate", [100.02, 100.5, 104.0])
def test_a_cut_off_close_to_half_the_rate_does_no_harm(rate: float) -> None:
    line = np.cos(2 * np.pi * 8.0 * np.arange(3000) / rate)
    np.testing.assert_allclose(low_pass(line, rate, 50.0), line, atol=2e-3)


def test_open_band_edges() -> None:
    low, high = design(RATE, -0.5, 1.5), design(100.0, 49.0, 51.0)
    assert low is not None
    assert high is not None
    assert low.band_hz == (0.0, 1.5)
    assert high.band_hz == (49.0, np.inf)
    assert design(100.0, 0.0, 60.0) is None


@pytest.mark.parametrize(
    ("call", "word"),
    [
        (lambda: low_pass(np.zeros(15), RATE, 50.0), "too short"),
        (lambda: low_pass(np.zeros(1), RATE, 50.0), "1 samples"),
        (lambda: low_pass(np.zeros(0), RATE, 50.0), "0 samples"),
        (lambda: band_pass(np.zeros(900), RATE, 8.0), "too short"),
        (lambda: band_pass(np.zeros(900), 10.0, 8.0), "half the sample rate"),
        (lambda: low_pass(np.array([1.0, np.nan] * 200), RATE, 50.0), "not finite"),
        (lambda: low_pass(np.zeros(900), float("nan"), 50.0), "sample rate"),
        (lambda: low_pass(np.zeros(900), RATE, -1.0), "empty"),
        (lambda: low_pass(np.zeros((2, 2, 2)), RATE, 50.0), "shape"),
    ],
)
def test_what_cannot_be_filtered_says_why(call, word: str) -> None:
    with pytest.raises(InputError, match=word):
        call()


@pytest.mark.parametrize("count", [20, 21, 25, 34, 64, 127])
def test_every_length_from_one_period_on_works(count: int) -> None:
    assert np.isfinite(low_pass(np.random.default_rng(0).standard_normal(count), RATE, 50.0)).all()


def test_a_filter_that_was_changed_does_not_change_the_next_one() -> None:
    first = design(1000.0, upper_hz=50.0)
    assert first is not None
    kept = first.sections.copy()
    first.sections[:] = 0.0
    again = design(1000.0, upper_hz=50.0)
    assert again is not None
    assert np.array_equal(again.sections, kept)
