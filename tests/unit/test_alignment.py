"""Clocks of two logs of one event: shift and drift from what both feel, by data made in code."""

from __future__ import annotations

import numpy as np
import pytest
from made_clocks import Event, event

from ssmr_ident.core.errors import InputError
from ssmr_ident.signals.alignment import Clocked, align

pytestmark = pytest.mark.slow

SLOW, FAST = 50.0, 200.0


def _two(made: Event, answer: str, rates: tuple[float, float], starts: tuple[float, float], ppm: float, seed: int):
    rng = np.random.default_rng(seed)
    return (
        Clocked("press.csv", *made.logged("drive", rates[0], starts[0], 0.0, 0.003, rng)),
        Clocked("daq.csv", *made.logged(answer, rates[1], starts[1], ppm, 0.003, rng)),
    )


@pytest.mark.slow
@pytest.mark.parametrize(
    ("answer", "hertz", "rates", "starts"),
    [
        ("acceleration", (4.0,), (SLOW, FAST), (0.37, 0.0)),
        ("acceleration", (4.3, 9.0), (100.0, FAST), (0.0, 0.81)),
        ("position", (6.0,), (FAST, SLOW), (0.2, 0.9)),  # the driving log is the faster one
        ("drive", (5.0,), (SLOW, 80.0), (0.05, 0.5)),  # both felt the same
    ],
)
def test_the_shift_is_found_to_a_millisecond(answer: str, hertz: tuple, rates: tuple, starts: tuple) -> None:
    made = event(np.random.default_rng(3), hertz=hertz, seconds=16.0)
    found = align(*_two(made, answer, rates, starts, 60.0, seed=4))
    true = (starts[0] - starts[1]) * (1 + 60e-6) + 60e-6 * found.start_s
    assert found.shift_s == pytest.approx(true, abs=1e-3)
    assert found.drift_ppm == pytest.approx(60.0, abs=max(4.0 * found.drift_std_ppm, 15.0))
    assert found.explained > 0.9
    # the second clock's stamps come back to the first's
    second = np.array([2.0, 9.0])
    true_time = second / (1 + 60e-6) + starts[1]
    assert found.to_first(second) == pytest.approx(true_time - starts[0], abs=1.5e-3)


def test_two_blows_are_enough() -> None:
    made = event(np.random.default_rng(5), hertz=(7.0,), xi=0.02, seconds=8.0, hits=(1.6, 4.4))
    found = align(*_two(made, "acceleration", (500.0, 500.0), (0.0, 0.6), 0.0, seed=6))
    assert found.shift_s == pytest.approx(-0.6, abs=2e-3)


def test_the_order_of_the_logs_turns_the_sign() -> None:
    made = event(np.random.default_rng(7), seconds=12.0)
    first, second = _two(made, "drive", (SLOW, FAST), (0.3, 0.0), 0.0, seed=8)
    assert align(first, second).shift_s == pytest.approx(0.3, abs=1e-3)
    assert align(second, first).shift_s == pytest.approx(-0.3, abs=1e-3)


def test_logs_with_nothing_in_common_are_refused_with_what_was_looked_for() -> None:
    one, other = (event(np.random.default_rng(seed), seconds=12.0) for seed in (9, 10))
    rng = np.random.default_rng(11)
    first = Clocked("press.csv", *one.logged("drive", SLOW, 0.0, 0.0, 0.01, rng))
    second = Clocked("daq.csv", *other.logged("acceleration", FAST, 0.0, 0.0, 0.01, rng))
    with pytest.raises(InputError, match=r"press.csv, daq.csv: have nothing in common: of shifts from -8.* to 8"):
        align(first, second)


@pytest.mark.parametrize("seed", range(3))
def test_noise_is_no_event(seed: int) -> None:
    """Between the samples of noise a spline reads less power: that is nothing which the other record explains."""
    rng = np.random.default_rng(seed)
    first = Clocked("a.csv", np.arange(1000) / 100, rng.standard_normal(1000))
    second = Clocked("b.csv", np.arange(2000) / 200, rng.standard_normal(2000))
    with pytest.raises(InputError, match="have nothing in common"):
        align(first, second)


def test_a_handful_of_samples_is_refused() -> None:
    short = Clocked("a.csv", np.arange(20) / 50, np.sin(np.arange(20.0)))
    with pytest.raises(InputError, match="too short"):
        align(short, short)
