"""Workbooks beyond the samples: one sheet with everything, dates, axes by position, name and choice."""

from __future__ import annotations

import zipfile
from datetime import datetime, timedelta
from pathlib import Path

import numpy as np
import openpyxl
import pytest

from ssmr_ident.core.errors import InputError
from ssmr_ident.readers import ReadOptions, read, read_one

RNG = np.random.default_rng(9)
VOLTS = (2.6 + 0.1 * RNG.standard_normal((3, 60))).round(5)


def save(path: Path, sheets: dict[str, list[list[object]]]) -> Path:
    book = openpyxl.Workbook()
    book.remove(book.active)
    for name, rows in sheets.items():
        sheet = book.create_sheet(name)
        for row in rows:
            sheet.append(row)
    book.save(path)
    return path


def columns(axis: int, step: float = 1e-3) -> list[list[object]]:
    return [[k * step, float(v)] for k, v in enumerate(VOLTS[axis])]


def test_one_sheet_with_all_columns_and_absolute_time(tmp_path: Path) -> None:
    """What 'Write To Measurement File' makes by default: date cells, one sheet per group."""
    start = datetime(2014, 5, 10, 23, 59, 59, 970_000)
    rows = [["Time", "Voltage_0", "Voltage_1", "Voltage_2"]]
    rows += [[start + timedelta(milliseconds=k), *map(float, v)] for k, v in enumerate(VOLTS.T)]
    recording = read_one(save(tmp_path / "a.xlsx", {"Untitled": rows}))
    np.testing.assert_allclose(recording.time, np.arange(60) * 1e-3, atol=1e-6)
    for name, values in zip(("ax", "ay", "az"), VOLTS, strict=True):
        np.testing.assert_array_equal(recording[name], values)
    assert [channel.label for channel in recording.channels] == ["Voltage_0", "Voltage_1", "Voltage_2"]


def test_date_cells_too_coarse_for_the_rate(tmp_path: Path) -> None:
    start = datetime(2014, 5, 10, 12)
    sheets = {
        n: [[start + timedelta(microseconds=1250 * k), float(v)] for k, v in enumerate(VOLTS[i])]
        for i, n in enumerate("zyx")
    }
    path = save(tmp_path / "a.xlsx", sheets)
    with pytest.raises(InputError, match="date-time cells resolve 1 ms, too coarse for steps of"):
        read(path)
    assert read_one(path, ReadOptions(fs=800.0)).sample_rate == pytest.approx(800.0)


def test_one_sheet_of_a_testing_machine(tmp_path: Path) -> None:
    rows = [["Time (s)", "Load (kN)"], *[[k / 10, k / 100] for k in range(30)]]
    recording = read_one(save(tmp_path / "a.xlsx", {"Test": rows}))
    np.testing.assert_allclose(recording["force"], np.arange(30) * 10.0, rtol=1e-12)


def test_position_name_and_choice(tmp_path: Path) -> None:
    by_position = read_one(save(tmp_path / "a.xlsx", {f"S{i}": columns(i) for i in range(3)}))
    np.testing.assert_array_equal(by_position["ax"], VOLTS[2])
    np.testing.assert_array_equal(by_position["az"], VOLTS[0])
    by_name = read_one(save(tmp_path / "b.xlsx", {"x": columns(0), "y": columns(1), "z": columns(2)}))
    np.testing.assert_array_equal(by_name["ax"], VOLTS[0])
    assert any("not z, y, x as by position; the names were followed" in note.text for note in by_name.warnings)
    chosen = read_one(tmp_path / "a.xlsx", ReadOptions(sheets={"x": 1, "y": "S1", "z": 3}))
    np.testing.assert_array_equal(chosen["ax"], VOLTS[0])
    with pytest.raises(InputError, match="named x, by position it would be z"):
        read(save(tmp_path / "c.xlsx", {"x": columns(0), "b": columns(1), "c": columns(2)}))
    with pytest.raises(InputError, match="Did you mean 'S1'"):
        read(tmp_path / "a.xlsx", ReadOptions(sheets={"x": "S11"}))
    with pytest.raises(InputError, match="sheet 7 for x is not there"):
        read(tmp_path / "a.xlsx", ReadOptions(sheets={"x": 7}))


def test_the_same_axis_pasted_twice(tmp_path: Path) -> None:
    path = save(tmp_path / "a.xlsx", {"S1": columns(0), "S2": columns(1), "S3": columns(1)})
    with pytest.raises(InputError, match="sheets S3 and S2 are identical"):
        read(path)


def test_axes_of_another_grid(tmp_path: Path) -> None:
    path = save(tmp_path / "a.xlsx", {"S1": columns(0), "S2": columns(1, 2e-3), "S3": columns(2)})
    with pytest.raises(InputError, match="same count of samples at different times"):
        read(path)
    assert len(read_one(path, ReadOptions(trim=True)).time) == 30


def test_length_against_the_name(tmp_path: Path) -> None:
    rows = {f"S{i}": columns(i, 1 / 3) for i in range(3)}
    for name, told in (("v0-w90-t20-concrete", False), ("v0-w90-t25-concrete", True), ("roll-1", False)):
        path = save(tmp_path / f"{name}.xlsx", rows)
        recording = read_one(path, ReadOptions(time_unit="s"))
        assert any("its name says 25 s" in note.text for note in recording.warnings) == told


def test_volts_at_the_edge(tmp_path: Path) -> None:
    rows = {f"S{i}": columns(i) for i in range(3)}
    rows["S0"][5][1] = 5.3
    recording = read_one(save(tmp_path / "a.xlsx", rows))
    assert any("outside the sensor's 0…5 V" in note.text for note in recording.warnings)
    assert any("clipped: 1 sample(s) at the rails" in note.text for note in recording.warnings)


def test_text_below_and_cells_beside_the_data(tmp_path: Path) -> None:
    rows = {f"S{i}": columns(i) for i in range(3)}
    rows["S0"] += [[], ["mean", "2.6 V"]]
    rows["S1"][3] = [*rows["S1"][3], "", "remark"]
    recording = read_one(save(tmp_path / "a.xlsx", rows))
    np.testing.assert_array_equal(recording["az"], VOLTS[0])
    text = " ".join(note.text for note in recording.warnings)
    assert "text below the data not read: mean 2.6 V" in text
    assert "beside the data not read" in text


def test_a_sheet_without_time_that_states_its_rate(tmp_path: Path) -> None:
    book = openpyxl.Workbook()
    sheet = book.active
    for row in ([None, "Sampling rate", "200 Hz"], [], [None, "Force", "Accel"], [None, "N", "m/s²"]):
        sheet.append(row)
    for k in range(60):
        sheet.append([None, float(k % 7), 0.1 * k])
    book.save(tmp_path / "a.xlsx")
    recording = read_one(tmp_path / "a.xlsx")
    assert recording.names == ("force", "acceleration")
    assert recording.sample_rate == pytest.approx(200.0)


def test_booleans_are_no_volts(tmp_path: Path) -> None:
    rows = {f"S{i}": columns(i) for i in range(3)}
    rows["S2"][7][1] = True
    with pytest.raises(InputError, match=r"S2:B8: text 'True' inside the data"):
        read(save(tmp_path / "a.xlsx", rows))


def test_a_far_cell_behind_damage_is_not_laid_out(tmp_path: Path) -> None:
    """One parser stops at the damage, another would read over it: neither is shown what comes after."""
    path = save(tmp_path / "a.xlsx", {name: columns(k) for k, name in enumerate("zyx")})
    with zipfile.ZipFile(path) as archive:
        parts = {name: archive.read(name) for name in archive.namelist()}
    name = next(name for name in parts if name.endswith("sheet1.xml"))
    body = parts[name].rpartition(b"?>")[2].replace(b'r="A3"', b'r="A1999999999991"')
    parts[name] = b'<?xml version="1. " encoding="UTF-8"?>' + body
    with zipfile.ZipFile(path, "w") as archive:
        for part, data in parts.items():
            archive.writestr(part, data)
    with pytest.raises(InputError, match="is damaged"):
        read(path)
