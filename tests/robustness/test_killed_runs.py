"""A run that is killed leaves whole files or none, and writes nowhere but where -o says."""

from __future__ import annotations

import os
import signal
import subprocess
import sys
import time
from pathlib import Path
from typing import Any

import pytest

from ssmr_ident.core.atomic import write_text

ENDS = {".png": b"IEND\xaeB`\x82", ".csv": b"\r\n"}


def _kill(command: list[str], folder: Path, enough: int, how: signal.Signals) -> int:
    """Start a run, kill it as soon as ``enough`` names are in its folder; its exit status."""
    with subprocess.Popen([sys.executable, "-m", "ssmr_ident", *command], stderr=subprocess.DEVNULL) as process:
        deadline = time.monotonic() + 60
        while process.poll() is None and time.monotonic() < deadline:
            if folder.is_dir() and len(list(folder.iterdir())) >= enough:
                process.send_signal(how)
                break
            time.sleep(0.001)
        return process.wait(timeout=60)


@pytest.mark.slow
@pytest.mark.skipif(os.name == "nt", reason="signals of POSIX")
@pytest.mark.parametrize("enough", [1, 3])
@pytest.mark.parametrize("how", ["SIGKILL", "SIGTERM"])
def test_a_killed_run_leaves_no_half_file(root: Path, tmp_path: Path, enough: int, how: str) -> None:
    folder = tmp_path / "out"
    logs = [str(root / "data" / "raw" / "free_response" / f"roll-{trial}.xlsx") for trial in (1, 2, 3, 4)]
    number = getattr(signal, how)
    status = _kill(["spectrum", *logs, "-o", str(folder), "-q"], folder, enough, number)
    assert status == (143 if how == "SIGTERM" else -number)
    left = [path for path in folder.iterdir() if not path.name.startswith(".")]
    assert len(left) <= 4  # of four figures and a table: it was stopped before its end
    for path in left:
        assert path.read_bytes().endswith(ENDS[path.suffix]), path
    if how == "SIGTERM":
        assert not [path for path in folder.iterdir() if path.name.startswith(".")]


def test_a_run_stopped_as_its_file_is_made_leaves_none(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    opened = Path.open

    def stopped(path: Path, *args: Any, **named: Any) -> None:
        opened(path, *args, **named).close()
        raise KeyboardInterrupt

    monkeypatch.setattr(Path, "open", stopped)
    with pytest.raises(KeyboardInterrupt):
        write_text(tmp_path / "new.txt", "text")
    assert not list(tmp_path.iterdir())


@pytest.mark.skipif(os.name == "nt", reason="signals of POSIX")
def test_an_old_file_stays_until_the_new_one_is_whole(tmp_path: Path) -> None:
    """Killed while it writes over a file again and again, the old or the new text stands there."""
    target = tmp_path / "big.txt"
    code = (
        "import sys; from ssmr_ident.core.atomic import write_text\n"
        "while True:\n"
        "    for letter in 'ab':\n"
        "        write_text(sys.argv[1], letter * 3_000_000)\n"
        "        print('.', flush=True)\n"
    )
    for pause in (0.0, 0.003, 0.011):
        command = [sys.executable, "-c", code, str(target)]
        with subprocess.Popen(command, stdout=subprocess.PIPE) as process:
            assert process.stdout is not None
            process.stdout.readline()
            time.sleep(pause)
            process.kill()
        text = target.read_text()
        assert text in ("a" * 3_000_000, "b" * 3_000_000)


@pytest.mark.slow
def test_a_run_writes_where_it_was_told_and_nowhere_else(root: Path, tmp_path: Path) -> None:
    """From an empty folder, with HOME elsewhere: only what -o names appears."""
    home, here = tmp_path / "home", tmp_path / "here"
    home.mkdir()
    here.mkdir()
    log = root / "data" / "raw" / "free_response" / "roll-1.xlsx"
    for command in (["inspect", str(log)], ["spectrum", str(log), "-o", "out"], ["effects", "dry_friction"]):
        done = subprocess.run(
            [sys.executable, "-m", "ssmr_ident", *command, "-q"],
            cwd=here,
            env={**os.environ, "HOME": str(home), "MPLCONFIGDIR": str(tmp_path / "mpl")},
            capture_output=True,
            text=True,
            check=False,
        )
        assert done.returncode == 0, done.stderr
    assert [path.name for path in here.iterdir()] == ["out"]
    assert not list(home.iterdir())
