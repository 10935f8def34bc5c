"""Imports run one way between files too: a file that is read needs no other one that needs it."""

from __future__ import annotations

import sys
from graphlib import CycleError, TopologicalSorter
from pathlib import Path

import grimp
import pytest

PACKAGES = ("ssmr_ident", "ssmr_proof", "thesis2012")


def _circle(*packages: str) -> list[str]:
    """Modules of one circle of imports, those within functions counted; none where there is none."""
    graph = grimp.build_graph(*packages, cache_dir=None)
    needs = {module: graph.find_modules_directly_imported_by(module) for module in graph.modules}
    try:
        TopologicalSorter(needs).prepare()
    except CycleError as error:
        return [str(module) for module in error.args[1]]
    return []


def test_no_file_imports_itself_by_way_of_others() -> None:
    assert _circle(*PACKAGES) == []


def test_a_circle_within_functions_is_seen(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    package = tmp_path / "turning_round"
    package.mkdir()
    (package / "__init__.py").write_text("")
    (package / "one.py").write_text("from turning_round import two\n")
    (package / "two.py").write_text("def late():\n    from turning_round import one\n    return one\n")
    monkeypatch.setattr(sys, "path", [str(tmp_path), *sys.path])
    assert set(_circle("turning_round")) == {"turning_round.one", "turning_round.two"}
