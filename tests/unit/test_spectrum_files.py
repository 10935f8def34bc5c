"""``ident spectrum`` on bare logs: volts, file names, uneven clocks, slow lines, bad calls."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from typer.testing import CliRunner

from ssmr_ident.cli import app
from ssmr_ident.core.errors import InputError
from ssmr_ident.core.recording import Channel, Provenance, Recording
from ssmr_ident.signals.grid import even_samples
from ssmr_ident.workflows.spectrum import run as spectrum_module
from ssmr_ident.workflows.spectrum.files import write
from ssmr_ident.workflows.spectrum.run import SpectrumChoices, spectrum
from ssmr_ident.workflows.spectrum.table import label_of_file


def write_csv(path: Path, time: np.ndarray, **columns: np.ndarray) -> Path:
    names = ",".join(["time [s]", *(f"{name} [m/s^2]" for name in columns)])
    np.savetxt(path, np.column_stack([time, *columns.values()]), "%.7f", ",", header=names, comments="")
    return path


def test_volts_without_a_session_use_the_thesis_and_say_so(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    t = np.arange(4096) / 1000
    volts = 2.6 + 5 / (3.4 * 9.8) * 0.5 * np.sin(2 * np.pi * 8 * t)
    recording = Recording(
        t,
        (Channel("ax", volts, "V", "x"), Channel("trigger", np.ones(4096), "V", "t")),
        Provenance("v0-w30-t20-frame-tile.lvm", "0" * 64, "lvm"),
    )
    monkeypatch.setattr(spectrum_module, "read_one", lambda path, options: recording)
    report = spectrum([tmp_path / "v0-w30-t20-frame-tile.lvm"])
    ax, trigger = report.rows
    assert (ax.unit, trigger.unit) == ("m/s^2", "V")
    assert ax.analysis.amplitude == pytest.approx(0.5, rel=0.01)
    assert any("3.4·9.8/5·(V − 2.6)" in note.text for _, note in report.notes)
    assert (ax.label.yaw_rate_deg_s, ax.label.floor, ax.label.frame) == (30.0, "tile", "frame")


def test_other_names_say_nothing() -> None:
    label = label_of_file(Path("roll-1.xlsx"))
    assert (label.experiment, label.floor, label.configuration) == (None, "", "all swivels")
    assert np.isnan(label.yaw_rate_deg_s)


def test_lost_rows_are_bridged_and_said(tmp_path: Path) -> None:
    t = np.arange(3000) / 200.0
    keep = (t < 5) | (t > 5.2)
    log = write_csv(tmp_path / "gap.csv", t[keep], ax=np.sin(2 * np.pi * 4 * t[keep]))
    report = spectrum([log], SpectrumChoices(part="all"))
    assert report.rows[0].analysis.sample_rate == pytest.approx(200.0)
    assert len(report.rows[0].analysis.samples) == 3000
    assert any("interpolated" in note.text for _, note in report.notes)
    assert report.rows[0].analysis.peaks.frequency[0] == pytest.approx(4.0, abs=0.07)


def test_even_stamps_are_left_alone_and_holes_are_not_taken() -> None:
    time = np.round(np.arange(500) / 80.0, 3)  # rounded to ms as loggers do
    samples = np.random.default_rng(0).standard_normal((500, 2))
    even = even_samples(time, samples)
    assert even.samples is not samples
    np.testing.assert_array_equal(even.samples, samples)
    assert even.notes == ()
    samples[100:103, 0] = np.nan
    holed = even_samples(time, samples)
    assert len(holed.samples) == 500
    assert np.isfinite(holed.samples).all()
    assert "3 of 500" in holed.notes[0].text
    with pytest.raises(InputError, match="finite samples"):
        even_samples(time, np.full((500, 1), np.nan))
    with pytest.raises(InputError, match="does not increase"):
        even_samples(time[::-1], np.zeros((500, 1)))


def test_a_slow_line_is_named(tmp_path: Path) -> None:
    t = np.arange(2000) / 100.0
    log = write_csv(tmp_path / "slow.csv", t, ax=np.sin(2 * np.pi * 0.4 * t) + 0.1 * np.sin(2 * np.pi * 9 * t))
    report = spectrum([log], SpectrumChoices(part="all"))
    assert any("--band" in note.text for _, note in report.notes)
    wide = spectrum([log], SpectrumChoices(part="all", band_hz=(0.1, 50.0)))
    assert not wide.notes
    assert wide.rows[0].analysis.peaks.frequency[0] == pytest.approx(0.4)


@pytest.mark.slow
def test_same_names_in_two_folders_stay_apart(tmp_path: Path) -> None:
    t = np.arange(500) / 100.0
    logs = []
    for folder in ("a", "b"):
        (tmp_path / folder).mkdir()
        logs.append(write_csv(tmp_path / folder / "run.csv", t, ax=np.sin(2 * np.pi * 5 * t)))
    report = write(spectrum(logs), tmp_path / "out")
    assert len([path for path in report.files if path.suffix == ".png"]) == 2


def test_logs_of_a_hundred_hertz_and_less_are_taken(tmp_path: Path) -> None:
    t = np.arange(400) / 40.0
    log = write_csv(tmp_path / "slow-rate.csv", t, ax=np.sin(2 * np.pi * 8 * t))
    row = spectrum([log]).rows[0].as_dict()
    assert row["mains_60_hz_amplitude"] is None
    assert row["peak_1_hz"] == pytest.approx(8.0, abs=0.16)


@pytest.mark.parametrize(
    ("arguments", "word"),
    [
        (["--range", "midle"], "Did you mean 'middle'"),
        (["--low-pass", "-3"], "--low-pass"),
        (["--low-pass", "0.01"], "too short"),
        (["--half-width", "0"], "--half-width"),
        (["--band", "5"], "--band"),
        (["--sample", "0"], "--sample"),
        (["--units", "ax"], "--units"),
    ],
)
def test_bad_calls_are_input_errors(tmp_path: Path, arguments: list[str], word: str) -> None:
    t = np.arange(500) / 100.0
    log = write_csv(tmp_path / "log.csv", t, ax=np.sin(2 * np.pi * 5 * t))
    result = CliRunner().invoke(app, ["spectrum", str(log), *arguments])
    assert isinstance(result.exception, InputError)
    assert word in str(result.exception)


def test_a_log_of_a_few_samples_is_refused_in_words(tmp_path: Path) -> None:
    t = np.arange(6) / 100.0
    log = write_csv(tmp_path / "tiny.csv", t, ax=np.sin(t))
    with pytest.raises(InputError, match="8 are needed"):
        spectrum([log])


def test_out_must_not_be_a_file(tmp_path: Path) -> None:
    t = np.arange(500) / 100.0
    log = write_csv(tmp_path / "log.csv", t, ax=np.sin(2 * np.pi * 5 * t))
    with pytest.raises(InputError, match="is a file"):
        write(spectrum([log]), log)
