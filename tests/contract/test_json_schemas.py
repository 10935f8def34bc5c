"""What every verb prints with --json is what docs/schemas publishes."""

from __future__ import annotations

import json
from collections.abc import Callable
from pathlib import Path
from typing import Any

import jsonschema
import pytest
import yaml
from made_diagnoses import EVERY, hardening
from small_fleet import write_fleet
from typer.testing import CliRunner

from ssmr_ident import cli
from ssmr_ident.core.parameter import Estimate
from ssmr_ident.diagnose import Diagnosis
from ssmr_ident.workflows.demo.hidden import Hidden
from ssmr_ident.workflows.demo.table import DemoRow, DemoTable
from thesis2012.rows import Row, Scoreboard

RUN = CliRunner()
RAW = Path(__file__).resolve().parents[2] / "data" / "raw"
SCHEMAS = Path(__file__).resolve().parents[2] / "docs" / "schemas"


def schema(name: str) -> dict[str, Any]:
    return json.loads((SCHEMAS / f"{name}.schema.json").read_text(encoding="utf-8"))


def check(name: str, answer: Any) -> None:
    jsonschema.validate(answer, schema(name), cls=jsonschema.Draft202012Validator)


def answer_of(*arguments: str) -> Any:
    result = RUN.invoke(cli.app, [*arguments, "--json"])
    assert result.exit_code == 0, result.output
    return json.loads(result.stdout)


@pytest.mark.parametrize("path", sorted(SCHEMAS.glob("*.json")), ids=lambda path: path.stem)
def test_every_schema_is_one(path: Path) -> None:
    jsonschema.Draft202012Validator.check_schema(json.loads(path.read_text(encoding="utf-8")))


def test_every_verb_has_a_schema() -> None:
    names = {path.name.removesuffix(".schema.json") for path in SCHEMAS.iterdir()}
    assert names == {"diagnosis" if verb == "diagnose" else verb for verb in cli.VERBS} | {"diagnosis"}


def test_export(tmp_path: Path) -> None:
    check("export", answer_of("export", "p3at-extended", "--to", "csv", "-o", str(tmp_path / "robot.csv")))


@pytest.mark.slow
def test_batch(tmp_path: Path) -> None:
    write_fleet(tmp_path / "in", 1)
    check(
        "batch", answer_of("batch", str(tmp_path / "in"), "-o", str(tmp_path / "out"), "--no-diagnose", "--jobs", "1")
    )


@pytest.mark.parametrize("log", ["free_response/roll-1.xlsx", "pulls/concrete-lateral-steel-1.txt"])
def test_inspect(log: str) -> None:
    check("inspect", answer_of("inspect", str(RAW / log)))


@pytest.mark.slow
@pytest.mark.parametrize("logs", [["free_response/roll-1.xlsx"], ["swivel-frame/concrete.yaml"]])
def test_spectrum(logs: list[str], tmp_path: Path) -> None:
    answer = answer_of("spectrum", *(str(RAW / log) for log in logs), "-o", str(tmp_path), "--no-figures")
    check("spectrum", answer)
    assert answer["files"]


@pytest.mark.slow
def test_sweep(tmp_path: Path) -> None:
    over = ("--over", "lambda_max=0.5,1", "-e", "swivel", "--duration-s", "0.3", "--workers", "1", "-o", str(tmp_path))
    answer = answer_of("sweep", "p3at-extended", *over)
    check("sweep", answer)
    assert [run["lambda_max"] for run in answer["runs"]] == [0.5, 1.0]


@pytest.mark.slow
def test_geometry() -> None:
    check("geometry", answer_of("geometry", str(SCHEMAS.parent / "howto" / "measurements.yaml")))


@pytest.mark.slow
@pytest.mark.parametrize("call", [["pulls/carpet.yaml"], ["free_response", "--method", "modal"]])
def test_fit_of_a_robot(call: list[str]) -> None:
    check("fit", answer_of("fit", str(RAW / call[0]), *call[1:]))


@pytest.mark.slow
def test_the_whole_way_of_a_rig(tmp_path: Path) -> None:
    """A rig's log simulated, described by ``ident new``, fitted, compared, diagnosed: five answers."""
    (tmp_path / "rig.yaml").write_text(
        "schema: ssmr-ident/parameters/1\nmass_kg: {value: 8.0, unit: kg}\nstiffness_N_m: {value: 20000, unit: N/m}\n"
        "damping_N_s_m: {value: 50, unit: N s/m}\n"
    )
    push = "".join(f"{i / 1000},{50.0 if i % 97 < 40 else -30.0}\n" for i in range(4000))
    (tmp_path / "push.csv").write_text("time [s],force [N]\n" + push)
    logs = tmp_path / "logs"
    logs.mkdir()
    log, push_log = str(logs / "run.csv"), str(tmp_path / "push.csv")
    check("simulate", answer_of("simulate", str(tmp_path / "rig.yaml"), "-e", "forced", "--force", push_log, "-o", log))
    check("new", answer_of("new", str(logs)))
    check("fit", answer_of("fit", str(logs), "-o", str(tmp_path / "p.yaml")))
    check("compare", answer_of("compare", str(logs), "--params", str(tmp_path / "p.yaml")))
    told = answer_of("diagnose", str(logs), "-o", str(tmp_path / "out"))
    check("diagnosis", told)
    assert told == yaml.safe_load((tmp_path / "out" / "diagnosis.yaml").read_text(encoding="utf-8"))


def test_new_with_questions(tmp_path: Path) -> None:
    (tmp_path / "roll-1.xlsx").write_bytes((RAW / "free_response" / "roll-1.xlsx").read_bytes())
    (tmp_path / "odd.csv").write_text("nothing here\n")
    answer = answer_of("new", str(tmp_path))
    check("new", answer)
    assert answer["questions"]
    assert answer["aside"]


def test_effects(tmp_path: Path) -> None:
    check("effects", answer_of("effects"))
    check("effects", answer_of("effects", "dry_friction"))


def test_two_parameter_sets(tmp_path: Path) -> None:
    for name in ("a", "b"):
        text = "schema: ssmr-ident/parameters/1\nmass_kg: {value: 8.0, std: 0.1, unit: kg}\n"
        (tmp_path / f"{name}.yaml").write_text(text)
    check("compare", answer_of("compare", str(tmp_path / "a.yaml"), str(tmp_path / "b.yaml")))


@pytest.mark.slow
def test_demo() -> None:
    """The three forms that the verb prints, from the values that it prints (the whole job takes half a minute)."""
    hidden = Hidden({"dry_friction": {"F_c_N": Estimate(0.4)}}, hardening(), Path("rig"), Path("report.html"))
    check("demo", hidden.as_dict())
    table = DemoTable((DemoRow("roll: natural frequency", "rad/s", "38.0", 38.8, None, 38.8),))
    check("demo", {"table": table.as_list(), "report": "out/report.html"})
    board = Scoreboard((Row("a", "2.1", "s", "1", "1", True), Row("b", "2.2", "s", "1", "1", None)))
    check("demo", board.as_dict())


@pytest.mark.slow
@pytest.mark.parametrize("make", EVERY, ids=lambda make: make.__name__)
def test_diagnosis(make: Callable[[], Diagnosis]) -> None:
    """Every kind of verdict, as it is written to diagnosis.yaml and read back."""
    check("diagnosis", json.loads(json.dumps(make().as_dict(), allow_nan=False)))
    check("diagnosis", yaml.safe_load(yaml.safe_dump(make().as_dict())))


@pytest.mark.parametrize("name", ["compare", "fit", "diagnosis"])
def test_a_wrong_answer_is_refused(name: str) -> None:
    with pytest.raises(jsonschema.ValidationError):
        check(name, {"session": "s", "surprise": 1})
