"""Names, places and numbers that nobody should give: one line before any work, and nothing lost."""

from __future__ import annotations

import os
import re
from pathlib import Path

import numpy as np
import pytest
from driven_session import LOG, RIG, SESSION, written
from scipy.io import loadmat
from typed_command import typed

from ssmr_ident.readers import read_one
from ssmr_ident.readers.table.vocabulary import SHIPPED, vocabulary_for
from ssmr_ident.workflows.files_read import files_read

LONG = "x" * 4000


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    return written(tmp_path)


CALLS = {
    "inspect /dev/zero": "is a device or a socket, not a file",
    "spectrum /dev/zero": "is a device or a socket",
    "fit . --effects /dev/zero": "is a device or a socket",
    "export /dev/zero --to mat -o x": "is a device or a socket",
    "inspect log.csv --save /dev/zero": "is a device or a socket",
    "simulate rig.yaml -e forced --force /dev/zero": "is a device or a socket",
    "fit . -o pipe": "is a device or a socket, expected a file",
    "diagnose . -o pipe": "is a file, expected a folder",
    "simulate rig.yaml -e free_response -o pipe": "is a device or a socket, expected a file",
    "inspect log.csv --save log.csv": "is no session",
    "fit . -o session.yaml": "is read by this call and would be lost",
    "fit . -o log.csv": "is read by this call and would be lost",
    "fit . -o rig.yaml": "is read by this call and would be lost",
    "export log.csv --to mat -o log.csv": "is read by this call and would be lost",
    "simulate rig.yaml -e forced --force log.csv -o log.csv": "is read by this call and would be lost",
    "simulate rig.yaml -e free_response -o x.exe": "no writer for .exe",
    "export rig.yaml --to csv -o .": "is a folder, expected a file",
    f"inspect {LONG}": "File name too long",
    f"fit {LONG}": "File name too long",
    f"fit . -o {LONG}": "File name too long",
    f"new {LONG}": "File name too long",
    f"inspect log.csv --columns time={'9' * 5000}": "has no column '999",
    "inspect log.csv --columns time=²": "has no column '²'",
    "inspect log.csv --columns time=--5": "has no column '--5'",
    "inspect log.csv --fs 0": "--fs: is 0.0, expected a finite number",
    "inspect log.csv --fs 1e300": "--fs: is 1e+300, expected",
    "inspect log.csv --load-scale nan": "--load-scale: is nan, expected",
    "inspect log.csv --sample 0": "--sample: is 0, expected a whole number",
    "inspect log.csv --skip -3": "--skip: is '-3', expected a whole number",
    "batch . -o out --params nowhere.yaml": "nowhere.yaml: no such file",
    "batch . -o .": "holds the sessions themselves. Give another name with -o",
    "batch log.csv -o out": "log.csv: is no folder",
    "batch . -o log.csv": "log.csv: is a file, expected a folder",
    "batch . -o out --jobs -1": "Invalid value for '--jobs'",
    "batch . -o out --timeout nan": "Invalid value for '--timeout'",
    "diagnose . -o out --budget -1": "Invalid value for '--budget'",
    "diagnose . -o out --budget nan": "Invalid value for '--budget'",
    "diagnose . -o out --params log.csv": "log.csv: holds a str, expected a mapping",
    "diagnose . -o rig.yaml": "rig.yaml: is a file, expected a folder",
    "diagnose logs -o out": "logs: has no session.yaml",
    "new logs --mass-kg 1e308": "--mass-kg: is 1e+308, expected",
    "new logs --inertia-kg-m2 0": "--inertia-kg-m2: is 0.0, expected",
    "new logs --fs nan": "--fs: is nan, expected",
}


@pytest.mark.skipif(not hasattr(os, "mkfifo"), reason="no pipes with names here")
@pytest.mark.parametrize("call", CALLS, ids=lambda call: call[:50])
def test_one_line_and_nothing_lost(folder: Path, call: str) -> None:
    (folder / "logs").mkdir()
    os.mkfifo(folder / "pipe")
    done = typed(*call.split(), cwd=folder)
    assert done.returncode == 2, done.stderr
    assert CALLS[call] in done.stderr
    assert len(done.stderr.splitlines()) == 1
    assert len(done.stderr) < 1000
    left = {path.name: path.read_text(encoding="utf-8") for path in folder.iterdir() if path.is_file()}
    assert left == {"session.yaml": SESSION, "rig.yaml": RIG, "log.csv": LOG}


def test_stamps_that_no_clock_gives_and_names_that_matlab_has_not(folder: Path) -> None:
    rows = [f"{k}e-320,{k}" for k in range(50)]
    (folder / "tiny.csv").write_text("time [s],F [N]\n" + "\n".join(rows) + "\n", encoding="utf-8")
    for call in (["inspect", "tiny.csv"], ["spectrum", "tiny.csv", "-o", "out"]):
        done = typed(*call, cwd=folder)
        assert done.returncode == 2
        assert "s apart, which no clock tells" in done.stderr
        assert len(done.stderr.splitlines()) == 1
    names = ("💪", "a-b", "a_b", "x" * 70)
    rows = [f"{k / 100}," + ",".join(str(k % (3 + n)) for n in range(len(names))) for k in range(50)]
    head = "time [s]," + ",".join(f"{name} [N]" for name in names)
    (folder / "odd.csv").write_text("\n".join([head, *rows]) + "\n", encoding="utf-8")
    log = read_one(folder / "odd.csv")
    done = typed("export", "odd.csv", "--to", "mat", "-o", "odd.mat", cwd=folder)
    assert done.returncode == 0, done.stderr
    found = loadmat(folder / "odd.mat", simplify_cells=True)
    for channel in log.channels:
        name = next((new for new, old in found["names"].items() if old == channel.name), channel.name)
        assert re.fullmatch("[A-Za-z][A-Za-z0-9_]{0,62}", name)
        np.testing.assert_array_equal(found[name], channel.samples)


VOCABULARIES = {
    "units: 5": "units: is 5, expected a mapping",
    "units: {a: {b: c}}": "units.a.b: is not a known key",
    "units: {a: {unit: m, factor: 0}}": "units.a.factor: is 0, expected",
    "quantities: {force: 5}": "quantities.force: is 5, expected a mapping",
    "quantities: {banana: {words: {en: [pinch]}}}": "quantity 'banana' is not known",
    "conventions: [{name: x}]": "conventions[0].unit: is missing",
    "symbols: {force: {a: 1}}": "symbols.force: is {'a': 1}, expected a list",
    "modifiers: 7": "modifiers: is 7, expected a list",
    "- 1": "is [1], expected a mapping",
    "a: 2012-02-30": "is no vocabulary (day is out of range",
    "[" * 3000: "is no vocabulary (maximum recursion",
}


@pytest.mark.parametrize("text", VOCABULARIES, ids=lambda text: text[:30])
def test_a_vocabulary_beside_a_log_is_asked_what_it_may_be(folder: Path, text: str) -> None:
    (folder / "vocabulary.yaml").write_text(text, encoding="utf-8")
    done = typed("inspect", "log.csv", cwd=folder)
    assert done.returncode == 2, done.stderr
    assert VOCABULARIES[text] in done.stderr
    assert len(done.stderr.splitlines()) == 1


def test_a_vocabulary_adds_words_and_units(folder: Path) -> None:
    (folder / "vocabulary.yaml").write_text(
        "quantities: {force: {words: {en: [pinch]}}}\nunits: {stonef: {unit: N, factor: 62.275}}\n", encoding="utf-8"
    )
    (folder / "log.csv").write_text(LOG.replace("F [N]", "pinch [stonef]"), encoding="utf-8")
    force = read_one(folder / "log.csv")["force"]
    assert force[0] == pytest.approx(-3.0 * 62.275)
    assert vocabulary_for(SHIPPED.parent.parent).phrases  # the shipped words pass the same questions


@pytest.mark.skipif(not hasattr(os, "mkfifo"), reason="no pipes with names here")
def test_folders_with_devices_and_pipes_in_them(folder: Path) -> None:
    os.mkfifo(folder / "pipe.csv")
    (folder / "endless.csv").symlink_to("/dev/zero")
    done = typed("inspect", ".", cwd=folder)
    assert done.returncode == 0, done.stderr
    assert "log.csv" in done.stdout
    assert "pipe" not in done.stdout + done.stderr


def test_an_answer_rests_on_the_parameters_wherever_the_session_is_named_from(
    folder: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(folder.parent)
    names = [Path(folder.name) / name for name in ("session.yaml", "rig.yaml", "log.csv")]
    assert files_read(folder.name) == names
    assert files_read(folder) == [folder / name.name for name in names]
