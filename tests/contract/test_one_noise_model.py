"""Noise is estimated in one room: what tells an estimator of noise stands nowhere else in the library."""

from __future__ import annotations

import re
from pathlib import Path

import pytest

SOURCE = Path(__file__).resolve().parents[2] / "src" / "ssmr_ident"
HERE = SOURCE / "signals" / "noise"
MARKS = {
    "a standard deviation by the median": r"1\.4826|0\.6745|median_abs_deviation",
    "differences of differences": r"np\.diff\([^()]*(\([^()]*\)[^()]*)*, (n=)?[23]\)",
    "an autocovariance": r"irfft\(np\.abs\(np\.fft\.rfft",
    "the quietest part of a spectrum": r"quantile\(density",
    "steps of a converter": r"steps.*sqrt\(12",
    "an autoregressive model": r"reflection \*|levinson|yule.walker",
    "a line's mean square": r"2\.0 \* np\.abs\(\(wave",
}


@pytest.mark.parametrize("mark", MARKS)
def test_no_other_room_estimates_noise(mark: str) -> None:
    pattern = re.compile(MARKS[mark], re.IGNORECASE)
    found = {file for file in SOURCE.rglob("*.py") if pattern.search(file.read_text(encoding="utf-8"))}
    outside = sorted(str(file.relative_to(SOURCE)) for file in found if HERE not in file.parents)
    assert outside == []


@pytest.mark.parametrize("mark", MARKS)
def test_the_marks_are_those_of_the_noise_model(mark: str) -> None:
    pattern = re.compile(MARKS[mark], re.IGNORECASE)
    assert any(pattern.search(file.read_text(encoding="utf-8")) for file in HERE.glob("*.py"))
