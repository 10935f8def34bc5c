"""Seconds of the processor that the benchmark states: of the work, not of compiling and not of waiting."""

from __future__ import annotations

import time

import pytest
from doctor.processor import timed
from numba import njit


def _busy(seconds: float) -> None:
    end = time.process_time() + seconds
    while time.process_time() < end:
        pass


def test_work_counts_and_waiting_does_not() -> None:
    found: list[float] = []
    with timed(found):
        _busy(0.05)
        time.sleep(0.2)
    assert found == [pytest.approx(0.05, abs=0.04)]


def test_a_loop_is_compiled_at_nobodys_cost() -> None:
    def doubled(x: float) -> float:
        return 2.0 * x

    whole, found = time.process_time(), list[float]()
    with timed(found):
        assert njit(doubled)(2.0) == 4.0
    assert found[0] < 0.5 * (time.process_time() - whole)
