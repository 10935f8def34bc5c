"""What a diagnosis lists of an effect: what was fitted, and what else a file needs to be read back as it is."""

from __future__ import annotations

import pytest

from ssmr_ident.doctor.laws import FORMS, Form
from ssmr_ident.doctor.result import needed
from ssmr_ident.physics.effects import CATALOGUE
from ssmr_ident.physics.slots import checked


@pytest.mark.parametrize("form", FORMS, ids=lambda form: f"{form.effect} {form.name}")
def test_a_listed_effect_is_read_back(form: Form) -> None:
    shape = form.shapes(1e-3, 0.1, 5.0)[0]
    values = CATALOGUE[form.effect].begun(form.unit(shape, 3000.0, 1e-3, 0.1, 5.0))
    names = needed(form.effect, values, form.moved)
    assert set(form.moved) <= set(names)
    assert checked({form.effect: {name: values[name] for name in names}})[form.effect] == values


def test_what_a_formula_has_not_is_not_listed() -> None:
    cubic = CATALOGUE["nonlinear_stiffness"].begun({"k3_N_m3": 1e7})
    assert needed("nonlinear_stiffness", cubic, {"k3_N_m3"}) == ["k3_N_m3"]
    slider = CATALOGUE["dry_friction"].begun({"F_c_N": 1.0, "element_stiffness_N_m": 1e4, "slider": 1.0})
    assert needed("dry_friction", slider, {"F_c_N"}) == ["F_c_N", "element_stiffness_N_m", "slider"]
