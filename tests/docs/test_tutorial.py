"""The tutorial, typed in from an empty folder, and the demo: what their pages show is what comes out."""

from __future__ import annotations

import os
import re
import shutil
import subprocess
import sys
from pathlib import Path

import pytest
from documentation import pictures
from typed_command import typed

from ssmr_ident.workflows.demo.hidden import RELEASED_MM

pytestmark = pytest.mark.slow

PAGE = Path(__file__).resolve().parents[2] / "docs" / "tutorial" / "first-hour.md"
BLOCK = re.compile(r"^```(sh|text|python)\n(.*?)^```", re.DOTALL | re.MULTILINE)
NUMBER = re.compile(r"(?<![\w.])[-+]?\d+\.?\d*(?:e[-+]?\d+)?")
DIGEST = re.compile(r"SHA-256 \w+…")
TOLERANCE = 0.1
"""Of a number that another processor's arithmetic ends on, relative; near nought a thousandth of a unit."""


def told(text: str) -> list[tuple[str, list[float]]]:
    """Lines as their words and their numbers; in which columns they stand does not matter."""
    lines = [DIGEST.sub("SHA-256", line) for line in text.splitlines() if line.strip()]
    return [(" ".join(NUMBER.sub("#", line).split()), [float(n) for n in NUMBER.findall(line)]) for line in lines]


def shown_in(wanted: str, printed: str) -> None:
    """Every line of a block is printed, in its order, with the same words and nearly the same numbers."""
    lines = iter(told(printed))
    for words, numbers in told(wanted):
        found = next((n for w, n in lines if w == words), None)
        assert found is not None, f"not printed (any more, or not here): {words}"
        assert found == pytest.approx(numbers, rel=TOLERANCE, abs=1e-3), words


def test_a_block_that_differs_is_seen() -> None:
    shown_in("a = 1.00 ± 0.01 N\nend", "before\n  a = 1.02 ± 0.01 N\nmore\nend\n")
    with pytest.raises(AssertionError, match="not printed"):
        shown_in("a = 1.0 N\nend", "end\na = 1.0 N")
    with pytest.raises(AssertionError):
        shown_in("a = 1.0 N", "a = 1.3 N")


def test_the_demo_prints_what_the_readme_shows_and_begins_anew_the_second_time(tmp_path: Path) -> None:
    blocks = BLOCK.findall((PAGE.parents[2] / "README.md").read_text(encoding="utf-8"))
    (wanted,) = (block for kind, block in blocks if kind == "text")
    told = typed("demo", cwd=tmp_path)
    assert told.returncode == 0, told.stderr
    shown_in(wanted.replace("█", ""), told.stdout.replace("█", ""))
    assert "ident new FOLDER" in told.stdout
    page = (tmp_path / "out" / "demo-diagnosis" / "report.html").read_text(encoding="utf-8")
    shown_in(pictures.kept(PAGE.parents[1] / "images" / "report.png")["Shows"], pictures.first_screen(page))
    again = typed("demo", "--seed", "2", "--hide", "quadratic_damping:d2_N_s2_m2=40", cwd=tmp_path)
    assert "found   quadratic_damping" in again.stdout
    assert len(list((tmp_path / "out" / "demo-rig").glob("*.csv"))) == len(RELEASED_MM)
    assert (tmp_path / "out" / "demo-diagnosis" / "report.html").is_file()


@pytest.mark.skipif(shutil.which("bash") is None, reason="the tutorial is typed in a shell")
def test_every_command_of_the_first_hour_prints_what_the_page_shows(tmp_path: Path) -> None:
    blocks = BLOCK.findall(PAGE.read_text(encoding="utf-8"))
    assert [kind for kind, _ in blocks].count("text") == 7
    environment = {**os.environ, "PYTHON": sys.executable}
    shell = 'set -euo pipefail\npython() { "$PYTHON" "$@"; }\nident() { "$PYTHON" -m ssmr_ident "$@"; }\n'
    printed = ""
    for kind, block in blocks:
        if kind == "python":
            (tmp_path / "make_logs.py").write_text(block, encoding="utf-8")
        elif kind == "sh":
            done = subprocess.run(
                ["bash", "-c", shell + block], cwd=tmp_path, env=environment, capture_output=True, text=True,
                check=False, timeout=600,
            )  # fmt: skip
            assert done.returncode == 0, f"{block}\n{done.stderr}"
            assert done.stderr == ""
            printed = done.stdout
        else:
            shown_in(block, printed)
    assert (tmp_path / "diagnosis" / "report.html").is_file()
    assert (tmp_path / "compare" / "report.html").is_file()
