"""An option that a message of reading a log advises is one of the command that reads it."""

from __future__ import annotations

import ast
import re
from pathlib import Path

import pytest
import typer.main

from ssmr_ident.cli import app

ROOT = Path(__file__).resolve().parents[2] / "src" / "ssmr_ident"
_OPTION = re.compile(r"(?<![\w-])--[a-z][a-z-]+")


def options_of(verb: str) -> set[str]:
    command = typer.main.get_command(app).commands[verb]  # type: ignore[attr-defined]
    return {name for parameter in command.params for name in (*parameter.opts, *parameter.secondary_opts)}


def advised(folder: Path) -> dict[str, set[str]]:
    """Options named in any text of a module that is not its documentation, by file."""
    found: dict[str, set[str]] = {}
    for file in sorted(folder.rglob("*.py")):
        tree = ast.parse(file.read_text(encoding="utf-8"))
        documentation = {
            id(node.value)
            for node in ast.walk(tree)
            if isinstance(node, ast.Expr) and isinstance(node.value, ast.Constant)
        }
        for node in ast.walk(tree):
            if isinstance(node, ast.Constant) and isinstance(node.value, str) and id(node) not in documentation:
                names = set(_OPTION.findall(node.value)) - {"--install"}
                if names:
                    found.setdefault(str(file.relative_to(folder)), set()).update(names)
    return found


@pytest.mark.slow
def test_advice_of_readers_can_be_followed_on_inspect() -> None:
    named = advised(ROOT / "readers")
    assert len(named) > 8
    assert {"--units", "--columns", "--fs", "--stamps"} <= set().union(*named.values())
    known = options_of("inspect")
    assert {file: names - known for file, names in named.items() if names - known} == {}


def test_no_message_prints_an_empty_name() -> None:
    """A column without a header is called by its number."""
    from ssmr_ident.readers.table.columns import Column

    assert Column("", None, None, number=2).shown == "column 3"  # type: ignore[arg-type]
