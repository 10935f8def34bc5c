"""The tutorial, typed in from an empty folder: every command ends well and writes what it says."""

from __future__ import annotations

import re
import shlex
import subprocess
import sys
from pathlib import Path

PAGE = Path(__file__).resolve().parents[2] / "docs" / "tutorial" / "first-hour.md"


def test_every_command_of_the_first_hour(tmp_path: Path) -> None:
    blocks = re.findall(r"^```sh\n(.*?)^```", PAGE.read_text(encoding="utf-8"), re.DOTALL | re.MULTILINE)
    lines = [line for block in blocks for line in block.splitlines() if line.strip()]
    assert len(lines) > 8
    for line in lines:
        words = shlex.split(line, comments=True)
        if words[0] == "mkdir":
            (tmp_path / words[1]).mkdir()
            continue
        assert words[0] == "ident", line
        call = [sys.executable, "-m", "ssmr_ident", *words[1:]]
        done = subprocess.run(call, cwd=tmp_path, capture_output=True, text=True, check=False, timeout=300)
        assert done.returncode == 0, f"{line}\n{done.stderr}"
        assert done.stderr == ""
        if "-o" in words:
            assert (tmp_path / words[words.index("-o") + 1]).exists(), line
