"""Names of sessions and logs that are markup, quotes, turned letters or 4,000 letters long: text on every page."""

from __future__ import annotations

import re
from html import unescape
from pathlib import Path

import numpy as np
import pytest
import yaml
from driven_session import PLAIN
from typed_command import typed

pytestmark = pytest.mark.slow

NAME = "</script><img src=x onerror=alert(1)>\"'&\u202egpj " + "y" * 4000
LOG = "<img src=x onerror=alert(2)>\"'\u202egpj.csv"


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    session = tmp_path / "session"
    session.mkdir()
    time = np.arange(1200) / 400
    force = 10 * np.sin(60 * time**2)
    rows = np.column_stack([time, force, np.gradient(force, 0.01)])
    np.savetxt(session / LOG, rows, "%.6g", ",", header="time [s],F [N],a [m/s^2]", comments="")
    (session / "rig.yaml").write_text(PLAIN, encoding="utf-8")
    entry = {"file": LOG, "experiment": "forced", "channels": {"force": "F", "acceleration": "a"}}
    content = {
        "schema": "ssmr-ident/session/1", "name": NAME, "robot": "rig.yaml", "baseline": "sdof", "recordings": [entry],
    }  # fmt: skip
    (session / "session.yaml").write_text(yaml.safe_dump(content, allow_unicode=True), encoding="utf-8")
    return tmp_path


CALLS = ("fit session --figures out", "compare session -o out", "spectrum session -o out", "batch . -o out --jobs 1")


@pytest.mark.parametrize("call", CALLS)
def test_names_are_text(folder: Path, call: str) -> None:
    done = typed(*call.split(), *(["--no-diagnose"] if call.startswith("batch") else []), cwd=folder)
    assert done.returncode == 0, done.stderr
    page = (folder / "out" / "report.html").read_text(encoding="utf-8")
    assert "<img" not in page
    assert "\u202e" not in page
    assert page.count("<script") == page.count("</script>")
    assert not re.search(r"(?:src|href)=.?(?:https?:)?//", page)
    if not call.startswith("batch"):  # which names folders
        assert LOG.replace("\u202e", "⟨U+202E⟩") in unescape(page)
