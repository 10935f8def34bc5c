"""Diagnose blind: another process, a copy of the session folder alone, a fresh temporary directory."""

from __future__ import annotations

import os
import shutil
import subprocess
import sys
import tempfile
import time
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

DIAGNOSE = (sys.executable, "-m", "ssmr_ident", "diagnose", "{session}", "-o", "{out}", "-q")
"""The command; ``{session}`` and ``{out}`` stand for the two folders."""

LONGEST = 3600.0  # s; a diagnosis that hangs, not one on a busy machine


@dataclass(frozen=True)
class BlindRun:
    """What came of one diagnosis.

    Parameters
    ----------
    case : str
    seconds : float
    failure : str
        Empty when it ended with exit status 0.
    """

    case: str
    seconds: float
    failure: str = ""


def run_blind(command: Sequence[str], session: Path, answer: Path) -> BlindRun:
    """Run a command on a copy of a session and keep what it writes.

    Parameters
    ----------
    command : sequence of str
        With ``{session}`` and ``{out}``.
    session : Path
    answer : Path
        Folder for what the command wrote; replaced if it is there.
    """
    with tempfile.TemporaryDirectory(prefix="ident-") as place:
        copy, out = Path(place) / "session", Path(place) / "out"
        shutil.copytree(session, copy)
        filled = [part.format(session=copy, out=out) for part in command]
        begin = time.perf_counter()
        try:
            done = subprocess.run(
                filled, cwd=place, env=_environment(), capture_output=True, text=True, timeout=LONGEST, check=False
            )
            failure = "" if done.returncode == 0 else _last_line(done.stderr) or f"exit status {done.returncode}"
        except subprocess.TimeoutExpired:
            failure = f"not done after {LONGEST:g} s"
        seconds = time.perf_counter() - begin
        shutil.rmtree(answer, ignore_errors=True)
        if out.is_dir():
            shutil.copytree(out, answer)
        else:
            answer.mkdir(parents=True)
    return BlindRun(session.name, seconds, failure)


def _environment() -> dict[str, str]:
    """One thread each: many diagnoses run side by side."""
    return {**os.environ, "OPENBLAS_NUM_THREADS": "1", "NUMBA_NUM_THREADS": "1", "MPLBACKEND": "Agg"}


def _last_line(text: str) -> str:
    lines = [line for line in text.splitlines() if line.strip()]
    return lines[-1].strip() if lines else ""
