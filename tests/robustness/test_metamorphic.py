"""One experiment, logged in other ways, has one answer; benchmarks/metamorphic.py asks more sessions in all ways."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from retold import OTHERWISE, SAME_SAMPLES, rolls, shaken

from ssmr_ident.workflows.diagnose import diagnose_session
from ssmr_ident.workflows.fit.run import fit_session

pytestmark = pytest.mark.slow


@pytest.mark.parametrize("way", OTHERWISE)
def test_the_same_fit(tmp_path: Path, way: str) -> None:
    made = shaken()
    usual = fit_session(made.write(tmp_path)).parameters
    other = fit_session(OTHERWISE[way](replace(made, folder="other")).write(tmp_path)).parameters
    for key in ("mass_kg", "damping_N_s_m", "stiffness_N_m"):
        a, b = usual[key], other[key]
        assert a.std is not None
        assert b.std is not None
        apart = 1e-3 if way in SAME_SAMPLES else 3.0
        assert abs(a.value - b.value) <= apart * np.hypot(a.std, b.std), (key, str(a), str(b))


@pytest.mark.parametrize("way", OTHERWISE)
def test_the_same_diagnosis_where_nothing_is_missing(tmp_path: Path, way: str) -> None:
    told = diagnose_session(OTHERWISE[way](shaken()).write(tmp_path))
    assert (told.verdict, told.effects) == ("nothing_missing", ())


@pytest.mark.parametrize("way", ["in volts", "with signs turned", "at half the rate"])
def test_the_same_name_where_a_law_is_missing(tmp_path: Path, way: str) -> None:
    told = diagnose_session(OTHERWISE[way](shaken(hardening=2e7)).write(tmp_path))
    assert (told.verdict, [effect.id for effect in told.effects]) == ("missing_physics", ["nonlinear_stiffness"])


@pytest.mark.parametrize("way", ["begun later", "at half the rate"])
def test_the_same_law_of_a_robot(tmp_path: Path, way: str) -> None:
    told = diagnose_session(OTHERWISE[way](rolls("nonlinear_stiffness.k3_N_m3", 1e10)).write(tmp_path))
    assert [effect.id for effect in told.effects] == ["nonlinear_stiffness"]
    k3 = told.effects[0].parameters["k3_N_m3"]
    assert k3.std is not None
    assert abs(k3.value - 1e10) < 3.0 * k3.std
