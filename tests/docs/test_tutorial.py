"""The tutorial, typed in from an empty folder: every command ends well and writes what it says.

The diagnosis of nine decays takes a minute and a half of a core and is tested elsewhere; here its call is parsed, and
what it would have written stands in for it.
"""

from __future__ import annotations

import os
import re
import shlex
import shutil
import subprocess
import sys
from pathlib import Path

import pytest
import typer

from ssmr_ident import cli

pytestmark = pytest.mark.slow

PAGE = Path(__file__).resolve().parents[2] / "docs" / "tutorial" / "first-hour.md"


@pytest.mark.skipif(shutil.which("bash") is None, reason="the tutorial is typed in a shell")
def test_every_command_of_the_first_hour(tmp_path: Path) -> None:
    blocks = re.findall(r"^```sh\n(.*?)^```", PAGE.read_text(encoding="utf-8"), re.DOTALL | re.MULTILINE)
    assert len(blocks) == 7
    environment = {**os.environ, "PYTHON": sys.executable}
    for block in blocks:
        if block.startswith("ident diagnose"):
            _, verb, *arguments = shlex.split(block)
            wanted = typer.main.get_command(cli.app).commands[verb].make_context(verb, arguments).params
            (tmp_path / wanted["output"]).mkdir()
            shutil.copy(tmp_path / "params.yaml", tmp_path / wanted["output"] / "after.yaml")
            continue
        script = f'set -euo pipefail\nident() {{ "$PYTHON" -m ssmr_ident "$@"; }}\n{block}'
        call = ["bash", "-c", script]
        done = subprocess.run(
            call, cwd=tmp_path, env=environment, capture_output=True, text=True, check=False, timeout=600
        )
        assert done.returncode == 0, f"{block}\n{done.stderr}"
        assert done.stderr == ""
    assert {path.name for path in tmp_path.iterdir()} == {"my-logs", "params.yaml", "compare", "diagnosis"}
    assert len(list((tmp_path / "my-logs").glob("*.lvm"))) == 9
    assert (tmp_path / "compare" / "report.html").is_file()
