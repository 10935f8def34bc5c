"""The questions of ``ident new``, answered by typing."""

from __future__ import annotations

import os
import re
import select
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
import yaml
from typer.testing import CliRunner

from ssmr_ident.cli import app
from ssmr_ident.core.errors import InputError
from ssmr_ident.session import read_parameters, read_session
from ssmr_ident.workflows.new.answers import value_of

TIME = np.arange(700) / 100


def block(folder: Path) -> Path:
    """Two pulls of a block of 5 kg: quiet, a rise to 20 N, then sliding at 16 N."""
    noise = np.random.default_rng(3).normal(size=(2, len(TIME)))
    for speed, own in zip((10, 20), noise, strict=True):
        force = np.where(TIME > 2.0, 16.0, np.clip(20.0 * (TIME - 1.0), 0.0, 20.0)) + 0.05 * own
        rows = "".join(f"{t:.2f},{f:.4f}\n" for t, f in zip(TIME, force, strict=True))
        (folder / f"pull_{speed}mms.csv").write_text("Time (s),Load (N)\n" + rows)
    return folder


def robot(folder: Path) -> Path:
    decay = np.exp(-0.8 * TIME) * np.sin(30 * TIME)
    rows = "".join(f"{t:.2f},{0.1 * a:.5f},{a:.5f},{9.81:.2f}\n" for t, a in zip(TIME, decay, strict=True))
    (folder / "roll-1.csv").write_text("time [s],ax [m/s^2],ay [m/s^2],az [m/s^2]\n" + rows)
    return folder


def typed(folder: Path, *lines: str, options: tuple[str, ...] = ("--ask",)) -> str:
    """What a person sees who types these lines."""
    result = CliRunner().invoke(app, ["new", str(folder), *options], input="".join(f"{line}\n" for line in lines))
    assert result.exit_code == 0, result.exception
    return result.output


def prompts(seen: str) -> list[str]:
    return re.findall(r"^  (\S+)(?: \[.*?\]|: )", seen, re.MULTILINE)


def test_one_question_at_a_time_with_its_guess(tmp_path: Path) -> None:
    seen = typed(block(tmp_path), "5", "", "25")
    assert prompts(seen)[:3] == ["mass_kg", "pull_10mms.csv:speed_mm_s", "pull_20mms.csv:speed_mm_s"]
    assert "friction of 0.4, as many dry pairs have" in seen.split("mass_kg")[0]  # why, and then the question
    assert "pull_10mms.csv:speed_mm_s [10]:" in seen
    assert [entry.speed_mm_s for entry in read_session(tmp_path).entries] == [10.0, 25.0]
    known = read_parameters(tmp_path / "rig.yaml")
    assert known.number("mass_kg") == 5.0
    assert known.number("mu_kinetic") == pytest.approx(16 / (5 * 9.80665), rel=0.01)
    assert "guesses" not in seen  # what was taken is none any more
    assert "from the name" not in (tmp_path / "session.yaml").read_text()


def test_an_empty_line_is_no_mass(tmp_path: Path) -> None:
    seen = typed(block(tmp_path), "", "", "")
    assert "guesses, each to be changed" in seen
    assert "a guess by a friction" in read_parameters(tmp_path / "rig.yaml").estimates["mass_kg"].source


def test_what_cannot_be_is_asked_again(tmp_path: Path) -> None:
    seen = typed(block(tmp_path), "five", "-5", "5", "fast", "10", "[1,", "20")
    assert seen.count("mass_kg [") == 3
    assert "is 'five', expected a number" in " ".join(seen.split()) or "expected a finite number" in seen
    assert seen.count("pull_10mms.csv:speed_mm_s [") == 2
    assert "cannot be read" in seen
    assert [entry.speed_mm_s for entry in read_session(tmp_path).entries] == [10.0, 20.0]


def test_a_robot_s_open_keys_are_asked_and_may_stay_open(tmp_path: Path) -> None:
    contacts = "[[-0.2, 0.2, -0.1], [0.2, 0.2, -0.1], [0.2, -0.2, -0.1], [-0.2, -0.2, -0.1]]"
    seen = typed(robot(tmp_path), "20.5", *[""] * 3, contacts, *[""] * 4)
    assert prompts(seen)[:4] == ["mass_kg", "inertia_kg_m2.xx", "inertia_kg_m2.yy", "inertia_kg_m2.zz"]
    written = yaml.safe_load((tmp_path / "robot.yaml").read_text())
    assert written["mass_kg"]["value"] == 20.5
    assert written["contact_points_m"]["value"][1] == [0.2, 0.2, -0.1]
    assert written["inertia_kg_m2"]["xx"]["value"] == "TODO"
    assert "fill in what is asked, then: ident diagnose" in seen


@pytest.mark.parametrize("options", [(), ("--no-ask",), ("--ask", "--set", "mass_kg=5", "--set", "speed_mm_s=10")])
def test_nothing_is_asked_in_a_pipe_or_where_all_is_said(tmp_path: Path, options: tuple[str, ...]) -> None:
    seen = typed(block(tmp_path), options=options)
    assert "An empty line" not in seen
    assert "written:" in seen


def test_answers_are_checked_as_the_files_are(tmp_path: Path) -> None:
    assert value_of("pull.csv:speed_mm_s", "2.5") == 2.5
    with pytest.raises(InputError, match="speed_mm_s"):
        value_of("pull.csv:speed_mm_s", "fast")
    result = CliRunner().invoke(app, ["new", str(block(tmp_path)), "--set", "speed_mm_s=fast"])
    assert isinstance(result.exception, InputError)
    assert not (tmp_path / "session.yaml").exists()


@pytest.mark.slow
@pytest.mark.skipif(os.name != "posix", reason="a pseudo-terminal is needed")
@pytest.mark.parametrize(("keys", "status"), [(["5", "", ""], 0), (["5", "\x04"], 130)])
def test_in_a_terminal_it_asks_by_itself(tmp_path: Path, keys: list[str], status: int) -> None:
    """Lines are typed when their question has come; an end of input (Ctrl-D) leaves nothing behind."""
    import pty

    master, slave = pty.openpty()
    command = [sys.executable, "-m", "ssmr_ident", "new", str(block(tmp_path))]
    with subprocess.Popen(command, stdin=slave, stdout=slave, stderr=subprocess.DEVNULL) as process:
        os.close(slave)
        seen, left = b"", list(keys)
        while select.select([master], [], [], 60)[0]:
            try:
                seen += os.read(master, 4096)
            except OSError:  # Linux says so that the other end is closed
                break
            if left and seen.endswith((b"]:", b"]: ")):
                line = left.pop(0)
                os.write(master, (line if line == "\x04" else f"{line}\n").encode())
        else:
            process.kill()  # it waits for a line that nobody types
    os.close(master)
    assert process.returncode == status
    assert b"An empty line keeps" in seen
    assert not left
    assert (tmp_path / "session.yaml").exists() == (status == 0)
