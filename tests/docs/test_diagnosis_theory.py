"""What docs/theory/diagnosis.md states in numbers is what the code has, and what noise does."""

from __future__ import annotations

import re
from pathlib import Path

import numpy as np
import pytest
from scipy.signal import lfilter

from ssmr_ident.compare.comparison import measure
from ssmr_ident.compare.outcome import Prediction
from ssmr_ident.diagnose import assemble, within, worth
from ssmr_ident.diagnose.worth import noise_floor, reddest
from ssmr_ident.doctor import rules
from ssmr_ident.signals.metrics import LOW_PASS_HZ

PAGE = Path(__file__).resolve().parents[2] / "docs" / "theory" / "diagnosis.md"


def test_numbers_of_the_decision_are_those_of_the_code() -> None:
    page = PAGE.read_text(encoding="utf-8")
    stated = {name: float(value) for name, value in re.findall(r"^\| `([A-Z_]+)` \| ([\d.]+) \|", page, re.MULTILINE)}
    code = {name: value for name, value in vars(rules).items() if name.isupper()}
    code |= {
        "UNEXPLAINED": assemble.UNEXPLAINED,
        "BEYOND": assemble.BEYOND,
        "WHITE": worth.WHITE,
        "REACH": within.REACH,
    }
    assert stated == pytest.approx(code)
    assert page.count("\n") <= 250


@pytest.mark.parametrize(("coefficient", "stated"), [(0.0, 1.0), (0.3, 1.4), (0.5, 1.8), (0.6, 2.2), (0.7, 2.7)])
def test_coloured_noise_over_its_floor(coefficient: float, stated: float) -> None:
    share, rate, count = 0.6, 2000.0, 20_000
    inside, outside = (1 + coefficient) / (1 - coefficient), 1 - 4 * coefficient / 3 + coefficient**2 / 3
    formula = np.sqrt((1 - share + share * inside) / (1 - share + share * outside))
    assert formula == pytest.approx(stated, abs=0.05)
    rng = np.random.default_rng(11)
    coloured = lfilter([np.sqrt(1 - coefficient**2)], [1.0, -coefficient], rng.standard_normal(count + 200))[200:]
    noise = np.sqrt(1 - share) * rng.standard_normal(count) + np.sqrt(share) * coloured
    time = np.arange(count) / rate
    motion = np.exp(-0.3 * time) * np.cos(40.0 * time)
    seen = Prediction(
        time, ("ay",), ("m/s^2",), (motion + 0.02 * noise)[:, None], motion[:, None], low_pass_hz=LOW_PASS_HZ
    )
    assert measure(seen)[0] / noise_floor(seen) == pytest.approx(formula, rel=0.05)


@pytest.mark.parametrize(("rate", "stated"), [(100.0, 2.0), (200.0, 2.7), (1000.0, 5.7), (2000.0, 8.0)])
def test_noise_that_is_mostly_slow_reads_no_more_than_is_stated(rate: float, stated: float) -> None:
    rng = np.random.default_rng(5)
    count = int(200.0 * rate)
    keep = float(np.exp(-2.0 * np.pi * 2.0 / rate))  # a corner of 2 Hz
    slow = lfilter([np.sqrt(1 - keep**2)], [1.0, -keep], rng.standard_normal(count))
    noise = np.sqrt(worth.WHITE) * rng.standard_normal(count) + np.sqrt(1 - worth.WHITE) * slow
    time = np.arange(count) / rate
    motion = np.cos(40.0 * time)
    low_pass = LOW_PASS_HZ if 0.45 * rate > LOW_PASS_HZ else None
    seen = Prediction(
        time, ("ay",), ("m/s^2",), (motion + 0.02 * noise)[:, None], motion[:, None], low_pass_hz=low_pass
    )
    assert reddest([seen]) == pytest.approx(stated, abs=0.06)
    # at a low rate second differences see some of the slow noise as well, and the floor is higher
    assert 0.85 * stated < measure(seen)[0] / noise_floor(seen) < 1.05 * stated
