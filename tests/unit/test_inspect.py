"""``ident inspect``: what it prints, what it saves, how it ends."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest
import yaml
from typed_command import typed
from typer.testing import CliRunner

from ssmr_ident.cli import app
from ssmr_ident.core.errors import InputError
from ssmr_ident.core.recording import Channel, Provenance, Recording
from ssmr_ident.readers.health import health_of, saturated, warnings_of
from ssmr_ident.readers.writers import write_csv, write_labview_xlsx


def recording(hum: float = 0.02, clip: bool = False) -> Recording:
    t = np.arange(4000) * 1e-3
    noise = np.random.default_rng(0).standard_normal((3, len(t)))
    values = [2.6 + 0.001 * n + hum * np.cos(2 * np.pi * 60 * t) for n in noise]
    values[2] = values[2] + 5 / 3.4
    if clip:
        values[0] = np.clip(values[0] + 3.0 * np.exp(-t * 10), 0.0, 5.0)
    channels = tuple(
        Channel(f"a{a}", v, "V", f"Voltage_{i}") for i, (a, v) in enumerate(zip("xyz", values, strict=True))
    )
    return Recording(t, channels, Provenance("", "", ""))


def run(*arguments: object) -> tuple[int, str, Exception | None]:
    result = CliRunner().invoke(app, ["inspect", *map(str, arguments)])
    return result.exit_code, result.output, result.exception if not isinstance(result.exception, SystemExit) else None


def test_screen(tmp_path: Path) -> None:
    code, text, _ = run(write_labview_xlsx(tmp_path / "a.xlsx", recording()))
    assert code == 0
    assert "reader labview-xlsx, 4000 samples, 3.999 s from t = 0 s, 1000 Hz" in text
    assert "0 gap(s)" in text
    for axis in ("ax", "ay", "az"):
        assert f"{axis}       Amplitude - Plot 0  V" in text
    assert "0.02±" in text
    assert "axes by position" in text


def test_json_holds_the_numbers(tmp_path: Path) -> None:
    path = write_labview_xlsx(tmp_path / "a.xlsx", recording(0.02, clip=True))
    code, text, _ = run(path, "--json")
    assert code == 0
    (log,) = json.loads(text)["logs"]
    assert log["reader"] == "labview-xlsx"
    assert log["sample_rate_hz"] == pytest.approx(1000)
    assert log["jitter_s"] < 1e-9
    channels = {channel["name"]: channel for channel in log["channels"]}
    assert channels["ay"]["mains_amplitude"] == pytest.approx(
        0.02, abs=5 * channels["ay"]["mains_amplitude_std"] + 1e-5
    )
    expected = recording(0.02, clip=True)["ax"].round(6)
    assert channels["ax"]["clipped"] == int((expected >= 5 - 1e-3).sum()) > 20
    assert channels["ay"]["clipped"] == channels["az"]["clipped"] == 0
    assert any("±1.7 g exceeded" in note["text"] for note in log["notes"])


def test_gaps_jitter_and_repeats() -> None:
    t = np.delete(np.arange(1000) * 1e-3, slice(500, 520))
    values = np.repeat(np.random.default_rng(1).standard_normal(196), 5)
    health = health_of(Recording(t, (Channel("force", values, "N"),), Provenance("", "", "")))
    assert health.gaps == 1
    assert health.jitter == pytest.approx(0.0103, abs=3e-4)
    assert health.channels[0].repeated == pytest.approx(0.8, abs=0.01)
    assert "1 gaps" in str(health)


def test_saturation() -> None:
    load = np.minimum(np.arange(300) * 1.0, 200.0)
    assert saturated(load) == 100
    assert saturated(np.r_[np.zeros(100), load[:150]]) == 0  # zero before the test is no saturation
    assert saturated(np.full(100, 3.0)) == 0
    assert "saturated" in warnings_of((Channel("force", load, "N", "Load"),))[0].text
    assert "zero throughout" in warnings_of((Channel("force", np.zeros(60), "N", "Load"),))[0].text


def test_quiet_prints_warnings_only(tmp_path: Path) -> None:
    clean = write_labview_xlsx(tmp_path / "a.xlsx", recording())
    assert run(clean, "-q")[:2] == (0, "")
    code, text, _ = run(write_labview_xlsx(tmp_path / "b.xlsx", recording(clip=True)), "-q")
    assert code == 0
    assert text.count("\n") == 1
    assert "clipped" in text


def test_folder(tmp_path: Path) -> None:
    write_labview_xlsx(tmp_path / "a.xlsx", recording())
    write_csv(tmp_path / "b.csv", recording())
    (tmp_path / "~$a.xlsx").write_bytes(b"\x03lab" + b" " * 161)
    (tmp_path / "session.yaml").write_text("schema: x\n")
    code, text, _ = run(tmp_path, "--json")
    assert code == 0
    assert [Path(log["file"]).name for log in json.loads(text)["logs"]] == ["a.xlsx", "b.csv"]
    (tmp_path / "empty").mkdir()
    _, _, error = run(tmp_path / "empty")
    assert isinstance(error, InputError)
    assert "folder without logs" in str(error)


def test_a_folder_without_logs_stands_for_those_below_it(tmp_path: Path) -> None:
    for place in ("runs/a", "runs/b", "runs/a/meta", ".git"):
        (tmp_path / place).mkdir(parents=True, exist_ok=True)
        write_csv(tmp_path / place / "c.csv", recording())
    code, text, _ = run(tmp_path)
    assert code == 0
    lines = [line.partition(": reader")[0].partition(" (")[0] for line in text.splitlines()]
    assert lines[:2] == [str(tmp_path / name) for name in ("runs/a/c.csv", "runs/b/c.csv")]
    assert text.splitlines()[2].startswith("in common of 2 recordings: reader csv; 1000 Hz; ")


def test_one_bad_log_does_not_hide_the_others(tmp_path: Path) -> None:
    for name in ("a.csv", "c.csv"):
        (tmp_path / name).write_text("no numbers here\n")
    write_csv(tmp_path / "b.csv", recording())
    result = typed("inspect", str(tmp_path))
    assert result.returncode == 2
    assert "reader csv, 4000 samples" in result.stdout
    assert result.stderr.count("holds no rows of numbers") == 2
    assert "Traceback" not in result.stderr


def test_error_is_one_line_and_status_2(tmp_path: Path) -> None:
    result = typed("inspect", str(tmp_path / "none.csv"))
    assert result.returncode == 2
    assert result.stdout == ""
    assert result.stderr.startswith(f"ident: {tmp_path / 'none.csv'}: cannot be read (No such file or directory)")
    assert result.stderr.count("\n") == 1


@pytest.mark.parametrize(
    ("arguments", "words"),
    [(["--units", "force"], "is no pair"), (["--fs", "-1"], "--fs: is -1.0, expected"),
     (["--reader", "xls"], "reader 'xls' is not"),
     (["--sample", "0"], "--sample: is 0, expected"), (["--skip", "few"], "--skip: is 'few', expected"),
     (["--mains", "0"], "no frequency")],
)  # fmt: skip
def test_wrong_calls(tmp_path: Path, arguments: list[str], words: str) -> None:
    _, _, error = run(write_csv(tmp_path / "a.csv", recording()), *arguments)
    assert isinstance(error, InputError)
    assert words in str(error)


SESSION = """\
schema: ssmr-ident/session/1   # a comment that stays
name: pulls
robot: robot.yaml
recordings:
  - file: other.csv
    experiment: pull
  - experiment: pull      # the file is not always first
    file: pull.csv
    direction: lateral
    units:
      Load: N
    speed_mm_s: 1.0

# the end
"""


def test_save(tmp_path: Path) -> None:
    rows = "".join(f"{k / 10},{k},{2 * k}\n" for k in range(100))
    (tmp_path / "pull.csv").write_text("A,Position,Load\n" + rows)
    session = tmp_path / "session.yaml"
    session.write_text(SESSION)
    code, text, error = run(
        tmp_path / "pull.csv", "--columns", "time=0,force=Load,position=1", "--units", "force=lbf,position=in",
        "--save", session,
    )  # fmt: skip
    assert (code, error) == (0, None), error
    assert "saved in" in text
    changed = yaml.safe_load(session.read_text())
    entry = changed["recordings"][1]
    assert entry["columns"] == {"time": 0, "force": "Load", "position": 1}
    assert entry["units"] == {"force": "lbf", "position": "in"}
    assert (entry["experiment"], entry["direction"], entry["speed_mm_s"]) == ("pull", "lateral", 1.0)
    assert changed["recordings"][0] == {"file": "other.csv", "experiment": "pull"}
    kept = [line for line in SESSION.splitlines() if "units" not in line and "Load" not in line]
    assert [line for line in session.read_text().splitlines() if line in kept] == kept
    before = session.read_text()
    assert (
        run(tmp_path / "pull.csv", "--columns", "time=0,force=2", "--units", "force=lbf", "--save", session)[2] is None
    )
    assert yaml.safe_load(session.read_text())["recordings"][1]["columns"] == {"time": 0, "force": 2}
    assert before != session.read_text()


def test_save_refuses_what_it_cannot_place(tmp_path: Path) -> None:
    log = write_csv(tmp_path / "pull.csv", recording())
    session = tmp_path / "session.yaml"
    for text, words in (
        ("recordings:\n  - file: other.csv\n", "has no recording with file"),
        ("recordings:\n  - {file: pull.csv, experiment: pull}\n", "stands in braces"),
        ("a: [1\n", "not valid YAML"),
    ):
        session.write_text(text)
        _, _, error = run(log, "--units", "Voltage_0=mV", "--save", session)
        assert isinstance(error, InputError)
        assert words in str(error)
        assert session.read_text() == text
    _, _, error = run(log, "--save", tmp_path / "none.yaml")
    assert isinstance(error, InputError)
