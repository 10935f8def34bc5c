"""What a diagnosis of a rotary rig says of its effects, in moments and angles."""

from __future__ import annotations

from dataclasses import replace

import pytest
from made_diagnoses import hardening, undetermined

from ssmr_ident.diagnose.diagnosis import Diagnosis
from ssmr_ident.session.parameters_text import parameters_text
from ssmr_ident.workflows.diagnose import in_rig_units


def found() -> Diagnosis:
    return in_rig_units(replace(hardening(), conflicts=(), located=()))


def test_effects_of_a_rotary_rig_are_in_rotary_units() -> None:
    answer = found()
    assert "N m/rad^3" in str(answer)
    assert "N/m^3" not in str(answer)
    assert answer.as_dict()["effects"][0]["parameters"]["k3_N_m3"]["unit"] == "N m/rad^3"
    text = parameters_text(answer.after)
    assert 'unit: "N m/rad^3"' in text
    assert "N/m^3" not in text


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
