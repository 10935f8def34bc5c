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


def test_a_package_that_keeps_nothing_is_left_alone(tmp_path: Path) -> None:
    (tmp_path / "law.py").write_text("x = 1\n")
    assert not forget_other_sources(tmp_path)
    assert list(tmp_path.iterdir()) == [tmp_path / "law.py"]
