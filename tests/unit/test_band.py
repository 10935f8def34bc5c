"""A pass band: what it takes from a record, what a session may say, a fit that knows nothing of what lies beyond."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from made_networks import Chain, noisy, pushed, written
from scipy.signal import butter, sosfiltfilt

from ssmr_ident.compare.outcome import Prediction
from ssmr_ident.core.errors import InputError
from ssmr_ident.session import read_session, write_parameters
from ssmr_ident.signals.band import inside, lines_in, quiet_std, series
from ssmr_ident.workflows.compare import compare_session
from ssmr_ident.workflows.fit.run import fit_session

RATE = 1000.0
TIME = np.arange(4001) / RATE
CHAIN = Chain((2.0, 0.8), (9e4, 3e4), (12.0, 4.0))


def test_white_noise_stays_white_noise_in_a_shorter_series() -> None:
    noise = np.random.default_rng(1).standard_normal((len(TIME), 40))
    found = series(noise, RATE, (90.0, 150.0))
    assert len(found) == lines_in(len(TIME), RATE, (90.0, 150.0)) == pytest.approx(2 * 60.0 * 4.0, abs=2)
    inner = found[50:-50]
    assert inner.std() == pytest.approx(1.0, rel=0.03)
    assert abs(np.mean(inner[1:] * inner[:-1])) < 0.03
    assert quiet_std(noise, RATE, (90.0, 150.0)).mean() == pytest.approx(1.0, rel=0.05)


def test_a_swing_beyond_the_band_is_not_in_the_series_and_one_inside_keeps_its_decay() -> None:
    swing = np.exp(-3.0 * TIME) * np.sin(2.0 * np.pi * 120.0 * TIME)
    beyond = np.exp(-3.0 * TIME) * np.sin(2.0 * np.pi * 300.0 * TIME)
    within, outside = (series(x[:, None], RATE, (90.0, 150.0))[:, 0] for x in (swing, beyond))
    assert np.linalg.norm(outside) < 1e-3 * np.linalg.norm(within)
    early, late = (np.linalg.norm(within[first : first + 60]) for first in (24, 144))
    assert np.log(early / late) == pytest.approx(3.0, rel=0.02)  # a second between, at 120 samples a second


def test_what_lies_in_the_band_comes_back_as_it_was() -> None:
    own, other = np.sin(2.0 * np.pi * 40.0 * TIME), np.cos(2.0 * np.pi * 95.0 * TIME)
    found = inside(own + other, RATE, (10.0, 60.0))
    assert np.abs(found - own)[200:-200].max() < 2e-3


def test_the_metric_counts_what_the_band_holds() -> None:
    motion, hum = np.sin(2.0 * np.pi * 120.0 * TIME), 3.0 * np.sin(2.0 * np.pi * 20.0 * TIME)
    prediction = Prediction(
        TIME, ("a",), ("m/s^2",), (motion + hum)[:, None], motion[:, None], low_pass_hz=150.0, high_pass_hz=90.0
    )
    rest = prediction.judged(prediction.measured - prediction.simulated)
    assert rest.std() < 0.01
    assert prediction.gain(np.array([20.0, 120.0, 300.0])) == pytest.approx([0.0, 1.0, 0.0], abs=0.02)


@pytest.mark.parametrize(
    ("line", "problem"),
    [
        ("band_hz: [60, 10]", "band_hz.*without width"),
        ("band_hz: [10]", "band_hz.*list of 2"),
        ("band_hz: [0, -1]", "band_hz"),
        ("band_hz: [10, 60]\nbaseline: drag", "band_hz.*is not for baseline drag"),
    ],
)
def test_what_no_band_is(tmp_path: Path, line: str, problem: str) -> None:
    written(tmp_path, CHAIN.known(), [(TIME, TIME, np.zeros((len(TIME), 2)))], 0)
    text = (tmp_path / "session.yaml").read_text()
    if "baseline" in line:
        text = text.replace("baseline: network\n", "")
    (tmp_path / "session.yaml").write_text(text.replace("name: made", line))
    with pytest.raises(InputError, match=problem):
        read_session(tmp_path)


def test_a_recording_has_its_own_band_or_the_sessions(tmp_path: Path) -> None:
    written(tmp_path, CHAIN.known(), [(TIME, TIME, np.zeros((len(TIME), 2)))] * 2, 0)
    text = (tmp_path / "session.yaml").read_text().replace("name: made", "band_hz: [0, 60]")
    (tmp_path / "session.yaml").write_text(text.replace("{file: run-1.csv,", "{file: run-1.csv, band_hz: [5, 70],"))
    assert [entry.band_hz for entry in read_session(tmp_path).entries] == [(0.0, 60.0), (5.0, 70.0)]


@pytest.mark.slow
def test_a_fit_in_a_band_knows_nothing_of_what_lies_beyond(tmp_path: Path) -> None:
    random = np.random.default_rng(3)
    time, push = pushed(CHAIN, random, 30.0, 2.0, 600.0)
    moved = CHAIN.motion(time, push, 0, np.zeros(4))[:, 2]
    other = sosfiltfilt(
        butter(4, [150.0, 240.0], "bandpass", fs=600.0, output="sos"), random.standard_normal(moved.shape), 0
    )
    logged = noisy(moved + 0.5 * other / other.std(axis=0) * moved.std(axis=0), 0.01, random)
    written(tmp_path, CHAIN.known(1.3), [(time, push, logged)], 0)
    text = (tmp_path / "session.yaml").read_text()
    (tmp_path / "session.yaml").write_text(text.replace("name: made", "band_hz: [0, 90]"))
    fit = fit_session(tmp_path)
    for spring, true in (("s1", 9e4), ("s2", 3e4)):
        found = fit.parameters[f"springs.{spring}.stiffness_N_m"]
        assert abs(float(found.value) - true) < 3.0 * found.std < 0.05 * true
    assert fit.results["run-0.csv"]["nrmse_percent"] < 2.0
    write_parameters(tmp_path / "fitted.yaml", fit.parameters)
    assert compare_session(tmp_path, str(tmp_path / "fitted.yaml")).overall["nrmse_percent"] < 2.0
    (tmp_path / "session.yaml").write_text(text)
    assert compare_session(tmp_path, str(tmp_path / "fitted.yaml")).overall["nrmse_percent"] > 10.0
