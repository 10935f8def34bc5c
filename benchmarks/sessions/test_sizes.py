"""Tires that soften under decays that are a third noise; a mast on a robot much smaller than the bundled one."""

from __future__ import annotations

import numpy as np
import pytest
from bank import FAMILIES, mixed
from bank.decays import draw_decays
from bank.scaled import Scale

from ssmr_ident.workflows.diagnose import diagnose

SEED, K3 = 6264, -4.222e7


def test_tires_that_soften_are_named_under_noise() -> None:
    found = diagnose(mixed(SEED, tuple(FAMILIES)).campaign)
    assert [effect.id for effect in found.effects] == ["nonlinear_stiffness"]
    assert found.effects[0].parameters["k3_N_m3"].value == pytest.approx(K3, rel=0.1)
    assert found.heldout.after < 0.75 * found.heldout.before
    assert np.isfinite(found.heldout.after)


def test_a_mast_on_a_robot_of_two_kilograms_is_named() -> None:
    """Its numbers are those of the mast on the robot of thirty, by similarity."""
    small = Scale(0.064, 0.4)
    drawn = draw_decays("one", 502, "flexible_mast", 0.6, True, small)
    found = diagnose(drawn.campaign)
    assert [effect.id for effect in found.effects] == ["flexible_mast"]
    assert found.heldout.after < 0.3 * found.heldout.before
    values, truth = found.effects[0].parameters, drawn.truth.effects["flexible_mast"]
    assert values["f_mast_Hz"].value == pytest.approx(truth["f_mast_Hz"] * small.factor("Hz"), rel=0.03)
    assert values["mass_kg"].value == pytest.approx(truth["mass_kg"] * small.factor("kg"), rel=0.15)
    assert values["height_above_com_m"].value == pytest.approx(truth["height_above_com_m"] * small.length, rel=0.15)
