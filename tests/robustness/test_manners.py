"""Manners of the command line: examples that parse, near names, completion, colour and progress only for people."""

from __future__ import annotations

import importlib
import os
import re
import shlex
import subprocess
import sys
from pathlib import Path

import pytest
import typer
from typed_command import typed

from ssmr_ident import cli

GROUP = typer.main.get_command(cli.app)
MY_LAW = """
from dataclasses import replace
from ssmr_ident.physics.effects.sensor_saturation import EFFECT as KNOWN
EFFECT = replace(KNOWN, id="my_law")
"""


def _ident(*arguments: str, **environment: str) -> subprocess.CompletedProcess[str]:
    call = [sys.executable, "-m", "ssmr_ident", *arguments]
    kept = {key: value for key, value in os.environ.items() if key not in ("NO_COLOR", "FORCE_COLOR")}
    return subprocess.run(call, capture_output=True, text=True, env={**kept, **environment}, timeout=120, check=False)


def _on_a_terminal(*arguments: str, **environment: str) -> str:
    """All that a terminal of 100 columns would get."""
    pty = pytest.importorskip("pty", reason="no pseudo-terminals here")
    master, slave = pty.openpty()
    kept = {key: value for key, value in os.environ.items() if key not in ("NO_COLOR", "FORCE_COLOR")}
    kept |= {"TERM": "xterm-256color", "COLUMNS": "100"}
    with subprocess.Popen(
        [sys.executable, "-m", "ssmr_ident", *arguments],
        stdout=slave,
        stderr=slave,
        stdin=slave,
        env={**kept, **environment},
    ) as process:
        os.close(slave)
        seen = b""
        while True:
            try:
                piece = os.read(master, 65536)
            except OSError:  # the other end is closed
                break
            if not piece:
                break
            seen += piece
        process.wait(timeout=60)
    os.close(master)
    return seen.decode()


@pytest.mark.parametrize("verb", cli.VERBS)
def test_every_verb_has_examples_that_parse(verb: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    (tmp_path / "my_law.py").write_text(MY_LAW)
    monkeypatch.chdir(tmp_path)
    examples = importlib.import_module(f"ssmr_ident.cli.{verb}").EXAMPLES
    assert examples
    for example in examples:
        program, name, *arguments = shlex.split(example)
        assert (program, name) == ("ident", verb)
        with GROUP.commands[verb].make_context(verb, arguments):
            pass
    shown = typed(verb, "--help").stdout
    assert "Examples:" in shown
    assert all(word in shown for word in shlex.split(examples[0]))


@pytest.mark.parametrize(
    ("call", "told"),
    [
        (["comprae", "x"], "Did you mean 'compare'?"),
        (["fit", "x", "--sed", "1"], "Did you mean --seed?"),
        (["effects", "stribek"], "Did you mean 'stribeck'?"),
        (["simulate", "p3at-extended", "-e", "swivl"], "Did you mean 'swivel'?"),
        (["simulate", "p3at-extended", "-e", "pull", "--direction", "latral"], "Did you mean 'lateral'?"),
        (["simulate", "p3at-extended", "-e", "free_response", "--motion", "rol"], "Did you mean 'roll'?"),
        (["simulate", "p3at-extended", "-e", "pull", "--cable", "stel"], "Did you mean 'steel'?"),
        (["fit", "x", "--method", "modul"], "Did you mean 'modal'?"),
        (["inspect", "x.csv", "--reader", "lvn"], "x.csv"),
        (["fit"], "ident fit --help"),
        (["spectrum", "x", "--format", "gif"], "--format"),
    ],
)
def test_a_wrong_call_gets_one_line_and_the_nearest_name(call: list[str], told: str) -> None:
    done = typed(*call)
    assert done.returncode == 2
    assert told in done.stderr
    assert done.stderr.startswith("ident: ")
    assert len(done.stderr.splitlines()) == 1
    assert not done.stdout


@pytest.mark.parametrize(
    ("line", "offered"),
    [
        ("ident comp", "compare"),
        ("ident effects dry", "dry_friction"),
        ("ident simulate p3", "p3at-platform"),
        ("ident simulate p3at-platform -e sw", "swivel"),
        ("ident new logs --robot p3at-e", "p3at-extended"),
    ],
)
def test_the_tab_key(line: str, offered: str) -> None:
    words = line.split()
    done = typed(_IDENT_COMPLETE="complete_bash", COMP_WORDS=line, COMP_CWORD=str(len(words) - 1))
    assert offered in done.stdout.split()


@pytest.mark.slow
def test_completion_scripts_are_shown_without_being_installed() -> None:
    for shell in ("bash", "zsh", "fish"):
        done = typed(_IDENT_COMPLETE=f"source_{shell}")
        assert "_IDENT_COMPLETE" in done.stdout


@pytest.mark.slow
def test_colour_for_people_who_want_it() -> None:
    colour = re.compile(r"\x1b\[[0-9;]*3[0-9]")
    assert colour.search(_on_a_terminal("--help"))
    assert not colour.search(_on_a_terminal("--help", NO_COLOR="1"))
    assert "\x1b" not in _ident("--help").stdout


@pytest.mark.slow
def test_progress_on_a_terminal_and_silence_in_a_pipe(root: Path, tmp_path: Path) -> None:
    log = root / "data" / "raw" / "pulls" / "carpet-lateral-steel-3.txt"
    (tmp_path / log.name).write_bytes(log.read_bytes())
    (tmp_path / "session.yaml").write_text(
        "schema: ssmr-ident/session/1\nname: pull\nrobot: p3at-extended\nrecordings:\n"
        f"  - {{file: {log.name}, experiment: pull, direction: lateral, speed_mm_s: 2.0, height_m: 0.05}}\n"
    )
    call = ("fit", str(tmp_path), "-o", str(tmp_path / "p.yaml"))
    shown = _on_a_terminal(*call)
    assert "reading logs" in shown
    assert "all recordings together" in shown
    piped = _ident(*call)
    assert piped.stderr == ""
    assert "\x1b" not in piped.stdout
    assert "reading logs" not in _on_a_terminal(*call, "-q")
