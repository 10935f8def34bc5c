"""session.yaml and parameter files: what is read, what is refused, and that nothing is lost on the way out."""

from __future__ import annotations

import math
from pathlib import Path

import numpy as np
import pytest

from ssmr_ident.core.errors import InputError
from ssmr_ident.core.parameter import Estimate, ParameterSet
from ssmr_ident.session import bundled_robots, read_parameters, read_session, write_parameters

SESSION = """\
schema: ssmr-ident/session/1
name: test
robot: p3at-extended
recordings:
  - {file: a.csv, experiment: free_response, motion: roll, trial: 1}
"""


def _session(folder: Path, text: str) -> Path:
    (folder / "session.yaml").write_text(text, encoding="utf-8")
    (folder / "a.csv").write_text("time [s],ax [m/s^2]\n0,0\n", encoding="utf-8")
    return folder


def test_session_defaults(tmp_path: Path) -> None:
    session = read_session(_session(tmp_path, SESSION))
    entry = session.entries[0]
    assert (session.baseline, entry.role, entry.motion) == ("rigid6", "target", "roll")
    assert session.paths(entry) == (tmp_path / "a.csv",)


@pytest.mark.parametrize(
    ("old", "new", "place", "hint"),
    [
        ("motion: roll", "motion: rol", "recordings[0].motion", "Did you mean 'roll'"),
        ("motion: roll", "moton: roll", "session.yaml:5: recordings[0].moton", "Did you mean 'motion'"),
        ("experiment: free_response, ", "", "recordings[0].experiment", "missing"),
        ("free_response", "free_responce", "recordings[0].experiment", "Did you mean 'free_response'"),
        ("file: a.csv", "file: ../a.csv", "recordings[0].file", "leaves the session folder"),
        ("file: a.csv", "file: b.csv", "recordings[0].file", "is not in"),
        ("trial: 1", "trial: one", "recordings[0].trial", "whole number"),
        ("trial: 1", "wheels_gripping: [5]", "recordings[0].wheels_gripping[0]", "Known: 1, 2, 3, 4"),
        ("trial: 1", "speed_mm_s: -1", "recordings[0].speed_mm_s", "is -1, expected a finite number ≥ 1e-09"),
        ("trial: 1", "cable: string", "recordings[0].cable", "steel"),
        ("robot: p3at-extended\n", "", "robot", "missing"),
        ("robot: p3at-extended", "robot: /etc/passwd", "robot", "leaves the session folder"),
        ("session/1", "session/2", "schema", "expected"),
        ("name: test", "name: test\nname: again", "session.yaml:3", "stands twice"),
        ("name: test", "name: [", "session.yaml:", "not valid YAML"),
        ("name: test", "name: &a x\nbaseline: *a", "session.yaml:3", "aliases"),
        ("name: test", "name: " + "[" * 50, "session.yaml:2", "deeper"),
        ("name: test", "baseline: rigid7", "baseline", "Did you mean 'rigid6'"),
    ],
)
def test_a_wrong_session_names_place_and_mend(tmp_path: Path, old: str, new: str, place: str, hint: str) -> None:
    assert old in SESSION
    with pytest.raises(InputError) as caught:
        read_session(_session(tmp_path, SESSION.replace(old, new)))
    assert place in caught.value.where
    assert hint in str(caught.value)


ROBOT = "schema: ssmr-ident/parameters/1\nname: r\nmass_kg: {value: 30, std: 1, unit: kg}\n"


@pytest.mark.parametrize(
    ("text", "place", "hint"),
    [
        (ROBOT.replace("mass_kg", "mas_kg"), "mas_kg", "Did you mean 'mass_kg'"),
        (ROBOT.replace("unit: kg", "unit: lb"), "mass_kg", "expected 'kg'"),
        (ROBOT.replace("30", "heavy"), "p.yaml:3: mass_kg.value", "expected a finite number"),
        (ROBOT.replace("30", "true"), "p.yaml:3: mass_kg.value", "expected a finite number"),
        (ROBOT.replace("30", "-30"), "mass_kg", "is -30, expected a finite number ≥ 1e-15"),
        (ROBOT.replace("30", ".nan"), "mass_kg", "is nan, expected a finite number"),
        (ROBOT.replace("std", "sdt"), "mass_kg", "Did you mean 'std'"),
        (ROBOT + "tire: {stiffness_y_N_m: {unit: N/m}}\n", "tire.stiffness_y_N_m", "has no value"),
        (ROBOT + "contact_points_m: [[1, 2, 3]]\n", "contact_points_m", "expected a list of 4"),
        (ROBOT.replace("parameters/1", "session/1"), "p.yaml:1: schema", "expected ssmr-ident/parameters/1"),
    ],
)
def test_wrong_parameters_name_key_and_mend(tmp_path: Path, text: str, place: str, hint: str) -> None:
    (tmp_path / "p.yaml").write_text(text, encoding="utf-8")
    with pytest.raises(InputError) as caught:
        read_parameters(tmp_path / "p.yaml")
    assert place in caught.value.where
    assert hint in str(caught.value)


def test_numbers_without_a_point_are_numbers(tmp_path: Path) -> None:
    (tmp_path / "p.yaml").write_text(ROBOT.replace("30", "3e1").replace("std: 1", "std: .inf"), encoding="utf-8")
    estimate = read_parameters(tmp_path / "p.yaml")["mass_kg"]
    assert (estimate.value, estimate.std) == (30.0, None)


def _same(a: ParameterSet, b: ParameterSet) -> None:
    assert list(a) == list(b)
    for key in a:
        assert np.array_equal(a[key].value, b[key].value)
        assert (a[key].std, a[key].unit, a[key].source, a[key].fixed) == (
            b[key].std,
            b[key].unit,
            b[key].source,
            b[key].fixed,
        )
    assert a.effects == b.effects
    assert a.provenance == b.provenance


@pytest.mark.parametrize("name", bundled_robots())
def test_bundled_robots_survive_a_round_trip(tmp_path: Path, name: str) -> None:
    robot = read_parameters(name)
    write_parameters(tmp_path / "out.yaml", robot)
    _same(robot, read_parameters(tmp_path / "out.yaml"))


def test_awkward_numbers_and_texts_survive_bit_for_bit(tmp_path: Path) -> None:
    random = np.random.default_rng(5)
    numbers = np.concatenate([random.standard_normal(20) * 10.0 ** random.integers(-13, 8, 20), [0.1 + 0.2]])
    for number in np.abs(numbers):
        original = ParameterSet(
            "näme: with # signs",
            {
                "mass_kg": Estimate(float(number), float(number) / 3, "kg", 'he said "5: #6"\n', True),
                "damping_N_s_m": Estimate(5e-324, float(number) * 1e290, "N s/m"),
            },
            {"nonlinear_stiffness": {"k3_N_m3": Estimate(float(-number), None, "N/m^3")}},
            {"files": {"a.xlsx": "00ff"}, "seed": 3},
        )
        write_parameters(tmp_path / "p.yaml", original)
        _same(original, read_parameters(tmp_path / "p.yaml"))
    cable = ParameterSet("stiff", {"cable.stiffness_N_m": Estimate(math.inf, None, "N/m")})
    write_parameters(tmp_path / "p.yaml", cable)
    assert read_parameters(tmp_path / "p.yaml").number("cable.stiffness_N_m") == math.inf


def test_exported_file_explains_its_keys(tmp_path: Path) -> None:
    write_parameters(tmp_path / "p.yaml", read_parameters("p3at-extended"))
    text = (tmp_path / "p.yaml").read_text(encoding="utf-8")
    assert "# per wheel, lateral" in text


@pytest.mark.slow
def test_every_shared_session_reads(shared: Path) -> None:
    folders = sorted({path.parent for path in shared.glob("*/**/session.yaml")})
    assert len(folders) > 40
    for folder in folders:
        read_parameters(read_session(folder).robot)
