"""Every kind of experiment says all of itself in its own file, and no other room asks for its name."""

from __future__ import annotations

import ast
import importlib
import re
from collections import Counter
from collections.abc import Iterator
from pathlib import Path

import numpy as np
import pytest

from ssmr_ident.cli.simulate import CHOICES
from ssmr_ident.experiments import EXPERIMENTS, Conditions, Drive, Experiment, Likelihood
from ssmr_ident.experiments.quantities import UNITS
from ssmr_ident.physics.effects import CATALOGUE
from ssmr_ident.physics.robot import robot_from_parameters
from ssmr_ident.session import entry, read_parameters

ALL = [pytest.param(kind, id=name) for name, kind in EXPERIMENTS.items()]
CONSTANTS = {name.upper() for name in EXPERIMENTS} | {"EXPERIMENTS"}
SPOKEN_OF = re.compile(rf"\b(experiment|{'|'.join([*CONSTANTS, *EXPERIMENTS])})\b")
COMPARING = {
    "ssmr_ident/session/entry.py": "the names that session.yaml may hold: a file format, below this room",
    "ssmr_ident/workflows/simulate/table.py": "what can be simulated in which experiment, in one table",
    "ssmr_ident/workflows/simulate/request.py": "the name that a person typed, looked up once",
    "ssmr_ident/workflows/new/run.py": "the same of `ident new`, which does without the simulators",
    "ssmr_ident/workflows/effects/panels.py": "what a page draws of an effect in each kind of experiment",
    "ssmr_ident/doctor/swivels/anchor.py": "two runs of one kind are compared with each other, not with a name",
}
"""Places outside experiments/ that may compare, each with its reason."""


@pytest.mark.parametrize("kind", ALL)
def test_one_file_says_all(kind: Experiment) -> None:
    module = importlib.import_module(f"ssmr_ident.experiments.{kind.name}")
    assert getattr(module, kind.name.upper()) is kind
    assert kind.sentence.endswith(".")
    assert kind.verb.istitle()
    assert kind.nuisances
    assert set(kind.baselines) <= set(entry.BASELINES)
    assert {name for group in kind.channels for name in group} <= set(UNITS)
    assert (kind.likelihood is Likelihood.FORCE) == (kind.drive is Drive.HEAD)
    assert not kind.on_a_testing_machine or kind.channels[-1] == ("force",)  # what answers comes last
    # no effect says of a moved foot yet that it shows it
    assert any(kind.shows(effect) for effect in CATALOGUE.values()) != kind.on_a_base
    assert str(kind).startswith(kind.name)


@pytest.mark.parametrize("kind", ALL)
def test_the_robots_simulator_runs_what_is_done_to_the_robot(kind: Experiment) -> None:
    whole_robot = "rigid6" in kind.baselines and not kind.of_one_wheel
    assert (kind.scenario is not None) == whole_robot
    if kind.scenario is None:
        return
    scenario = kind.scenario(robot_from_parameters(read_parameters("p3at-extended")), Conditions(), 2.0)
    assert scenario.duration == 2.0
    assert scenario.experiment == kind.name
    assert scenario.pulled == kind.on_a_testing_machine
    assert bool(scenario.offset) == kind.free
    np.testing.assert_array_equal(np.sign(scenario.wheel_rates[0]), kind.wheel_signs)


def test_lists_of_names_agree() -> None:
    assert tuple(EXPERIMENTS) == entry.EXPERIMENTS
    assert set(CHOICES.split(", ")) == set(EXPERIMENTS)


def test_a_word_in_a_files_name_hints_at_one_kind() -> None:
    words = Counter(word for kind in EXPERIMENTS.values() for word in kind.file_words)
    assert max(words.values()) == 1


def test_no_other_room_compares_names(root: Path) -> None:
    found = Counter[str]()
    for folder in ("src/ssmr_ident", "src/ssmr_proof", "studies"):
        for path in sorted((root / folder).rglob("*.py")):
            where = path.relative_to(root / "src" if folder.startswith("src") else root).as_posix()
            if not where.startswith("ssmr_ident/experiments/"):
                text = path.read_text(encoding="utf-8")
                if SPOKEN_OF.search(text):
                    found[where] += len(list(comparisons(text, where)))
    assert {where: count for where, count in found.items() if count} == dict.fromkeys(COMPARING, 1)


@pytest.mark.parametrize(
    ("text", "count"),
    [
        ('a = entry.experiment == "pull"', 1),
        ('a = x in ("swivel", "straight")', 1),
        ("a = trial.experiment is PULL", 1),
        ('a = {"pull": 1, "forced": 2}[x]', 1),
        ("a = {PULL: 1}", 1),
        ('TURNING = ("swivel", "straight")', 1),
        ('match x:\n    case "swivel":\n        pass', 1),
        ('EFFECT = Effect(experiments=("swivel", "straight"))', 0),
        ("a = trial.experiment.free and label.experiment is not None", 0),
        ('a = Scenario("pull", 1.0)', 0),
    ],
)
def test_a_comparison_is_seen(text: str, count: int) -> None:
    assert len(list(comparisons(text, "ssmr_ident/one.py"))) == count


def comparisons(text: str, where: str) -> Iterator[ast.AST]:
    """Comparisons and memberships, tables and lists by the names or constants of experiments."""
    tree = ast.parse(text)
    declared = {id(k.value) for k in ast.walk(tree) if isinstance(k, ast.keyword) and k.arg == "experiments"}
    inside: set[int] = set()
    for node in ast.walk(tree):
        if id(node) in declared:
            continue
        if isinstance(node, ast.Compare):
            operands = [node.left, *node.comparators]
            inside |= {id(operand) for operand in operands}
            absent = any(isinstance(o, ast.Constant) and o.value is None for o in operands)
            if not absent and any(_names(o, where) or _is_experiment(o) for o in operands):
                yield node
        elif isinstance(node, ast.Dict):
            # a table by experiment, not one that happens to have a row of that name
            if 2 * sum(key is not None and _names(key, where) for key in node.keys) >= max(len(node.keys), 1):
                yield node
        elif isinstance(node, ast.MatchValue):
            if _names(node.value, where):
                yield node
        elif isinstance(node, ast.Tuple | ast.List | ast.Set) and id(node) not in inside:
            texts = [e for e in node.elts if isinstance(e, ast.Constant) and _names(e, where)]
            if len(texts) > 1 and len(texts) == len(node.elts):
                yield node


def _names(node: ast.AST, where: str) -> bool:
    """Whether an operand names a kind of experiment, by itself or among others."""
    if isinstance(node, ast.Tuple | ast.List | ast.Set):
        return any(_names(element, where) for element in node.elts)
    if isinstance(node, ast.Constant):
        family = where.startswith("ssmr_proof/") and node.value == "pull"  # there also a family of plants
        return node.value in EXPERIMENTS and not family
    return isinstance(node, ast.Name) and node.id in CONSTANTS


def _is_experiment(node: ast.AST) -> bool:
    return (isinstance(node, ast.Attribute) and node.attr == "experiment") or (
        isinstance(node, ast.Name) and node.id == "experiment"
    )
