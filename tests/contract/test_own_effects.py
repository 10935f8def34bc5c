"""A law of one's own: of a file on a call, of an installed package's entry point, and never by a session's word."""

from __future__ import annotations

import json
import re
import shlex
from collections.abc import Callable
from importlib.metadata import EntryPoint
from pathlib import Path

import jsonschema
import numpy as np
import pytest
import yaml
from typer.testing import CliRunner

from ssmr_ident import cli
from ssmr_ident.core.errors import InputError
from ssmr_ident.core.parameter import Parameter
from ssmr_ident.physics import own_effect
from ssmr_ident.physics.effect import Effect, Site
from ssmr_ident.physics.effects import CATALOGUE, effects_of
from ssmr_ident.physics.rig import Rig
from ssmr_ident.session import read_parameters
from ssmr_ident.simulate.rig import simulate_rig
from ssmr_ident.workflows.batch.task import Task
from ssmr_ident.workflows.effects import promises

RUN = CliRunner()
HOWTO = Path(__file__).resolve().parents[2] / "docs" / "howto" / "add-effect.md"
BLOCKS = re.findall(r"^```(\w+)\n(.*?)^```", HOWTO.read_text(encoding="utf-8"), re.DOTALL | re.MULTILINE)
LAW, RIG, SHAKER, SESSION = (
    next(text for _, text in BLOCKS if mark in text)
    for mark in ("EFFECT = Effect(", "schema: ssmr-ident/parameters", "np.savetxt", "schema: ssmr-ident/session")
)
CALLS = [line for kind, text in BLOCKS if kind == "sh" for line in text.splitlines()]
ID = "charge_amplifier"
FORCE = 10.0 * np.sin(np.arange(100) / 5.0)


@pytest.fixture
def law(tmp_path: Path) -> Path:
    file = tmp_path / f"{ID}.py"
    file.write_text(LAW, encoding="utf-8")
    return file


def _motion(**values: float) -> np.ndarray:
    return simulate_rig(Rig(8.0, 50.0, 20000.0), FORCE, 250.0, effects={ID: values})


def test_a_file_is_in_the_catalogue_for_the_length_of_a_with(law: Path) -> None:
    before = list(CATALOGUE)
    with effects_of(law) as (effect,):
        assert list(CATALOGUE) == [*before, ID]
        assert CATALOGUE[ID] is effect
        on, off = _motion(corner_Hz=3.0), _motion(corner_Hz=0.0)
        assert np.array_equal(off, simulate_rig(Rig(8.0, 50.0, 20000.0), FORCE, 250.0))
        assert np.array_equal(on[:, :2], off[:, :2])
        assert np.abs(on - off)[:, 2].max() > 0.1
    assert list(CATALOGUE) == before


@pytest.mark.parametrize(
    ("was", "now", "said"),
    [
        (LAW, "import os\n", "law.py: has no EFFECT"),
        (LAW, "EFFECT = 3\n", "law.py: EFFECT is a int, expected an Effect"),
        (LAW, "\n\n1 / 0\n", "law.py:3: raises ZeroDivisionError: division by zero"),
        (LAW, "def (\n", "law.py:1: raises SyntaxError: invalid syntax"),
        (LAW, "raise SystemExit(3)\n", "law.py:1: raises SystemExit: 3"),
        (LAW, "EFFECT = Effect()", "law.py:1: raises NameError"),
        (f'id="{ID}"', 'id="dry_friction"', "the id dry_friction is taken"),
        (f'id="{ID}"', 'id="Charge amplifier"', "the id is 'Charge amplifier', expected small letters"),
        ("acts={Site.OUTPUT: change}", "acts={Site.ELEMENT: change}", "acts at ELEMENT, which is compiled"),
        ("acts={Site.OUTPUT: change}", "acts={}", "acts names no law"),
        ("acts={Site.OUTPUT: change}", "acts={Site.ROBOT: change}", "rig=True without a law at OUTPUT"),
    ],
)
def test_a_file_that_cannot_be_taken_is_told_in_one_line(was: str, now: str, said: str, tmp_path: Path) -> None:
    assert was in LAW
    file = tmp_path / "law.py"
    file.write_text(LAW.replace(was, now), encoding="utf-8")
    before = list(CATALOGUE)
    with pytest.raises(InputError, match=re.escape(said)) as error, effects_of(file):
        pass
    assert "\n" not in str(error.value)
    assert list(CATALOGUE) == before


def test_a_file_that_is_not_there_is_told() -> None:
    with pytest.raises(InputError, match="cannot be read: No such file"), effects_of("nowhere.py"):
        pass


@pytest.mark.parametrize(
    ("law", "said"),
    [
        (lambda time, channels, corner_Hz: 1.0 / 0.0, "law raises ZeroDivisionError"),
        (lambda time, channels, corner_Hz: None, "law gives NoneType, expected position, velocity, acceleration"),
        (lambda time, channels, corner_Hz: {"position": time}, "law gives position, expected position, velocity"),
        (lambda time, channels, corner_Hz: {n: s[1:] for n, s in channels.items()}, r"of the shape \(99,\), expected"),
    ],
)
def test_a_law_that_goes_wrong_while_it_is_simulated_is_told(
    law: Callable[..., object], said: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    parameters = (Parameter("corner_Hz", "Hz", 1.0, 0.0, 50.0, off=0.0),)
    effect = Effect(ID, "", "", "", "", parameters, ("forced",), {Site.OUTPUT: law}, rig=True)
    monkeypatch.setitem(CATALOGUE, ID, own_effect.accepted(effect, "law.py", ()))
    with pytest.raises(InputError, match=said):
        _motion(corner_Hz=3.0)


def test_entry_points_join_the_catalogue_and_a_broken_one_is_named(law: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.syspath_prepend(law.parent)
    points = [EntryPoint("mine", f"{ID}:EFFECT", own_effect.GROUP)]
    monkeypatch.setattr(own_effect, "entry_points", lambda group: points if group == own_effect.GROUP else [])
    assert [effect.id for effect in own_effect.effects_of_packages(CATALOGUE)] == [ID]
    points.append(EntryPoint("theirs", "no_such_module:EFFECT", own_effect.GROUP))
    with pytest.raises(InputError, match="entry point theirs: raises ModuleNotFoundError"):
        list(own_effect.effects_of_packages(CATALOGUE))


def test_check_fails_with_one_line_for_each_promise_that_is_not_kept(tmp_path: Path) -> None:
    file = tmp_path / "law.py"
    file.write_text(LAW.replace('"Hz", 1.0', '"bananas", 99.0'), encoding="utf-8")
    schema = json.loads((HOWTO.parents[1] / "schemas" / "effects.schema.json").read_text(encoding="utf-8"))
    jsonschema.validate(json.loads(RUN.invoke(cli.app, ["effects", "--check", str(file), "--json"]).stdout), schema)
    result = RUN.invoke(cli.app, ["effects", "--check", str(file)])
    assert isinstance(result.exception, InputError)
    assert "fails 1 of 1 checks" in str(result.exception)
    assert "FAILS  declaration: corner_Hz: 'bananas' is no SI unit" in result.stdout
    assert "nominal is beyond its bounds" in result.stdout


@pytest.mark.parametrize("unit", ["1", "1/m^2", "N s^0.5/m^0.5", "N/(m s)", "m/s^2", "rad/s"])
def test_units_of_the_catalogue_are_units(unit: str) -> None:
    assert promises.UNIT.fullmatch(unit)
    assert not promises.UNIT.fullmatch(f"{unit} lbf")


def test_a_parameter_file_with_a_law_that_is_not_there_says_how_to_bring_it(law: Path) -> None:
    file = law.with_name("after.yaml")
    file.write_text(f"{RIG}effects:\n  {ID}:\n    corner_Hz: {{value: 1.5, unit: Hz}}\n", encoding="utf-8")
    with pytest.raises(InputError, match=f"effects.{ID}: is no known effect.*One of your own: --effects FILE"):
        read_parameters(file)
    with effects_of(law):
        assert read_parameters(file).effects[ID]["corner_Hz"].value == 1.5


def test_a_session_cannot_name_a_file_that_is_run(law: Path) -> None:
    law.write_text(f"open({str(law.parent / 'run')!r}, 'w')\n{LAW}", encoding="utf-8")
    (law.parent / "rig.yaml").write_text(RIG, encoding="utf-8")
    for session in ({"effects": str(law)}, {"robot": str(law)}, {"robot": "rig.yaml", "effects": [str(law)]}):
        (law.parent / "session.yaml").write_text(
            yaml.safe_dump({"schema": "ssmr-ident/session/1", "baseline": "sdof", "recordings": [], **session}),
            encoding="utf-8",
        )
        result = RUN.invoke(cli.app, ["diagnose", str(law.parent), "-o", str(law.parent / "out")])
        assert isinstance(result.exception, InputError)
    assert not (law.parent / "run").exists()


def test_a_batch_does_again_what_another_law_has_answered(law: Path) -> None:
    task = Task("one", str(law.parent), str(law.parent / "out"), effects=(str(law),))
    assert Task.from_line(task.as_line()) == task
    before = task.fingerprint()
    law.write_text(LAW + "\n", encoding="utf-8")
    assert task.fingerprint() != before


@pytest.mark.slow
def test_every_process_of_a_sweep_knows_the_law_and_another_law_is_another_sweep(
    law: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(law.parent)
    call = ["sweep", "p3at-extended", "-e", "free_response", "--duration-s", "0.3", "--over", f"{ID}.corner_Hz=0,1,9"]
    call += ["--effects", law.name, "--workers", "2", "-o", "out", "--json"]
    first = json.loads(RUN.invoke(cli.app, call).stdout)
    assert [run[f"{ID}.corner_Hz"] for run in first["runs"]] == [0.0, 1.0, 9.0]
    assert len({run["ay_amplitude_m_s2"] for run in first["runs"]}) == 3
    assert json.loads(RUN.invoke(cli.app, call).stdout)["reused"] == 3
    law.write_text(LAW + "\n", encoding="utf-8")
    assert json.loads(RUN.invoke(cli.app, call).stdout)["reused"] == 0


@pytest.mark.slow
def test_from_check_to_a_name_as_the_page_says(law: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Every command of the page, as it stands there: the law is checked, simulated, and named with its value."""
    monkeypatch.chdir(law.parent)
    Path("session").mkdir()
    Path("session/rig.yaml").write_text(RIG, encoding="utf-8")
    Path("session/session.yaml").write_text(SESSION, encoding="utf-8")
    exec(compile(SHAKER, "shaker", "exec"), {})
    for call in CALLS:
        program, *arguments = shlex.split(call)
        assert program == "ident"
        result = RUN.invoke(cli.app, arguments)
        assert result.exit_code == 0, result.output
    said = yaml.safe_load(Path("diagnosis/diagnosis.yaml").read_text(encoding="utf-8"))
    assert said["verdict"] == "missing_physics"
    assert [effect["id"] for effect in said["effects"]] == [ID]
    corner = said["effects"][0]["parameters"]["corner_Hz"]
    assert abs(corner["value"] - 1.5) < 4.0 * corner["std"]
    assert list(CATALOGUE).count(ID) == 0
