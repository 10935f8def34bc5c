"""Compiled loops go on from one process to the next only as long as nothing that they were made of has changed."""

from __future__ import annotations

import errno
from pathlib import Path

import pytest

from ssmr_ident.core.kernel_sources import forget_other_sources

LOOP = "from pkg.physics import law\n\n@kernel\ndef run(): return law.FORCE\n"


@pytest.fixture
def package(tmp_path: Path) -> Path:
    for name, text in {
        "physics/law.py": "FORCE = 1\n",
        "simulate/loop.py": LOOP,
        "cli/screen.py": "WIDTH = 80\n",
    }.items():
        file = tmp_path / "pkg" / name
        file.parent.mkdir(parents=True)
        file.write_text(text)
    return tmp_path / "pkg"


def compiled(package: Path) -> Path:
    index = package / "simulate" / "__pycache__" / "loop.run-3.py311.nbi"
    index.parent.mkdir(exist_ok=True)
    index.write_text("compiled")
    return index


def test_nobody_knows_what_was_compiled_before_anything_was_written_down(package: Path) -> None:
    index = compiled(package)
    assert forget_other_sources(package)
    assert not index.exists()


def test_a_loop_is_forgotten_when_a_file_changes_that_it_takes_numbers_from(package: Path) -> None:
    forget_other_sources(package)
    index = compiled(package)
    assert not forget_other_sources(package)
    assert index.exists()
    (package / "physics" / "law.py").write_text("FORCE = 2.5\n")
    assert forget_other_sources(package)
    assert not index.exists()


def test_a_loop_stays_where_only_files_change_that_it_is_not_made_of(package: Path) -> None:
    forget_other_sources(package)
    index = compiled(package)
    (package / "cli" / "screen.py").write_text("WIDTH = 120\n")
    assert forget_other_sources(package)
    assert index.exists()
    (package / "simulate" / "loop.py").unlink()
    forget_other_sources(package)
    assert not index.exists()


@pytest.mark.parametrize("left", ["", '{"seen": "ab', "[1, 2]", '{"seen": "ab"}', "\x00" * 40])
def test_what_was_written_down_in_part_is_not_known(package: Path, left: str) -> None:
    forget_other_sources(package)
    index = compiled(package)
    (package / "__pycache__" / "compiled_from.json").write_text(left)
    assert forget_other_sources(package)
    assert not index.exists()
    assert not forget_other_sources(package)


def test_a_disk_without_room_costs_the_memory_and_not_the_run(package: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    def full(*_: object, **__: object) -> None:
        raise OSError(errno.ENOSPC, "No space left on device")

    with monkeypatch.context() as patch:
        patch.setattr(Path, "replace", full)
        assert forget_other_sources(package)
    assert [file.name for file in (package / "__pycache__").iterdir()] == []
    index = compiled(package)
    assert forget_other_sources(package)
    assert not index.exists()
