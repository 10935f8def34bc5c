"""``ident geometry``: Table 5.1 and a hand-made tensor from a sheet of measurements."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from typer.testing import CliRunner

from ssmr_ident.cli import app
from ssmr_ident.core.errors import InputError
from ssmr_ident.identify.geometry.sheet import robot_geometry
from ssmr_ident.session import read_parameters
from ssmr_ident.session.yaml_file import load_mapping

TABLE_5_1 = [[-0.15, 0.18, -0.23], [0.13, 0.18, -0.23], [0.13, -0.18, -0.23], [-0.15, -0.18, -0.23]]
BY_HAND = {"xx": 1.13, "yy": 1.52, "zz": 0.91, "xy": 0.001, "xz": -0.04, "yz": -0.002}


@pytest.mark.slow
def test_example_gives_table_5_1_and_a_tensor_of_the_hand_made_kind(root: Path, tmp_path: Path) -> None:
    sheet = root / "docs" / "howto" / "measurements.yaml"
    result = CliRunner().invoke(app, ["geometry", str(sheet), "-o", str(tmp_path / "geometry.yaml")])
    assert result.exit_code == 0, result.output
    assert "kg m^2" in result.output
    found = read_parameters(tmp_path / "geometry.yaml")
    np.testing.assert_allclose(found["contact_points_m"].value, TABLE_5_1, atol=1e-5)
    assert found["contact_points_m"].std == pytest.approx(0.0019, rel=0.1)
    for axes, value in BY_HAND.items():
        assert float(found[f"inertia_kg_m2.{axes}"].value) == pytest.approx(value, abs=0.1), axes


def test_two_equal_balls_on_a_stick() -> None:
    """Each ball of mass m at ±l: I = 2 m l² about both other axes, std by error propagation."""
    balls = [
        {"mass_kg": 2.0, "place_m": [x, 0.0, 0.0], "inertia_kg_m2": [0.0, 0.0, 0.0], "place_std_m": 0.001}
        for x in (-0.5, 0.5)
    ]
    found = robot_geometry({"components": balls}, "sheet")
    assert found.inertia is not None
    assert found.inertia_std is not None
    np.testing.assert_allclose(np.diag(found.inertia), [0.0, 1.0, 1.0], atol=1e-12)
    # I = m d²/2 with the distance d = 1 m known to √2 mm
    assert found.inertia_std[2, 2] == pytest.approx(2.0 * 0.001 * np.sqrt(2.0), rel=0.05)


@pytest.mark.parametrize(
    ("sheet", "where"),
    [
        ({"weighings": {}}, "weighings"),
        ({"weighing": {"front_kg": 1.0, "rear_kg": 1.0, "std_kg": 0.1}}, "wheelbase_m"),
        ({"wheelbase_m": 0.3, "weighing": {"front_kg": "1", "rear_kg": 1.0, "std_kg": 0.1}}, "front_kg"),
        ({"components": [{"mass_kg": 1.0, "place_m": [0, 0]}]}, "place_m"),
        ({"name": "empty"}, "sheet"),
    ],
)
def test_wrong_sheets_name_the_key(sheet: dict[str, object], where: str) -> None:
    with pytest.raises(InputError, match=where):
        robot_geometry(sheet, "sheet")


def test_example_sheet_is_read_safely(root: Path) -> None:
    assert load_mapping(root / "docs" / "howto" / "measurements.yaml")["schema"] == "ssmr-ident/measurements/1"
