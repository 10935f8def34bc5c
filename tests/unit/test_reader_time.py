"""The time axis: clocks, dates, midnight, restarts, gaps, several clocks in one table."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from ssmr_ident.core.errors import InputError
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


def test_step_back_in_the_middle_is_refused_with_its_line(tmp_path: Path) -> None:
    rows = [f"{k / 10},{k}" for k in range(30)]
    rows[20] = "0.55,20"
    with pytest.raises(InputError, match=r"line 22: time decreases from 1\.9 to 0\.55 s"):
        log(tmp_path, "Time (s),Load (N)", rows)


def test_doubled_first_row(tmp_path: Path) -> None:
    (recording,) = log(tmp_path, "Time (s),Load (N)", ["0,5", *(f"{k / 10},{k}" for k in range(30))])
    assert len(recording.time) == 30
    assert any("repeat the time" in note.text and note.where == "line 3" for note in recording.warnings)


def test_too_coarse_stamps(tmp_path: Path) -> None:
    with pytest.raises(InputError, match="coarser than the sampling"):
        log(tmp_path, "Time (s),Load (N)", [f"{k // 10 / 100},{k}" for k in range(100)])


def test_gap_is_told_with_its_line(tmp_path: Path) -> None:
    rows = [f"{t / 100:.2f},{t}" for t in [*range(806), *range(3448, 3600)]]
    (recording,) = log(tmp_path, "Time (s),Load (N)", rows)
    (gap,) = recording.warnings
    assert "2642 samples missing after t = 8.05 s: time jumps to 34.48 s" in gap.text
    assert gap.where == "line 808"


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
    np.testing.assert_allclose(recording.time, 50e-6 + 0.01 * np.arange(100), atol=1e-12)
    np.testing.assert_array_equal(recording["force"], 5.0 * np.arange(100))
    np.testing.assert_allclose(recording["position"], 1e-3 * (0.05 * np.arange(100) + 0.01 * 50 / 2000), atol=1e-12)
    assert len([note for note in recording.warnings if "clock" in note.text]) == 2


def test_clocks_may_be_named_among_the_units(tmp_path: Path) -> None:
    rows = [f"{1000 * k},{k},{1000 * (k - k % 2)},{k - k % 2}" for k in range(40)]
    units = {"p_timestamp": "us", "f_timestamp": "us", "P": "mm", "F": "N"}
    (recording,) = log(tmp_path, "p_timestamp,P,f_timestamp,F", rows, units=units)
    np.testing.assert_allclose(recording.time, 2e-3 * np.arange(20), atol=1e-15)
    np.testing.assert_allclose(recording["P"], 2e-3 * np.arange(20), atol=1e-15)
    with pytest.raises(InputError, match="clocks in different units: ms, us"):
        log(tmp_path, "p_timestamp,P,f_timestamp,F", rows, units=units | {"f_timestamp": "ms"})


def test_friction_originals_agree_with_the_clean_files(shared: Path) -> None:
    """Somebody else's clean version of the same recording: each force once, the position interpolated there."""
    folder = shared / "recordings" / "friction_pull"
    options = ReadOptions(units={"position": "mm", "force": "N"}, time_unit="us")
    for number in (4, 6, 7):
        original = read_one(folder / "original" / f"kinetic_test_{number}_motor_speed_2000_mass_1094.csv", options)
        clean = read_one(folder / f"run-{number}.csv")
        count = len(clean.time)
        assert abs(len(original.time) - count) <= 1
        np.testing.assert_allclose(original.time[:count], clean.time, atol=1e-6)
        np.testing.assert_allclose(original["force"][:count], clean["force"], rtol=1e-5, atol=1e-6)
        np.testing.assert_allclose(original["position"][:count], clean["position"], atol=2e-7)
