"""The time axis: clocks, dates, midnight, restarts, gaps, several clocks in one table."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from ssmr_ident.core.errors import InputError
from ssmr_ident.core.recording import rate_of
from ssmr_ident.readers import ReadOptions, read, read_one


def log(tmp_path: Path, header: str, rows: list[str], **options: object):
    path = tmp_path / "log.csv"
    path.write_text("\n".join([header, *rows]) + "\n")
    return read(path, ReadOptions(**options))  # type: ignore[arg-type]


def test_clock_times_over_midnight(tmp_path: Path) -> None:
    rows = [f"{h}:{m}:{s:04.1f},{k}" for k, (h, m, s) in enumerate([(23, 59, 59.0), (23, 59, 59.5)])]
    rows += [f"00:00:{s:04.1f},5" for s in (0.0, 0.5, 1.0)]
    (recording,) = log(tmp_path, "Time,Load (N)", rows)
    np.testing.assert_allclose(recording.time, [0, 0.5, 1.0, 1.5, 2.0], atol=1e-9)
    assert any("midnight" in note.text for note in recording.notes)


def test_am_and_pm(tmp_path: Path) -> None:
    (recording,) = log(tmp_path, "Time,Load (N)", [f"{12 + (k > 0) * (k - 12)}:00:00 PM,{k}" for k in range(4)])
    np.testing.assert_array_equal(recording.time, [0, 3600, 7200, 10800])


def test_dates(tmp_path: Path) -> None:
    rows = [f"2012-05-10T14:03:{11 + k / 4:05.2f},{k}" for k in range(8)]
    (recording,) = log(tmp_path, "Time,Load (N)", rows)
    np.testing.assert_allclose(recording.time, np.arange(8) / 4, atol=1e-6)


def test_seconds_since_1904(tmp_path: Path) -> None:
    rows = [f"{3419503391 + k / 1000:.3f},{k}" for k in range(50)]
    (recording,) = log(tmp_path, "Time (s),Load (N)", rows)
    np.testing.assert_allclose(recording.time, np.arange(50) / 1000, atol=1e-6)
    assert any("1904" in note.text for note in recording.notes)


@pytest.mark.parametrize(("unit", "factor"), [("ms", 1e-3), ("us", 1e-6), ("min", 60.0)])
def test_time_units(tmp_path: Path, unit: str, factor: float) -> None:
    (recording,) = log(tmp_path, f"Time ({unit}),Load (N)", [f"{k},{k}" for k in range(20)])
    np.testing.assert_allclose(recording.time, np.arange(20) * factor, rtol=1e-15)


def test_sample_count_is_not_taken_for_seconds(tmp_path: Path) -> None:
    rows = [f"{k},{k}" for k in range(20)]
    with pytest.raises(InputError, match="whole numbers in steps of 1"):
        log(tmp_path, "Time,Load (N)", rows)
    (recording,) = log(tmp_path, "Time,Load (N)", rows, fs=1000.0)
    np.testing.assert_array_equal(recording.time, np.arange(20) / 1000)
    (recording,) = log(tmp_path, "Time,Load (N)", rows, time_unit="ms")
    np.testing.assert_allclose(recording.time, np.arange(20) / 1000)


def test_restart_is_another_sample(tmp_path: Path) -> None:
    rows = [f"{k / 10},{k}" for k in range(30)] + [f"{k / 10},{-k}" for k in range(20)]
    first, second = log(tmp_path, "Time (s),Load (N)", rows)
    assert (len(first.time), len(second.time)) == (30, 20)
    np.testing.assert_array_equal(second["force"], -np.arange(20.0))
    assert second.provenance.part.endswith("sample 2 of 2")


@pytest.mark.parametrize(("stamp", "shown"), [("0.55", "0.55 s"), ("1e308", "without time")])
def test_one_damaged_stamp_costs_its_row(tmp_path: Path, stamp: str, shown: str) -> None:
    rows = [f"{k / 10},{k}" for k in range(30)]
    rows[20] = f"{stamp},20"
    (recording,) = log(tmp_path, "Time (s),Load (N)", rows)
    np.testing.assert_array_equal(recording["force"], np.delete(np.arange(30.0), 20))
    assert any(shown in note.text and note.where == "line 22" for note in recording.warnings)


def test_a_step_back_to_any_time_begins_another_part(tmp_path: Path) -> None:
    rows = [f"{5 + k / 10},{k}" for k in range(30)] + [f"{6 + k / 10},{-k}" for k in range(20)]
    first, second = log(tmp_path, "Time (s),Load (N)", rows)
    assert (len(first.time), len(second.time)) == (30, 20)
    assert any("time steps back from 7.9 to 6 s" in note.text and note.where == "line 32" for note in second.notes)


def test_doubled_first_row(tmp_path: Path) -> None:
    (recording,) = log(tmp_path, "Time (s),Load (N)", ["0,5", *(f"{k / 10},{k}" for k in range(30))])
    assert len(recording.time) == 30
    assert any("repeat the time" in note.text and note.where == "line 3" for note in recording.warnings)


@pytest.mark.parametrize("rate", [300.0, 612.0, 1000.0, 2500.0])
def test_stamps_in_whole_milliseconds_give_the_rate_by_regression(tmp_path: Path, rate: float) -> None:
    count = 4000
    rows = [f"{int(1000 * k / rate)},{k % 7}" for k in range(count)]
    (recording,) = log(tmp_path, "time_ms,Load (N)", rows)
    assert len(recording.time) == count
    assert recording.sample_rate == pytest.approx(rate, rel=1e-4)
    assert np.ptp(np.diff(recording.time)) < 1e-12
    assert len(recording.warnings) == (rate != 1000.0)


def test_bursts_are_said_once(tmp_path: Path) -> None:
    """Four samples are read out of a sensor's memory 0.1 ms apart, then there is a pause."""
    rng = np.random.default_rng(3)
    stamps = [0.004 * (k // 4) + 1e-4 * (k % 4) + 2e-6 * rng.random() for k in range(4000)]
    rows = [f"{t:.6f},{k}" for k, t in enumerate(stamps)]
    (recording,) = log(tmp_path, "Time (s),Load (N)", rows)
    assert recording.sample_rate == pytest.approx(1000.0, rel=1e-4)
    (note,) = recording.warnings
    assert "bursts of 4" in note.text
    assert "--stamps logged" in note.text
    (logged,) = log(tmp_path, "Time (s),Load (N)", rows, stamps="logged")
    np.testing.assert_allclose(logged.time, stamps, atol=1e-6)


@pytest.mark.parametrize("count", [1000, 100])
def test_a_lost_sample_is_not_a_burst(tmp_path: Path, count: int) -> None:
    rows = [f"{k / 100:.2f},{k}" for k in range(count) if k != 77]
    (recording,) = log(tmp_path, "Time (s),Load (N)", rows)
    (note,) = recording.warnings
    assert "1 samples missing after t = 0.76 s" in note.text


@pytest.mark.parametrize(("unit", "factor"), [("s", 1), ("ms", 1000), ("us", 10**6), ("ns", 10**9)])
def test_counts_since_1970_are_told_by_size_and_step(tmp_path: Path, unit: str, factor: int) -> None:
    rows = [f"{(1_650_000_123_000_000_000 + 4_000_000 * k) * factor // 10**9},{k % 9}" for k in range(60)]
    if unit == "s":
        rows = [f"{1_650_000_123 + k / 250:.3f},{k % 9}" for k in range(60)]
    (recording,) = log(tmp_path, "timestamp,Load (N)", rows)
    np.testing.assert_allclose(recording.time, np.arange(60) / 250, atol=1e-6)
    assert any("since 1970: 2022-04-15" in note.text for note in recording.notes)


def test_stamps_in_two_columns(tmp_path: Path) -> None:
    nanoseconds = [987_000_000 + 5_000_000 * k for k in range(400)]
    rows = [f"{1_650_000_000 + n // 10**9},{n % 10**9},{k % 5}" for k, n in enumerate(nanoseconds)]
    for header in ("stamp.sec,stamp.nanosec,Load (N)", "hdr/stamp/secs,hdr/stamp/nsecs,Load (N)"):
        (recording,) = log(tmp_path, header, rows)
        assert recording.names == ("force",)
        np.testing.assert_allclose(np.diff(recording.time), 0.005, atol=1e-9)


def test_date_and_time_of_day_in_two_columns_run_over_midnight(tmp_path: Path) -> None:
    rows = [f"{28 + (k > 9)}.02.2024;{'23:59:59' if k < 10 else '00:00:00'},{k % 10}00;{k}" for k in range(20)]
    (recording,) = log(tmp_path, "Datum;Uhrzeit;Kraft [N]", rows)
    np.testing.assert_allclose(recording.time, np.arange(20) / 10, atol=1e-6)


def test_of_two_clocks_of_the_same_rows_the_even_one_is_the_time(tmp_path: Path) -> None:
    rng = np.random.default_rng(5)
    rows = [f"{1_650_000_000_000 + 10 * k + rng.integers(0, 4)},{5_000_000 + 10_000 * k},{k}" for k in range(200)]
    (recording,) = log(tmp_path, "received_time_ms,sensor_time_us,Load (N)", rows)
    np.testing.assert_allclose(np.diff(recording.time), 0.01, atol=1e-9)
    assert any("several clocks" in note.text and "received_time_ms left out" in note.text for note in recording.notes)


def test_a_column_with_blanks_has_a_rate_of_its_own(tmp_path: Path) -> None:
    rows = [f"{k / 200:.3f},{np.sin(k / 9):.6f},{f'{k / 2:.1f}' if k % 4 == 2 else ''}" for k in range(400)]
    (recording,) = log(tmp_path, "time [s],a [m/s^2],Kraft [N]", rows)
    force = recording.series("force")
    np.testing.assert_allclose(force.time, 0.01 + 0.02 * np.arange(100), atol=1e-12)
    np.testing.assert_array_equal(force.samples, 1.0 + 2.0 * np.arange(100))
    assert (recording.time[0], recording.time[-1]) == (force.time[0], force.time[-1])
    np.testing.assert_allclose(recording["force"], 100 * recording.time, atol=1e-9)  # a straight line stays one
    slow = recording.on_clock_of("force")
    np.testing.assert_array_equal(slow["acceleration"], recording.series("acceleration").samples[2:399:4])


def test_gap_is_told_with_its_line(tmp_path: Path) -> None:
    rows = [f"{t / 100:.2f},{t}" for t in [*range(806), *range(3448, 3600)]]
    (recording,) = log(tmp_path, "Time (s),Load (N)", rows)
    (gap,) = recording.warnings
    assert "2642 samples missing after t = 8.05 s: time jumps to 34.48 s" in gap.text
    assert gap.where == "line 808"
    assert recording.sample_rate == pytest.approx(100.0)


def test_lost_samples_do_not_slow_the_rate_and_a_clock_of_its_own_kind_keeps_its_mean() -> None:
    kept = np.delete(np.arange(600), [150, 151, 400]) / 200.0
    assert rate_of(np.round(kept, 3)) == pytest.approx(200.0, rel=1e-12)
    bursts = np.cumsum(np.tile([0.001, 0.001, 0.003], 200))
    assert rate_of(bursts) == pytest.approx(599 / (bursts[-1] - bursts[0]))


def test_two_clocks_in_one_table(tmp_path: Path) -> None:
    """A force that ticks every fifth row, stamped 50 us later, onto its own clock with the position interpolated."""
    rows = []
    for k in range(500):
        tick = k - k % 5
        rows.append(f"{1_000_000 + 2000 * k},{0.01 * k:.6f},{1_000_050 + 2000 * tick},{tick}")
    (recording,) = log(
        tmp_path, "position_timestamp,position,force_timestamp,force", rows, units={"position": "mm", "force": "N"},
        time_unit="us",
    )  # fmt: skip
    recording = recording.on_clock_of("force")
    np.testing.assert_allclose(recording.time, 50e-6 + 0.01 * np.arange(100), atol=1e-9)
    np.testing.assert_array_equal(recording["force"], 5.0 * np.arange(100))
    np.testing.assert_allclose(recording["position"], 1e-3 * (0.05 * np.arange(100) + 0.01 * 50 / 2000), atol=1e-9)
    assert any("force_timestamp ticks in 100 of 500 rows" in note.text for note in recording.warnings)


def test_clocks_may_be_named_among_the_units(tmp_path: Path) -> None:
    rows = [f"{1000 * k},{k},{1000 * (k - k % 2)},{k - k % 2}" for k in range(40)]
    units = {"p_timestamp": "us", "f_timestamp": "us", "P": "mm", "F": "N"}
    (recording,) = log(tmp_path, "p_timestamp,P,f_timestamp,F", rows, units=units)
    assert recording.names == ("P", "force")
    recording = recording.on_clock_of("force")
    np.testing.assert_allclose(recording.time, 2e-3 * np.arange(20), atol=1e-12)
    np.testing.assert_allclose(recording["P"], 2e-3 * np.arange(20), atol=1e-12)


@pytest.mark.slow
def test_friction_originals_agree_with_the_clean_files(shared: Path) -> None:
    """Somebody else's clean version of the same recording: each force once, the position interpolated there."""
    folder = shared / "recordings" / "friction_pull"
    options = ReadOptions(units={"position": "mm", "force": "N"}, time_unit="us")
    for number in (4, 6, 7):
        file = folder / "original" / f"kinetic_test_{number}_motor_speed_2000_mass_1094.csv"
        original = read_one(file, options).on_clock_of("force")
        clean = read_one(folder / f"run-{number}.csv")
        count = len(clean.time)
        assert abs(len(original.time) - count) <= 1
        np.testing.assert_allclose(original.time[:count], clean.time, atol=1e-6)
        np.testing.assert_allclose(original["force"][:count], clean["force"], rtol=1e-5, atol=1e-6)
        np.testing.assert_allclose(original["position"][:count], clean["position"], atol=2e-7)


def test_two_rows_at_one_time_are_refused(tmp_path: Path) -> None:
    (tmp_path / "log.csv").write_text("time_s,force_N\n1.0,1\n1.0,2\n1.0,3\n")
    with pytest.raises(InputError, match="time stands still"):
        read(tmp_path / "log.csv")


def test_seconds_that_no_row_has_are_a_line(tmp_path: Path) -> None:
    log = tmp_path / "parts.csv"
    log.write_text("hour,min,sec,ms,force_N\n12,0,,0,0.0\n12,0,,500,0.1\n", encoding="utf-8")
    with pytest.raises(InputError):
        read(log)


def test_a_clock_that_goes_to_and_fro_and_nowhere(tmp_path: Path) -> None:
    rows = [f"12,{k % 2 * 500},{k}" for k in range(11)]
    with pytest.raises(InputError, match="time decreases 5 times"):
        log(tmp_path, "hour,ms,Load (N)", rows)
