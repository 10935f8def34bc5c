"""``ident new`` on logs of rigs and blocks made here: the session is right, fits, and nothing is left to fill in."""

from __future__ import annotations

import math
from pathlib import Path

import numpy as np
import pytest
from made_clocks import event

from ssmr_ident.core.errors import InputError
from ssmr_ident.experiments.campaign import load
from ssmr_ident.session import read_session
from ssmr_ident.workflows.fit.run import fit_session
from ssmr_ident.workflows.new.names import hints_of
from ssmr_ident.workflows.new.run import Told, draft_session

RATE = 400.0


def _write(path: Path, heads: str, *columns: np.ndarray) -> None:
    rows = "\n".join(",".join(f"{value:.7g}" for value in row) for row in zip(*columns, strict=True))
    path.write_text(f"{heads}\n{rows}\n", encoding="utf-8")


def _swing(start: float, size: float, hertz: float, xi: float, seconds: float, order: int) -> tuple[np.ndarray, ...]:
    """Time and a decay in a derivative, quiet before ``start``."""
    time = np.arange(round(seconds * RATE)) / RATE
    omega = 2 * math.pi * hertz
    since = np.maximum(time - start, 0.0)
    wave = np.real((-xi * omega + 1j * omega * math.sqrt(1 - xi**2)) ** order * np.exp(1j * 0.3)
                   * np.exp((-xi + 1j * math.sqrt(1 - xi**2)) * omega * since))  # fmt: skip
    return time, np.where(time < start, 0.0, size * wave)


def _ready(folder: Path, told: Told):
    draft = draft_session(folder, told)
    assert not draft.questions
    draft.write()
    return draft


def test_what_a_log_lacks_is_told_with_what_was_found(tmp_path: Path) -> None:
    time, wave = _swing(0.0, 0.004, 5.0, 0.02, 2.0, 0)
    kept = np.arange(len(time)) != 300
    _write(tmp_path / "decay.csv", "time [s],position [m]", time[kept], wave[kept])
    _ready(tmp_path, Told(mass=2.5))
    assert any("decay.csv" in text and "missing" in text for text in load(tmp_path).found)


@pytest.mark.slow
@pytest.mark.parametrize("hertz", [3.0, 9.0])
def test_plucked_and_quiet_before(tmp_path: Path, hertz: float) -> None:
    rng = np.random.default_rng(1)
    starts = (0.7, 1.12)
    for number, start in enumerate(starts, 1):
        time, wave = _swing(start, 0.004, hertz, 0.02, 6.0, 2)
        noise = 0.01 * np.std(wave) * rng.normal(size=len(time))
        _write(tmp_path / f"pluck-{number}.csv", "time [s],acc [m/s^2]", time, wave + noise)
    draft = _ready(tmp_path, Told(mass=2.5))
    assert draft.baseline == "sdof"
    assert draft.next_command == f"ident diagnose {tmp_path} -o {tmp_path}-diagnosis"
    entries = read_session(tmp_path).entries
    assert [entry.experiment for entry in entries] == ["free_response"] * 2
    assert [entry.release_s[0] for entry in entries] == pytest.approx(starts, abs=0.01)
    campaign = load(tmp_path)
    assert [m.recording.time[0] for m in campaign.measurements] == pytest.approx(starts, abs=0.01)
    assert "let go at 0.7" in campaign.found[0]
    known = campaign.parameters
    assert known.estimates["mass_kg"].fixed  # decays tell ratios to it alone
    assert known.number("stiffness_N_m") == pytest.approx(2.5 * (2 * math.pi * hertz) ** 2, rel=0.02)
    assert known.number("damping_N_s_m") == pytest.approx(2 * 0.02 * 2.5 * 2 * math.pi * hertz, rel=0.1)
    assert fit_session(tmp_path).parameters.number("stiffness_N_m") == pytest.approx(
        2.5 * (2 * math.pi * hertz) ** 2, rel=0.01
    )


def test_several_hits_are_decays_of_their_own(tmp_path: Path) -> None:
    rng = np.random.default_rng(2)
    time = np.arange(round(9.0 * RATE)) / RATE
    hits = (0.6, 3.3, 6.4)
    wave = sum(_swing(at, 1e-3, 15.0, 0.012, 9.0, 2)[1] for at in hits)
    _write(tmp_path / "hits.csv", "t [s],a [m/s^2]", time, wave + 0.01 * np.std(wave) * rng.normal(size=len(time)))
    _ready(tmp_path, Told(mass=1.0))
    parts = load(tmp_path).measurements
    assert [part.release_s for part in parts] == pytest.approx(hits, abs=0.01)
    assert len({part.name for part in parts}) == 3
    fit = fit_session(tmp_path)
    assert sum("xi" in result for result in fit.results.values()) == 3
    assert fit.parameters.number("stiffness_N_m") == pytest.approx((2 * math.pi * 15.0) ** 2, rel=0.005)


def test_a_rotary_rig_has_rotary_keys(tmp_path: Path) -> None:
    time, wave = _swing(0.0, math.degrees(0.2), 1.3, 0.01, 20.0, 0)
    noise = math.degrees(0.001) * np.random.default_rng(3).normal(size=len(time))
    _write(tmp_path / "swing_11deg.csv", "time [s],theta [deg]", time, wave + noise)
    draft = _ready(tmp_path, Told(mass=0.05))
    assert "its name says 11 deg" in draft.session_text
    known = load(tmp_path).parameters
    assert known.number("inertia_kg_m2") == 0.05
    assert known.number("stiffness_N_m_rad") == pytest.approx(0.05 * (2 * math.pi * 1.3) ** 2, rel=0.02)


def test_a_velocity_in_radians_is_an_angular_rate(tmp_path: Path) -> None:
    torque = np.random.default_rng(8).normal(size=1200)
    time = np.arange(1200) / RATE
    rate = np.cumsum(torque) / RATE / 0.012  # of 0.012 kg m^2 alone
    _write(tmp_path / "run1.csv", "time [s],torque [N*m],velocity [rad/s]", time, torque, rate)
    draft = _ready(tmp_path, Told(mass=0.012))
    assert draft.guesses[0].fields["channels"] == {"angular_rate": "velocity"}
    assert "inertia_kg_m2" in draft.parameters_text
    (measurement,) = load(tmp_path).measurements
    np.testing.assert_allclose(measurement.recording["angular_rate"], rate, rtol=1e-5, atol=1e-6)


@pytest.mark.slow
def test_a_shaker_with_one_axis_named_is_a_rig(tmp_path: Path) -> None:
    made = event(np.random.default_rng(4), hertz=(6.0,), mass=1.7, seconds=15.0)
    rng = np.random.default_rng(5)
    time, force = made.logged("drive", RATE, 0.0, 0.0, 0.003, rng)
    _, answer = made.logged("acceleration", RATE, 0.0, 0.0, 0.003, rng)
    _write(tmp_path / "shaker1.csv", "Time (s),Force (N),Acc_X [g]", time, force, answer / 9.80665)
    _ready(tmp_path, Told())
    (entry,) = read_session(tmp_path).entries
    assert entry.experiment == "forced"
    known = load(tmp_path).parameters
    assert known.number("mass_kg") == pytest.approx(1.7, rel=0.05)  # a force tells the mass
    assert known.number("stiffness_N_m") == pytest.approx(1.7 * (2 * math.pi * 6.0) ** 2, rel=0.05)


@pytest.mark.slow
@pytest.mark.parametrize(
    "heads",
    [
        "table [m/s^2],mass [m/s^2]",
        "ch1 [m/s^2],ch2 [m/s^2]",
        "table_acc [m/s^2],mass_acc [m/s^2]",
        "acc1 [m/s^2],acc2 [m/s^2]",
    ],
)
def test_a_moved_foot_is_told_by_its_name_or_by_what_answers(tmp_path: Path, heads: str) -> None:
    made = event(np.random.default_rng(6), hertz=(7.0,), mass=1.0, seconds=15.0, band=(1.0, 20.0))
    rng = np.random.default_rng(7)
    time, foot = made.logged("drive", RATE, 0.0, 0.0, 0.002, rng)
    _, against = made.logged("acceleration", RATE, 0.0, 0.0, 0.002, rng)  # under −foot it would be the other way round
    _write(tmp_path / "run-1.csv", f"time [s],{heads}", time, -foot, against - foot)
    _ready(tmp_path, Told(mass=2.0))
    (entry,) = read_session(tmp_path).entries
    first, second = (head.split(" ")[0] for head in heads.split(","))
    assert entry.experiment == "base_motion"
    assert dict(entry.channels) == {"base_acceleration": first, "acceleration": second}
    fit = fit_session(tmp_path)
    assert fit.parameters.number("stiffness_N_m") == pytest.approx(2.0 * (2 * math.pi * 7.0) ** 2, rel=0.02)
    assert fit.parameters.number("damping_N_s_m") == pytest.approx(2 * 0.03 * 2.0 * 2 * math.pi * 7.0, rel=0.05)
    assert fit.parameters.number("mass_kg") == pytest.approx(2.0, rel=0.01)  # nothing tells it


@pytest.mark.slow
def test_two_machines_become_one_recording(tmp_path: Path) -> None:
    for number in (1, 2):
        made = event(np.random.default_rng(10 + number), hertz=(4.5,), mass=3.0, seconds=14.0, band=(0.5, 9.0))
        rng = np.random.default_rng(20 + number)
        _write(
            tmp_path / f"press-{number}.csv", "Time (s),Load (N)", *made.logged("drive", 50.0, 0.52, 0.0, 0.003, rng)
        )
        daq = made.logged("acceleration", 200.0, 0.0, -70.0, 0.003, rng)
        _write(tmp_path / f"daq-{number}.csv", "time [s],acceleration [m/s^2]", *daq)
    draft = _ready(tmp_path, Told(mass=3.0))
    assert len(draft.found) == 2
    entry = read_session(tmp_path).entries[0]
    assert {quantity: log.file for quantity, log in entry.files.items()} == {
        "force": "press-1.csv",
        "acceleration": "daq-1.csv",
    }
    assert "its clock reads 0.52" in load(tmp_path).found[0]
    fit = fit_session(tmp_path)
    assert fit.parameters.number("stiffness_N_m") == pytest.approx(3.0 * (2 * math.pi * 4.5) ** 2, rel=0.01)
    assert fit.parameters.number("damping_N_s_m") == pytest.approx(2 * 0.03 * 3.0 * 2 * math.pi * 4.5, rel=0.03)


@pytest.mark.slow
def test_logs_with_nothing_in_common_are_left_out_and_said(tmp_path: Path) -> None:
    rng = np.random.default_rng(30)
    one, other = (event(np.random.default_rng(seed), seconds=12.0) for seed in (31, 32))
    _write(tmp_path / "press-1.csv", "Time (s),Load (N)", *one.logged("drive", 50.0, 0.0, 0.0, 0.01, rng))
    daq = other.logged("acceleration", 200.0, 0.0, 0.0, 0.01, rng)
    _write(tmp_path / "daq-1.csv", "time [s],acceleration [m/s^2]", *daq)
    with pytest.raises(InputError, match=r"press-1.csv: have nothing in common: of shifts from"):
        draft_session(tmp_path, Told(mass=3.0))


def _teeth(mass: float, seconds: float, speed: float, stiffness: float, peak: float, level: float) -> np.ndarray:
    """Force of a block: quiet, a rise, one peak, then steady sliding."""
    time = np.arange(round(seconds * 100)) / 100
    weight = mass * 9.80665
    rise = stiffness * speed * np.maximum(time - 1.0, 0.0)
    slides = time > 1.0 + peak * weight / (stiffness * speed)
    return np.where(slides, level * weight, np.minimum(rise, peak * weight))


@pytest.mark.parametrize(("name", "speed"), [("pull_10mms", 10.0), ("block v2.5mm-s", 2.5), ("run 30 mm_min 4", 0.5)])
def test_a_pulled_block_is_no_robot(tmp_path: Path, name: str, speed: float) -> None:
    force = _teeth(12.0, 14.0, speed * 1e-3, 30e3, 0.42, 0.36) + 0.2 * np.random.default_rng(40).normal(size=1400)
    _write(tmp_path / f"{name}.csv", "Time (s),Load (N)", np.arange(1400) / 100, force)
    draft = _ready(tmp_path, Told(mass=12.0))
    assert draft.baseline == "drag"
    assert [guess.key for guess in draft.suggestions] == ["speed_mm_s"]
    (entry,) = read_session(tmp_path).entries
    assert entry.speed_mm_s == speed
    known = load(tmp_path).parameters
    assert known.number("mu_static") == pytest.approx(0.42, rel=0.03)
    assert known.number("mu_kinetic") == pytest.approx(0.36, rel=0.01)  # neither the quiet second nor the rise counts
    other = draft_session(tmp_path, Told(mass=12.0, answers={f"{name}.csv:speed_mm_s": "7"}))
    assert other.guesses[0].fields["speed_mm_s"] == 7
    assert not other.suggestions


def test_options_for_the_readers_go_into_every_entry(tmp_path: Path) -> None:
    time, wave = _swing(0.0, 0.01, 4.0, 0.02, 8.0, 0)
    _write(tmp_path / "a.csv", "colA,colB", wave * 1e3, np.zeros_like(time))
    draft = _ready(tmp_path, Told(mass=1.0, columns={"position": "0"}, units={"position": "mm"}, sample_rate_hz=RATE))
    (entry,) = read_session(tmp_path).entries
    assert (dict(entry.columns), dict(entry.units), entry.sample_rate_hz) == (
        {"position": "0"},
        {"position": "mm"},
        RATE,
    )
    assert "position" in draft.guesses[0].recording
    assert load(tmp_path).measurements[0].recording.sample_rate == pytest.approx(RATE)


def test_names_are_read_as_guesses() -> None:
    assert hints_of("sine_2g_5mm").amplitude == "2 g"
    assert hints_of("pull-0,5mm_s").head_mm_s == 0.5
    assert hints_of("decay-20ms").head_mm_s is None
