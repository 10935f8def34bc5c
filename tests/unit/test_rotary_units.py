"""What a diagnosis of a rotary rig says of its effects, in moments and angles."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import pytest
from made_diagnoses import hardening, undetermined

from ssmr_ident.core.errors import InputError
from ssmr_ident.core.parameter import Estimate
from ssmr_ident.diagnose.diagnosis import Diagnosis
from ssmr_ident.diagnose.words import told
from ssmr_ident.physics.slots import effect_values
from ssmr_ident.session import read_parameters
from ssmr_ident.session.parameters_text import parameters_text
from ssmr_ident.workflows.diagnose import in_rig_units


def found() -> Diagnosis:
    return in_rig_units(replace(hardening(), conflicts=(), located=()))


def test_effects_of_a_rotary_rig_are_in_rotary_units() -> None:
    answer = found()
    assert "N m/rad^3" in str(answer)
    assert "N/m^3" not in str(answer)
    assert answer.as_dict()["effects"][0]["parameters"]["k3_N_m_rad3"]["unit"] == "N m/rad^3"
    text = parameters_text(answer.after)
    assert 'unit: "N m/rad^3"' in text
    assert "k3_N_m_rad3: {" in text
    assert "N/m^3" not in text


def test_the_sentence_has_the_numbers_in_them_too() -> None:
    straight = hardening()
    (effect,) = straight.effects
    told_ = replace(effect, sentence=told(effect.id, effect.parameters))
    (turned,) = in_rig_units(replace(straight, effects=(told_,))).effects
    assert turned.sentence.endswith(": k3_N_m_rad3 = 3.104e+08 ± 2.1e+07 N m/rad^3.")


def test_a_file_says_them_by_either_name_and_means_the_same(tmp_path: Path) -> None:
    head = (
        "schema: ssmr-ident/parameters/1\nname: rig\ninertia_kg_m2: {value: 0.01, unit: kg m^2}\n"
        "stiffness_N_m_rad: {value: 5.0, unit: N m/rad}\ndamping_N_m_s_rad: {value: 0.002, unit: N m s/rad}\n"
    )
    read = []
    for number, name in enumerate(("k3_N_m_rad3", "k3_N_m3")):
        file = tmp_path / f"{number}.yaml"
        file.write_text(f"{head}effects:\n  nonlinear_stiffness:\n    {name}: {{value: 6.2, unit: N m/rad^3}}\n")
        read.append(read_parameters(file))
    (wanted,) = read[0].effects.values()
    assert wanted == {"k3_N_m_rad3": Estimate(6.2, None, "N m/rad^3")}
    assert read[1].effects == read[0].effects
    assert effect_values(read[0])["nonlinear_stiffness"]["k3_N_m3"] == 6.2
    both = tmp_path / "both.yaml"
    one = "{value: 1.0, unit: N m/rad^3}"
    both.write_text(f"{head}effects:\n  nonlinear_stiffness: {{k3_N_m_rad3: {one}, k3_N_m3: {one}}}\n")
    with pytest.raises(InputError, match="stands twice"):
        read_parameters(both)


@pytest.mark.slow
def test_the_page_says_them_too() -> None:
    from ssmr_ident.report.diagnosis_page import render_report

    page = render_report(found(), "ident diagnose rig", 0)
    assert "N m/rad³" in page.replace("\u202f", " ").replace("\u00a0", " ").replace("·", " ")


def test_a_curve_of_a_rotary_rig_is_over_an_angle() -> None:
    straight = undetermined()
    (effect,) = in_rig_units(straight).effects
    assert effect.curve is not None
    assert effect.curve["variable"] == "angle [rad]"
    assert effect.curve["points"] == straight.effects[0].curve["points"]  # type: ignore[index]
