"""What a user sees when something is wrong: one line with file, place and mend, exit status 2, nothing written."""

from __future__ import annotations

from pathlib import Path

import pytest
from typed_command import typed

SESSION = """\
schema: ssmr-ident/session/1
name: s
robot: p3at-extended
recordings:
  - {file: log.csv, experiment: free_response, motion: roll}
"""
LOG = "time [s],ax [m/s^2],ay [m/s^2]\n" + "".join(f"{i / 1000},{0.0},{1.0 / (i + 1)}\n" for i in range(600))


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    (tmp_path / "session.yaml").write_text(SESSION)
    (tmp_path / "log.csv").write_text(LOG)
    return tmp_path


def _replace(path: Path, old: str, new: str) -> None:
    text = path.read_text()
    assert old in text
    path.write_text(text.replace(old, new))


@pytest.mark.parametrize(
    ("change", "call", "told"),
    [
        (None, ("inspect", "nothing.lvm"), "nothing.lvm"),
        (None, ("fit", "nowhere", "-o", "p.yaml"), "nowhere"),
        (None, ("compare", ".", "--params", "nothing.yaml"), "nothing.yaml"),
        (None, ("simulate", "p3at-extendd", "-e", "swivel", "-o", "r.csv"), "p3at-extendd"),
        (None, ("simulate", "p3at-extended", "-e", "swivl", "-o", "r.csv"), "Did you mean 'swivel'"),
        (None, ("simulate", "p3at-extended", "-e", "swivel", "-o", "r.mat"), "r.mat"),
        (None, ("demo", "--campaign", "here", "-o", "out"), "here"),
        (None, ("demo", "--campaign", "here", "--thesis"), "--thesis"),
        (("session.yaml", "motion: roll", "motoin: roll"), ("compare", "."), "Did you mean 'motion'"),
        (("session.yaml", "robot: p3at-extended\n", ""), ("compare", "."), "robot: is missing"),
        (("session.yaml", "file: log.csv", "file: other.csv"), ("compare", "."), "other.csv"),
        (("log.csv", "[m/s^2],ay [m/s^2]", "[lbf],ay [lbf]"), ("compare", "."), "log.csv"),
        (("log.csv", "time [s]", "time [lbf]"), ("inspect", "log.csv"), "log.csv"),
    ],
)
def test_one_clear_line_and_status_2(folder: Path, change: tuple | None, call: tuple, told: str) -> None:
    if change:
        _replace(folder / change[0], change[1], change[2])
    before = sorted(path.name for path in folder.iterdir())
    done = typed(*call, cwd=folder)
    assert done.returncode == 2, done.stderr
    assert told in done.stderr
    assert "Traceback" not in done.stderr
    assert len(done.stderr.strip().splitlines()) == 1
    assert sorted(path.name for path in folder.iterdir()) == before


def test_a_missing_parameter_and_a_wrong_unit_are_named(folder: Path) -> None:
    (folder / "robot.yaml").write_text("schema: ssmr-ident/parameters/1\nmass_kg: {value: 30, unit: kg}\n")
    _replace(folder / "session.yaml", "p3at-extended", "robot.yaml")
    done = typed("compare", ".", cwd=folder)
    assert done.returncode == 2
    assert "contact_points_m: is missing" in done.stderr
    (folder / "robot.yaml").write_text("schema: ssmr-ident/parameters/1\nmass_kg: {value: 30, unit: lb}\n")
    done = typed("compare", ".", cwd=folder)
    assert done.returncode == 2
    assert "expected 'kg'" in done.stderr


def test_help_starts_fast_and_lists_every_verb(tmp_path: Path) -> None:
    done = typed("--help", cwd=tmp_path)
    assert done.returncode == 0
    for verb in ("inspect", "spectrum", "fit", "simulate", "compare", "effects", "demo"):
        assert verb in done.stdout


@pytest.mark.slow
def test_a_simulated_log_reads_back_like_a_real_one(tmp_path: Path) -> None:
    made = typed(
        "simulate", "p3at-extended", "-e", "free_response", "--duration-s", "1", "-o", "roll.lvm", cwd=tmp_path
    )
    assert made.returncode == 0, made.stderr
    seen = typed("inspect", "roll.lvm", "--json", cwd=tmp_path)
    assert seen.returncode == 0, seen.stderr
    assert '"lvm"' in seen.stdout


@pytest.mark.slow
def test_an_effect_is_simulated_by_name(tmp_path: Path) -> None:
    logs = {}
    for name, extra in {
        "without": (),
        "nominal": ("--effect", "dry_friction"),
        "given": ("--effect", "dry_friction:F_c_N=2,element_stiffness_N_m=50000"),
    }.items():
        call = ("simulate", "p3at-extended", "-e", "free_response", "--duration-s", "0.2", *extra, "-o", f"{name}.csv")
        done = typed(*call, cwd=tmp_path)
        assert done.returncode == 0, done.stderr
        logs[name] = (tmp_path / f"{name}.csv").read_text()
    assert len(set(logs.values())) == 3
    for wrong, told in (
        ("dry_frictio", "Did you mean 'dry_friction'"),
        ("dry_friction:Fc=2", "F_c_N"),
        ("dry_friction:2", "KEY=VALUE"),
    ):
        done = typed("simulate", "p3at-extended", "-e", "free_response", "--effect", wrong, cwd=tmp_path)
        assert done.returncode == 2
        assert told in done.stderr
