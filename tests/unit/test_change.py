"""Two parameter sets against each other: what is called changed, and what is said of two diagnoses."""

from __future__ import annotations

import json
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from made_diagnoses import hardening, nothing
from typed_command import typed

from ssmr_ident.compare.change import Changes, Side, changes
from ssmr_ident.core.documents import yaml_text
from ssmr_ident.core.errors import InputError
from ssmr_ident.core.parameter import Estimate, ParameterSet
from ssmr_ident.diagnose.diagnosis import Diagnosis
from ssmr_ident.report.changes_page import changes_page
from ssmr_ident.report.html import render_page
from ssmr_ident.session import write_parameters


def rig(stiffness: float, std: float | None = 10.0, **others: Estimate) -> ParameterSet:
    known = {"stiffness_N_m": Estimate(stiffness, std, "N/m"), "mass_kg": Estimate(2.0, None, "kg", fixed=True)}
    return ParameterSet("rig", {**known, **others})


def between(first: ParameterSet, second: ParameterSet) -> Changes:
    return changes(Side("a.yaml", first), Side("b.yaml", second))


def test_a_change_of_many_standard_deviations_is_one_and_of_one_is_none() -> None:
    large, small = between(rig(3200.0), rig(3300.0)), between(rig(3200.0), rig(3214.0))
    assert [c.parameter for c in large.changed] == ["stiffness_N_m"]
    assert (large.changed[0].difference, large.changed[0].relative) == (100.0, pytest.approx(1 / 32))
    assert small.changed == ()
    assert small.changes[0].p_value == pytest.approx(0.322, abs=1e-3)  # 0.99 standard deviations of the difference


def test_chance_calls_one_in_twenty_comparisons_changed_however_many_parameters_there_are() -> None:
    rng = np.random.default_rng(3)

    def drawn() -> ParameterSet:
        return ParameterSet("rig", {f"p{k}": Estimate(float(v), 1.0) for k, v in enumerate(rng.standard_normal(12))})

    false = sum(bool(between(drawn(), drawn()).changed) for _ in range(400))
    assert 8 <= false <= 33  # 20 expected; 0.1 % of the binomial's ends


def test_what_is_held_fixed_or_stands_in_one_alone_is_told() -> None:
    other = replace(rig(3200.0), effects={"dry_friction": {"F_c_N": Estimate(0.4, 0.01, "N")}})
    heavier = other.updated({"mass_kg": Estimate(2.5, None, "kg", fixed=True)})
    found = between(rig(3200.0), heavier)
    assert [c.parameter for c in found.changed] == ["mass_kg"]
    assert "effects.dry_friction.F_c_N  none -> 0.4 ± 0.01 N  second only" in str(found)


def test_other_units_and_other_things_are_refused() -> None:
    with pytest.raises(InputError, match=r"is in N/mm, in a\.yaml in N/m"):
        between(rig(3200.0), rig(0.0).updated({"stiffness_N_m": Estimate(3.2, 0.1, "N/mm")}))
    with pytest.raises(InputError, match="share no parameter"):
        between(rig(3200.0), ParameterSet("robot", {"tire.mu_kinetic": Estimate(0.7)}))


def written(diagnosis: Diagnosis, folder: Path, parameters: ParameterSet) -> Path:
    folder.mkdir()
    write_parameters(folder / "after.yaml", parameters)
    (folder / "diagnosis.yaml").write_text(yaml_text(diagnosis.as_dict()), encoding="utf-8")
    return folder


def test_two_diagnoses_as_they_are_typed(tmp_path: Path) -> None:
    damping = Estimate(1.2, 0.1, "N s/m")
    written(hardening(), tmp_path / "march", rig(3200.0, damping_N_s_m=damping))
    written(nothing(), tmp_path / "june", rig(3300.0, damping_N_s_m=damping))
    told = typed("compare", "march", "june", "-o", "out", cwd=tmp_path)
    assert told.returncode == 0, told.stderr
    assert "first: missing physics: nonlinear_stiffness" in told.stdout
    assert "stiffness_N_m  3200 ± 10 -> 3300 ± 10 N/m  +3.12 %  changed" in told.stdout
    page = (tmp_path / "out" / "report.html").read_text(encoding="utf-8")
    assert "1 parameter has changed; nonlinear stiffness is no longer missing" in page
    assert (tmp_path / "out" / "changes.csv").read_text(encoding="utf-8").count("\n") == 4
    answer = json.loads(typed("compare", "march", "june", "--json", cwd=tmp_path).stdout)
    assert [c["parameter"] for c in answer["changes"] if c["changed"]] == ["stiffness_N_m"]
    assert answer["second"]["verdict"] == "nothing_missing"


def test_a_folder_without_a_diagnosis_and_params_beside_are_told(tmp_path: Path) -> None:
    (tmp_path / "march").mkdir()
    write_parameters(tmp_path / "a.yaml", rig(1.0))
    for words in (("march", "a.yaml"), ("a.yaml", "march"), ("a.yaml", "a.yaml", "--params", "a.yaml")):
        told = typed("compare", *words, cwd=tmp_path)
        assert told.returncode == 2
        assert len(told.stderr.strip().splitlines()) == 1


def test_nothing_changed_is_said_so() -> None:
    page = changes_page(between(rig(3200.0), rig(3201.0)), "", ())
    assert page.verdict is not None
    assert (page.verdict.label, page.verdict.tone) == ("Nothing has changed", "clear")
    assert "within its uncertainty" in render_page(page)


def test_what_both_diagnoses_found_of_an_effect_is_drawn_side_by_side() -> None:
    first = {"variable": "velocity [m/s]", "points": [-1.0, 0.0, 1.0], "force": [-2.0, 0.0, 2.0], "std": [0.1] * 3}
    second = first | {"points": [-0.5, 0.0, 0.5], "force": [-3.0, 0.0, 3.0]}
    sides = [
        Side(
            name,
            rig(3200.0),
            "missing_physics",
            ("dry_friction",),
            "nrmse_percent",
            (9.0, 3.0, 2.0),
            {"dry_friction": c},
        )
        for name, c in (("before", first), ("after", second))
    ]
    verdict = changes_page(changes(*sides), "", ()).verdict
    assert verdict is not None
    assert verdict.chart is not None
    one, other = verdict.chart.lines
    assert (one.label, other.label, verdict.chart.x_label, verdict.chart.y_unit) == ("before", "after", "velocity", "N")
    np.testing.assert_allclose(verdict.chart.x, [-1.0, -0.5, 0.0, 0.5, 1.0])
    np.testing.assert_allclose(one.y, [-2.0, -1.0, 0.0, 1.0, 2.0])
    np.testing.assert_allclose(other.y, [np.nan, -3.0, 0.0, 3.0, np.nan])
