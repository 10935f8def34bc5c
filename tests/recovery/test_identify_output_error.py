"""Output error on recordings whose truth is known; pure rotations put their conflict on the inertia; figures."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest
from matplotlib.image import imread
from typer.testing import CliRunner

from ssmr_ident.cli import app
from ssmr_ident.compare import compare
from ssmr_ident.core.errors import InputError
from ssmr_ident.experiments.campaign import load
from ssmr_ident.session import read_parameters
from ssmr_ident.workflows.fit.run import fit_session

pytestmark = pytest.mark.slow

KEYS = {
    "m": "mass_kg", "Ixx": "inertia_kg_m2.xx", "Iyy": "inertia_kg_m2.yy", "Izz": "inertia_kg_m2.zz",
    "Ixz": "inertia_kg_m2.xz", "h": "height_m", "Kx": "tire.stiffness_x_N_m", "Ky": "tire.stiffness_y_N_m",
    "Kz": "tire.stiffness_z_N_m", "Dx": "tire.damping_x_N_s_m", "Dy": "tire.damping_y_N_s_m",
    "Dz": "tire.damping_z_N_s_m",
}  # fmt: skip


@pytest.mark.shared
@pytest.mark.parametrize("name", ["practice-07", "practice-08"])
def test_nulls_come_back_within_three_stds(shared: Path, name: str) -> None:
    folder = shared / "practice" / name
    truth = json.loads((folder / "truth.json").read_text())
    fit = fit_session(folder / "session")
    found = {variable.name: variable for variable in fit.variables}
    for short, path in KEYS.items():
        variable = found[path]
        assert variable.std is not None
        assert abs(variable.value - truth["true_robot"][short]) < 3 * variable.std, path
        if short[0] in "KD":
            assert variable.std < 0.015 * variable.value, "told to a percent, the mass' own"
    assert not fit.conflicts
    heldout = compare(load(folder / "heldout"), fit.parameters)
    assert heldout.overall["nrmse_percent"] < 1.1 * truth["heldout"]["noise_floor"]


@pytest.mark.shared
def test_missing_physics_does_not_drive_parameters_from_what_is_known(shared: Path) -> None:
    """Tires that harden: the samples count for what the model's own error leaves them worth."""
    folder = shared / "practice" / "practice-01"
    truth = json.loads((folder / "truth.json").read_text())
    fit = fit_session(folder / "session")
    assert any("the model misses something" in text for text in fit.findings)
    assert all(conflict["sigmas"] < 4 for conflict in fit.conflicts)
    heldout = compare(load(folder / "heldout"), fit.parameters)
    assert heldout.overall["nrmse_percent"] < 1.1 * truth["heldout"]["baseline_refit"]


def test_reference_decays_come_back(root: Path) -> None:
    folder = root / "data" / "raw" / "free_response"
    fit, truth = fit_session(folder), read_parameters(folder / "truth.yaml")
    shifts = {"height_m": 0.228, "contact_shift_x_m": 0.006, "contact_shift_y_m": 0.0}
    places = dict(
        zip((f"accelerometer.position_m.{a}" for a in "xyz"), truth["accelerometer.position_m"].value, strict=True)
    )
    scores = {}
    for variable in fit.variables:
        if "mu_" in variable.name:
            continue
        known = {**shifts, **places}.get(variable.name)
        known = float(truth[variable.name].value) if known is None else float(known)
        assert variable.std is not None
        scores[variable.name] = (variable.value - known) / variable.std
    assert max(map(abs, scores.values())) < 3.0, scores
    assert np.sqrt(np.mean(np.square(list(scores.values())))) < 1.4
    assert abs(scores["tire.damping_z_N_s_m"]) < 2
    np.testing.assert_allclose(np.mean(np.asarray(fit.parameters["contact_points_m"].value)[:, 0]), -0.004, atol=0.0025)


@pytest.mark.shared
def test_pure_rotations_put_the_conflict_on_the_inertia(shared: Path) -> None:
    fit = fit_session(shared / "practice" / "practice-09" / "session")
    worst = [conflict["parameter"] for conflict in fit.conflicts[:2]]
    assert set(worst) == {"inertia_kg_m2.xx", "inertia_kg_m2.yy"}
    assert {"parameter", "prior", "fitted", "sigmas"} <= set(fit.conflicts[0])
    assert all("stiffness" not in str(conflict["parameter"]) for conflict in fit.conflicts)
    found = {variable.name: variable for variable in fit.variables}
    # the std of an inertia solved by (5.10) is at least that of the stiffness behind it
    assert found["inertia_kg_m2.yy"].std > 0.06 * found["inertia_kg_m2.yy"].value


def test_pure_rotations_have_no_samples_to_fit(root: Path) -> None:
    with pytest.raises(InputError, match="pure rotations"):
        fit_session(root / "data" / "raw" / "free_response" / "decoupled.yaml", method="output-error")
    with pytest.raises(InputError, match="output-error"):
        fit_session(root / "data" / "raw" / "free_response", method="output_error")


def test_figures_show_teeth_and_levels(root: Path, tmp_path: Path) -> None:
    result = CliRunner().invoke(
        app, ["fit", str(root / "data" / "raw" / "pulls" / "concrete.yaml"), "--figures", str(tmp_path), "-q"]
    )
    assert result.exit_code == 0, result.output
    written = sorted(path.name for path in tmp_path.glob("*.png"))
    assert "sawtooth-concrete-lateral-steel-1.png" in written
    picture = imread(tmp_path / "sawtooth-concrete-lateral-one-wheel-1.png")
    assert picture.shape[1] > 1000
    # ink of the teeth's two colours is there
    for colour in ((0xD5, 0x5E, 0x00), (0x00, 0x9E, 0x73)):
        assert np.any(np.all(np.abs(picture[..., :3] - np.array(colour) / 255) < 0.02, axis=-1))
