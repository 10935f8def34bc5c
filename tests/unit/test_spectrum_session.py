"""``ident spectrum`` on a made campaign of swivels whose lines, amplitudes and repeats are known."""

from __future__ import annotations

import csv
import json
from pathlib import Path

import numpy as np
import pytest
from typer.testing import CliRunner

from ssmr_ident.cli import app
from ssmr_ident.core.errors import InputError
from ssmr_ident.report.figures_speed import amplitude_figure, peaks_figure
from ssmr_ident.workflows.spectrum.files import write
from ssmr_ident.workflows.spectrum.run import SpectrumChoices, spectrum
from ssmr_ident.workflows.spectrum.screen import screen_text

RATE = 250.0
LINES = {("concrete", 20): 24.0, ("concrete", 40): 8.0, ("carpet", 20): 6.0, ("carpet", 40): 7.0}
HEIGHTS = {("concrete", 20): 0.1, ("concrete", 40): 0.8, ("carpet", 20): 0.4, ("carpet", 40): 0.9}
HUM = 0.05


def log_rows(line: float, height: float, repeat: int) -> np.ndarray:
    """Ten seconds of a line in ay, half of it in ax, gravity and a slow line in az, hum everywhere."""
    t = np.arange(int(10 * RATE)) / RATE
    hum = HUM * np.cos(2 * np.pi * 60 * t)
    rng = np.random.default_rng(repeat)
    y = height * (1 + 0.1 * repeat) * np.sin(2 * np.pi * line * t + repeat)
    noise = 0.001 * rng.standard_normal((len(t), 3))
    return np.column_stack([t, y / 2 + hum, y + hum, 9.8 + 0.2 * np.sin(2 * np.pi * 3.5 * t) + hum]) + np.pad(
        noise, ((0, 0), (1, 0))
    )


def write_log(path: Path, rows: np.ndarray) -> None:
    np.savetxt(path, rows, fmt="%.6f", delimiter=",", header="time [s],ax [m/s^2],ay [m/s^2],az [m/s^2]", comments="")


@pytest.fixture(scope="module")
def session(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("swivels")
    lines = ["schema: ssmr-ident/session/1", "name: swivels", "robot: p3at-extended", "recordings:"]
    for (floor, speed), line in LINES.items():
        for repeat in range(3):
            name = f"{floor}-{speed}-{repeat}.csv"
            write_log(folder / name, log_rows(line, HEIGHTS[floor, speed], repeat))
            lines += [f"- file: {name}", "  experiment: swivel", f"  yaw_rate_deg_s: {speed * (-1) ** repeat}"]
            lines += [f"  floor: {floor}", "  frame: aluminium"]
    (folder / "session.yaml").write_text("\n".join(lines) + "\n", encoding="utf-8")
    return folder


@pytest.mark.slow
def test_table_holds_what_was_put_in(session: Path, tmp_path: Path) -> None:
    report = write(spectrum([session]), tmp_path, figures=False)
    with (tmp_path / "spectrum.csv").open(encoding="utf-8") as stream:
        table = list(csv.DictReader(stream))
    assert len(table) == len(report.rows) == 12 * 3
    resolution = RATE / 2048
    for row in table:
        key = (row["floor"], abs(int(float(row["yaw_rate_deg_s"]))))
        assert (row["first_sample"], row["samples"], row["range"]) == ("226", "2048", "middle")
        assert float(row["mains_60_hz_amplitude"]) == pytest.approx(HUM, abs=5e-4)
        if row["channel"] == "ay":
            repeat = int(row["file"][-5])
            height = HEIGHTS[key] * (1 + 0.1 * repeat)
            assert float(row["peak_1_hz"]) == pytest.approx(LINES[key], abs=resolution / 2)
            # between two bins a line loses up to 36 %
            assert 0.63 * height < float(row["peak_1_amplitude"]) < 1.01 * height
            assert float(row["amplitude"]) == pytest.approx(height, rel=0.06)
        if row["channel"] == "az":
            assert float(row["mean"]) == pytest.approx(9.8, abs=0.01)


@pytest.mark.slow
def test_repeats_are_averaged_over_both_senses_of_turning(session: Path) -> None:
    report = spectrum([session])
    assert len(report.averages) == 4 * 3
    for average in report.averages:
        assert average.repeats == 3
        floor = average.configuration.split(",")[0]
        if average.channel == "ay":
            height = HEIGHTS[floor, round(average.speed)]
            assert average.amplitude.mean() == pytest.approx(1.1 * height, rel=0.05)
    row = next(row for row in report.average_rows() if row["channel"] == "ay")
    assert row["configuration"] == "carpet, aluminium"
    assert row["yaw_rate_deg_s"] == 20
    assert row["amplitude_std"] == pytest.approx(0.1 * 0.4, rel=0.1)


@pytest.mark.slow
def test_figures_are_drawn_and_the_same_twice(session: Path, tmp_path: Path) -> None:
    report = spectrum([session])
    few = [row for row in report.rows if row.label.file.endswith("0.csv")][:3]
    small = type(report)(report.source, tuple(few), report.averages, (), report.speed_label)
    first = write(small, tmp_path / "a", format="svg")
    second = write(small, tmp_path / "b", format="svg")
    names = {path.name for path in first.files}
    assert names == {
        *("spectrum.csv", "spectrum-average.csv", "spectrum-concrete-20-0.csv.svg", "amplitude-over-speed.svg"),
        *("peaks-over-speed-concrete-aluminium.svg", "peaks-over-speed-carpet-aluminium.svg"),
    }
    for one, other in zip(first.files, second.files, strict=True):
        assert one.read_bytes() == other.read_bytes()


@pytest.mark.slow
def test_axes_over_speed_hold_every_point(session: Path) -> None:
    report = spectrum([session])
    own = [average for average in report.averages if average.configuration == "concrete, aluminium"]
    figures = [
        peaks_figure("concrete, aluminium", own, report.speed_label),
        amplitude_figure(report.averages, report.speed_label),
    ]
    for figure in figures:
        for axes in figure.axes:
            points = np.concatenate([line.get_xydata() for line in axes.lines])
            points = points[np.isfinite(points).all(axis=1)]
            assert len(points) >= 2 * 4  # two speeds: a mean and three repeats each
            (left, right), (bottom, top) = axes.get_xlim(), axes.get_ylim()
            assert left == 0
            assert bottom == 0
            assert points[:, 0].max() <= right < 2 * 40
            assert points[:, 1].max() <= top
            assert "deg/s" in figure.axes[-1].get_xlabel()


@pytest.mark.slow
def test_choices_reach_the_table(session: Path) -> None:
    report = spectrum([session], SpectrumChoices(part="2:6", low_pass_hz=20.0))
    chosen = next(r for r in report.rows if r.label.file == "concrete-20-0.csv" and r.channel == "ay")
    row = chosen.as_dict()
    assert (row["first_sample"], row["samples"], row["low_pass_hz"]) == (500, 1000, 20.0)
    gain = 1 / (1 + (24.0 / 20.0) ** 20)
    assert np.ptp(chosen.analysis.low_passed[200:-200]) / 2 == pytest.approx(0.1 * gain, abs=2e-3)


@pytest.mark.slow
def test_the_screen_shows_every_log_once(session: Path) -> None:
    text = screen_text(spectrum([session]))
    for floor, speed in LINES:
        assert text.count(f"{floor}-{speed}-1.csv") == 1
    assert "averages over repeats" in text
    assert "concrete, aluminium" in text


@pytest.mark.slow
def test_json_is_json(session: Path) -> None:
    result = CliRunner().invoke(app, ["spectrum", str(session), "--json", "--no-figures"])
    assert result.exit_code == 0
    answer = json.loads(result.stdout)
    assert len(answer["rows"]) == 36
    assert answer["rows"][0]["unit"] == "m/s^2"


def test_a_session_and_a_log_do_not_mix(session: Path) -> None:
    with pytest.raises(InputError, match="is a session"):
        spectrum([session, session / "carpet-20-0.csv"])


@pytest.mark.slow
def test_a_range_outside_the_log_names_log_and_channel(session: Path) -> None:
    with pytest.raises(InputError, match=r"concrete-20-0.csv: ax: --range: 30:40 holds 0 samples"):
        spectrum([session], SpectrumChoices(part="30:40"))
