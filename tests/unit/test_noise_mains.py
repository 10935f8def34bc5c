"""Mains lines: the fundamental, its harmonics, and where they fold to."""

from __future__ import annotations

import numpy as np
import pytest

from ssmr_ident.signals.noise import mains_lines


def _hum(rate: float, seconds: float = 4.0, orders: tuple[int, ...] = (1, 3)) -> np.ndarray:
    time = np.arange(round(rate * seconds)) / rate
    noise = 0.01 * np.random.default_rng(3).standard_normal((len(time), 2))
    lines = sum(np.sin(2 * np.pi * k * 60.02 * time + k) / k**2 for k in orders)
    return noise + 0.1 * np.column_stack([lines, 0.5 * lines])


def test_harmonics_go_with_the_fundamental() -> None:
    found = mains_lines(_hum(1000.0), 1e-3, 60.0)
    assert found == pytest.approx((60.02, 180.06), abs=2e-3)
    assert mains_lines(_hum(1000.0, orders=()), 1e-3, 60.0) == ()


def test_without_a_fundamental_there_is_no_mains() -> None:
    assert mains_lines(_hum(1000.0, orders=(3,)), 1e-3, 60.0) == ()


def test_lines_above_half_of_the_rate_are_looked_for_where_they_fold_to_if_asked() -> None:
    coarse = _hum(250.0)
    assert mains_lines(coarse, 4e-3, 60.0) == pytest.approx((60.02,), abs=2e-3)
    assert mains_lines(coarse, 4e-3, 60.0, folds=True) == pytest.approx((60.02, 69.94), abs=3e-3)
    # at 100 Hz the fundamental is seen at 39.98, mirrored; the harmonics all fold to there or near 20 Hz
    mirrored = mains_lines(_hum(100.0), 0.01, 60.0, folds=True)
    assert mirrored == pytest.approx((39.98, 19.94), abs=5e-3)


def test_a_record_that_is_too_short_tells_nothing() -> None:
    assert mains_lines(_hum(1000.0, seconds=0.2), 1e-3, 60.0) == ()
