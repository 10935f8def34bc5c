"""What the documentation shows runs, and its links lead somewhere."""

from __future__ import annotations

import json
import re
import struct
import subprocess
import sys
from importlib.util import find_spec
from pathlib import Path
from types import ModuleType

import numpy as np
import pytest
from typer.main import get_command

from ssmr_ident.cli import app
from ssmr_ident.physics.effect import Effect, Site
from ssmr_ident.readers import door, read_one

DOCS = Path(__file__).resolve().parents[2] / "docs"
BLOCK = re.compile(r"^```(\w+)\n(.*?)^```", re.DOTALL | re.MULTILINE)
ELSEWHERE = re.compile(r'(?:src|href)="https?://[^"]+\.(?:js|css|woff2?)"')
PAGES = sorted(DOCS.rglob("*.md"))
TOP = [DOCS.parent / name for name in ("README.md", "CONTRIBUTING.md", "ARCHITECTURE.md", "CHANGELOG.md")]


def _code(page: Path, language: str, holding: str) -> str:
    blocks = [text for kind, text in BLOCK.findall(page.read_text(encoding="utf-8")) if kind == language]
    return next(text for text in blocks if holding in text)


def _module(name: str, text: str) -> ModuleType:
    module = ModuleType(name)
    exec(compile(text, name, "exec"), module.__dict__)
    return module


@pytest.mark.parametrize("page", [*PAGES, *TOP], ids=lambda path: path.stem)
def test_links_and_pictures_are_there(page: Path) -> None:
    for target in re.findall(r"\]\(([^)#\s]+)(?:#[^)]*)?\)", page.read_text(encoding="utf-8")):
        if not target.startswith(("http", "mailto:")):
            assert (page.parent / target).exists(), f"{page.name}: {target}"


def test_the_example_of_a_reader_reads(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    reader = _module("example", _code(DOCS / "howto" / "new-format.md", "python", "recognises"))
    monkeypatch.setattr(door, "FORMATS", (reader, *door.FORMATS))
    pairs = np.column_stack([np.linspace(0, 50, 100), np.linspace(0, 8, 100)])
    log = tmp_path / "log.bin"
    log.write_bytes(b"EXAMPLE1" + struct.pack("<d", 200.0) + pairs.astype("<f4").tobytes())
    recording = read_one(log)
    assert recording.provenance.reader == "example"
    assert recording.sample_rate == pytest.approx(200.0)
    assert recording["force"][-1] == pytest.approx(50.0)
    assert recording["position"][-1] == pytest.approx(0.008)
    log.write_bytes(log.read_bytes()[:-3])
    with pytest.raises(Exception, match="ends within a sample"):
        read_one(log)


def test_the_example_of_an_effect_does_what_it_says() -> None:
    """A first-order high-pass: 1/√2 at its corner, nothing far above, a derivative far below; off changes nothing."""
    effect: Effect = _module("example", _code(DOCS / "howto" / "add-effect.md", "python", "EFFECT")).EFFECT
    change = effect.acts[Site.OUTPUT]
    assert change is not None
    time = np.arange(20000) / 1000.0
    for hertz, gain in ((2.0, 1 / np.sqrt(2)), (50.0, 1.0), (0.2, 0.1 / np.sqrt(1.01))):
        wave = np.sin(2 * np.pi * hertz * time)
        passed = change(time, {"acceleration": wave, "force": wave}, corner_Hz=2.0)
        assert np.ptp(passed["acceleration"][10000:]) / 2 == pytest.approx(gain, rel=0.01)
        assert passed["force"] is wave
        assert np.array_equal(change(time, {"ay": wave}, corner_Hz=0.0)["ay"], wave)
    assert effect.is_off({"corner_Hz": 0.0})


def test_the_dockerfile_copies_what_is_there_and_calls_what_ident_takes() -> None:
    """No daemon is asked: what can go stale in it are the paths, and the call that it ends in."""
    lines = [line.split(maxsplit=1) for line in (DOCS.parent / "Dockerfile").read_text("utf-8").splitlines()]
    words = {key: json.loads(rest) for key, rest in filter(lambda line: line[0] in ("ENTRYPOINT", "CMD"), lines)}
    for source in (name for key, rest in lines if key == "COPY" for name in rest.split()[:-1]):
        assert (DOCS.parent / source).exists(), source
    assert words["ENTRYPOINT"] == ["ident"]
    verb, *options = words["CMD"]
    known = {name for parameter in get_command(app).commands[verb].params for name in parameter.opts}  # type: ignore[attr-defined]
    assert {option for option in options if option.startswith("-")} <= known


@pytest.mark.slow
@pytest.mark.skipif(find_spec("mkdocs") is None, reason="mkdocs is in the extra docs")
def test_the_site_builds_without_a_warning(tmp_path: Path) -> None:
    call = [sys.executable, "-m", "mkdocs", "build", "--strict", "-d", str(tmp_path / "site")]
    done = subprocess.run(call, cwd=DOCS.parent, capture_output=True, text=True, check=False, timeout=120)
    assert done.returncode == 0, done.stderr
    site = tmp_path / "site"
    assert "<math" in (site / "reference" / "effects.html").read_text(encoding="utf-8")
    assert "ident compare" in (site / "reference" / "commands.html").read_text(encoding="utf-8")
    assert "Parameters" in (site / "reference" / "python.html").read_text(encoding="utf-8")
    for page in site.rglob("*.html"):  # nothing is fetched from elsewhere
        assert not re.search(
            r'(?:src|href)="https?://(?!squidfunk)[^"]+\.(?:js|css|woff2?)"', page.read_text("utf-8")
        ), page


def test_tables_of_formats_and_vocabulary_are_those_of_the_code() -> None:
    """python -m ssmr_ident.readers.formats_page docs/howto/formats.md"""
    from ssmr_ident.readers.formats_page import with_tables

    page = (DOCS / "howto" / "formats.md").read_text(encoding="utf-8")
    assert page == with_tables(page)
    assert all(f"`{name}`" in page for name in door.READERS)
    assert "| force | N | force, load" in page
