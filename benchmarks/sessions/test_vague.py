"""A law whose size the recordings do not give stands in for another, or for two."""

from __future__ import annotations

import pytest
from bank import FAMILIES, mixed

from ssmr_ident.diagnose import explore
from ssmr_ident.physics.effects import CATALOGUE
from ssmr_ident.workflows.diagnose import diagnose

SEED, BOTH = 6375, ("viscoelastic_relaxation", "nonlinear_stiffness")


def test_what_one_law_stands_in_for_without_a_size_is_two(monkeypatch: pytest.MonkeyPatch) -> None:
    drawn = mixed(SEED, tuple(FAMILIES))
    assert set(drawn.truth.effects) == set(BOTH)
    monkeypatch.setattr(
        explore, "candidates", lambda fit, baseline: tuple(CATALOGUE[e] for e in BOTH if e not in fit.model.held)
    )
    found = diagnose(drawn.campaign)
    assert {effect.id for effect in found.effects} == set(BOTH)
    sizes = {name: p for effect in found.effects for name, p in effect.parameters.items()}
    true = drawn.truth.effects["nonlinear_stiffness"]["k3_N_m3"]
    assert sizes["k3_N_m3"].std is not None
    assert abs(float(sizes["k3_N_m3"].value) - true) < 3.0 * sizes["k3_N_m3"].std
    assert found.heldout.after < 0.7 * found.heldout.before
