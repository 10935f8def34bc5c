"""Verdicts on rigs that an integrator of their own made: what is said depends on the law, and on nothing else."""

from __future__ import annotations

import pytest
from integrated_rigs import STIFFNESS, rig

from ssmr_ident.workflows.diagnose import diagnose

pytestmark = pytest.mark.slow


def test_nothing_is_missing_where_nothing_is():
    found = diagnose(rig(lambda x, v: 0.0 * x))
    assert (found.verdict, found.effects) == ("nothing_missing", ())
    assert found.heldout.before < 1.1 * found.heldout.noise_floor
    assert found.before["stiffness_N_m"].value == pytest.approx(STIFFNESS, rel=0.01)
    assert not any("colour" in note for note in found.notes)


def test_hardening_is_named_with_its_size():
    found = diagnose(rig(lambda x, v: 6e8 * x**3))
    assert [e.id for e in found.effects] == ["nonlinear_stiffness"]
    size = found.effects[0].parameters["k3_N_m3"]
    assert abs(float(size.value) - 6e8) < 3.0 * float(size.std) < 0.2 * 6e8
    assert found.heldout.after < 1.2 * found.heldout.noise_floor
