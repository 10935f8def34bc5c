"""Pictures of the documentation say by which command they were made, and show what comes out."""

from __future__ import annotations

import json
import re
import shutil
from pathlib import Path

import pytest
from documentation import DOCS, pictures
from typed_command import typed

LINK = re.compile(r"!\[[^\]]*\]\(([^)]+\.png)\)")
PAGES = (DOCS.parent / "README.md", *sorted(DOCS.rglob("*.md")))
SHOWN = sorted({(page.parent / link).resolve() for page in PAGES for link in LINK.findall(page.read_text("utf-8"))})


@pytest.mark.parametrize("path", SHOWN, ids=lambda path: path.stem)
def test_every_picture_names_the_command_that_makes_it(path: Path) -> None:
    program, *words = pictures.kept(path)["Command"].split()
    assert program == "python"
    place = DOCS.parent / words[0] if words[0] != "-m" else DOCS.parent / "studies" / f"{words[1].replace('.', '/')}.py"
    assert place.is_file()


def test_what_is_kept_is_read_and_the_picture_stays(tmp_path: Path) -> None:
    copy = tmp_path / "a.png"
    shutil.copy(DOCS / "images" / "report.png", copy)
    pictures.keep(copy, "python docs/a.py", "µ ± 1")
    pictures.keep(copy, "python docs/b.py", "two\nlines")
    assert pictures.kept(copy).items() >= {"Command": "python docs/b.py", "Shows": "two\nlines"}.items()
    was, now = ({k: d for k, d in pictures._chunks(p) if k != b"iTXt"} for p in (DOCS / "images" / "report.png", copy))
    assert was == now


@pytest.mark.slow
def test_the_terminal_shows_what_ident_new_says(tmp_path: Path) -> None:
    logs = tmp_path / "my-logs"
    logs.mkdir()
    raw = DOCS.parent / "data" / "raw"
    for log in ("free_response/roll-1.xlsx", "free_response/pitch-1.xlsx", "pulls/concrete-lateral-rope-1.txt"):
        shutil.copy(raw / log, logs)
    told = typed("new", "my-logs", "--robot", "p3at-extended", cwd=tmp_path).stdout
    shows = pictures.kept(DOCS / "images" / "terminal-new.png")["Shows"]
    assert "".join(shows.split()) == "".join(told.split())


def test_the_notebook_that_is_shown_is_the_one_that_is_there() -> None:
    cells = json.loads((DOCS.parent / "notebooks" / "01_first_look.ipynb").read_text("utf-8"))["cells"][2:6]
    typed_in = "\n".join("".join(cell["source"]) for cell in cells)
    assert pictures.kept(DOCS / "images" / "notebook.png")["Shows"] == typed_in
