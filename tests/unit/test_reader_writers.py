"""What is written reads back, is seen alike by other programs, and has the same bytes each time."""

from __future__ import annotations

import hashlib
import zipfile
from pathlib import Path

import numpy as np
import openpyxl
import pandas as pd
import pytest

from ssmr_ident.core.errors import InputError
from ssmr_ident.core.recording import Channel, Provenance, Recording
from ssmr_ident.readers import read_one
from ssmr_ident.readers.writers import write_csv, write_labview_xlsx, write_lvm, write_mtestquattro


def accelerometer(count: int = 300) -> Recording:
    values = 2.6 + 0.2 * np.random.default_rng(1).standard_normal((3, count))
    channels = tuple(
        Channel(f"a{a}", v, "V", f"Voltage_{i}") for i, (a, v) in enumerate(zip("xyz", values, strict=True))
    )
    return Recording(np.arange(count) * 1e-3, channels, Provenance("", "", ""))


def pull(count: int = 300) -> Recording:
    force = 5 * np.random.default_rng(2).standard_normal(count)
    channels = Channel("position", np.linspace(0, 0.03, count), "m", "Position"), Channel("force", force, "N", "Load")
    return Recording(np.arange(count) * 0.01, channels, Provenance("", "", ""))


def test_csv_reads_back_to_the_same_doubles(tmp_path: Path) -> None:
    recording = read_one(write_csv(tmp_path / "a.csv", pull()))
    np.testing.assert_array_equal(recording.time, pull().time)
    np.testing.assert_array_equal(recording["force"], pull()["force"])
    np.testing.assert_array_equal(recording["position"], pull()["position"])
    table = pd.read_csv(tmp_path / "a.csv")
    assert list(table.columns) == ["time [s]", "Position [m]", "Load [N]"]
    np.testing.assert_array_equal(table["Load [N]"], pull()["force"])


def test_csv_keeps_gaps(tmp_path: Path) -> None:
    values = pull()["force"].copy()
    values[7] = np.nan
    recording = Recording(pull().time, (Channel("force", values, "N"),), Provenance("", "", ""))
    np.testing.assert_array_equal(
        read_one(write_csv(tmp_path / "a.csv", recording, decimals=4))["force"], values.round(4)
    )


@pytest.mark.parametrize("header", ["graph", "segment", "none"])
def test_workbook_reads_back_here_and_in_openpyxl(tmp_path: Path, header: str) -> None:
    path = write_labview_xlsx(tmp_path / "a.xlsx", accelerometer(), header=header, decimals=5)
    recording = read_one(path)
    book = openpyxl.load_workbook(path)
    first = {"graph": 2, "segment": 11, "none": 1}[header]
    for axis, sheet in zip(("az", "ay", "ax"), book.worksheets, strict=True):
        np.testing.assert_array_equal(recording[axis], accelerometer()[axis].round(5))
        rows = list(sheet.iter_rows(min_row=first, max_col=2, values_only=True))
        np.testing.assert_array_equal([row[1] for row in rows], recording[axis])
        np.testing.assert_array_equal([row[0] for row in rows], recording.time)
    np.testing.assert_array_equal(recording.time, accelerometer().time.round(9))


def test_same_recording_same_bytes(tmp_path: Path) -> None:
    for write, recording in (
        (write_labview_xlsx, accelerometer()), (write_lvm, accelerometer()), (write_csv, pull()),
        (write_mtestquattro, pull()),
    ):  # fmt: skip
        digests = {hashlib.sha256(write(tmp_path / n, recording).read_bytes()).hexdigest() for n in ("a", "b")}
        assert len(digests) == 1
    with zipfile.ZipFile(write_labview_xlsx(tmp_path / "a", accelerometer())) as archive:
        assert {entry.date_time for entry in archive.infolist()} == {(1980, 1, 1, 0, 0, 0)}


@pytest.mark.parametrize("decimal", [".", ","])
def test_lvm_reads_back_here_and_in_lvmio(tmp_path: Path, decimal: str) -> None:
    lvmio = pytest.importorskip("lvmio")
    path = write_lvm(tmp_path / "a.lvm", accelerometer(), decimal=decimal)
    recording = read_one(path)
    assert not recording.warnings
    theirs = lvmio.read_lvm(path).segments[0]
    for channel, other, given in zip(recording.channels, theirs.channels, accelerometer().channels, strict=True):
        np.testing.assert_array_equal(channel.samples, given.samples.round(6))
        np.testing.assert_array_equal(channel.samples, other.data)
        assert channel.label == other.name == given.label
        assert other.unit == "Volts"
    np.testing.assert_allclose(recording.time, accelerometer().time, atol=5e-7)


@pytest.mark.parametrize(("style", "units"), [("tab", ("mm", "N")), ("csv", ("in", "lbf")), ("tab", ("mm", "kN"))])
def test_machine_text_reads_back(tmp_path: Path, style: str, units: tuple[str, str]) -> None:
    path = write_mtestquattro(
        tmp_path / "a.txt", pull(), style=style, position_unit=units[0], load_unit=units[1], decimals=(3, 6, 6),
        facts={"Procedure": "Rolling force"},
    )  # fmt: skip
    recording = read_one(path)
    assert recording.provenance.reader == "mtestquattro"
    np.testing.assert_allclose(recording["position"], pull()["position"], atol=0.6e-6 * 0.0254)
    np.testing.assert_allclose(recording["force"], pull()["force"], atol=0.6e-6 * 1000)
    assert recording.channel("force").label == "Load"
    assert (recording.header.get("Procedure") == "Rolling force") == (style == "csv")


def test_writers_refuse_what_they_cannot_write(tmp_path: Path) -> None:
    with pytest.raises(InputError, match="az is not among them"):
        write_labview_xlsx(tmp_path / "a.xlsx", pull())
    with pytest.raises(InputError, match="needs position"):
        write_mtestquattro(tmp_path / "a.txt", accelerometer())
    with pytest.raises(InputError, match="needs force in a unit of N"):
        write_mtestquattro(tmp_path / "a.txt", pull(), load_unit="mm")
    (tmp_path / "a file").touch()
    with pytest.raises(InputError, match="a file"):
        write_csv(tmp_path / "a file" / "a.csv", pull())
    assert [entry.name for entry in tmp_path.iterdir()] == ["a file"]


def test_a_file_appears_whole_or_not_at_all(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    path = tmp_path / "a.csv"
    path.write_text("old")

    def fail(*_: object) -> None:
        raise OSError(28, "disk full")

    monkeypatch.setattr(Path, "replace", fail)
    with pytest.raises(InputError, match="disk full"):
        write_csv(path, pull())
    assert path.read_text() == "old"
    assert [entry.name for entry in tmp_path.iterdir()] == ["a.csv"]
