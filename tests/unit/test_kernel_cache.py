"""Compiled loops go on from one process to the next only as long as no source has changed."""

from __future__ import annotations

import os
from pathlib import Path

from ssmr_ident.core.kernel import forget_other_sources


def test_what_another_file_was_compiled_into_is_forgotten_when_that_file_changes(tmp_path: Path) -> None:
    law, index = tmp_path / "physics" / "law.py", tmp_path / "simulate" / "__pycache__" / "loop.nbi"
    for file in (law, index):
        file.parent.mkdir(parents=True)
        file.write_text("x = 1\n")
    (tmp_path / "__pycache__").mkdir()
    assert forget_other_sources(tmp_path)
    assert not index.exists()  # nobody knows what it was made of
    index.write_text("compiled")
    assert not forget_other_sources(tmp_path)
    assert index.exists()
    os.utime(law, ns=(1, 1))
    assert forget_other_sources(tmp_path)
    assert not index.exists()


def test_an_interpreter_that_keeps_no_bytecode_forgets_as_well(tmp_path: Path) -> None:
    """numba makes folders where it keeps loops; of the package's own only an interpreter does."""
    law, index = tmp_path / "law.py", tmp_path / "simulate" / "__pycache__" / "loop.nbi"
    index.parent.mkdir(parents=True)
    law.write_text("x = 1\n")
    assert forget_other_sources(tmp_path)
    index.write_text("compiled")
    os.utime(law, ns=(1, 1))
    assert forget_other_sources(tmp_path)
    assert not index.exists()
