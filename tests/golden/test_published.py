"""The thesis' printed numbers: typed off right, and what follows from what."""

from __future__ import annotations

import csv
from pathlib import Path

import numpy as np
import pytest

from ssmr_ident.identify.body.tire_parameters import (
    Geometry,
    damping_as_printed,
    damping_ratio,
    natural_frequency,
    rotation_inertia,
)
from ssmr_ident.identify.forces.stiffness import belt_stiffness
from ssmr_ident.session import read_parameters


@pytest.fixture
def published(root: Path):
    """Rows of a published table, by file name."""

    def rows(name: str) -> list[dict[str, str]]:
        with (root / "data" / "published" / name).open(encoding="utf-8", newline="") as stream:
            return list(csv.DictReader(stream))

    return rows


def by_quantity(rows: list[dict[str, str]], column: str = "value") -> dict[str, float]:
    return {row["quantity"]: float(row[column]) for row in rows}


def test_every_row_names_its_place_in_the_thesis(root: Path) -> None:
    files = sorted((root / "data" / "published").glob("*.csv"))
    assert len(files) == 7
    for file in files:
        with file.open(encoding="utf-8", newline="") as stream:
            rows = list(csv.DictReader(stream))
        assert rows, file.name
        assert all(row["source"] and None not in row.values() for row in rows), file.name


@pytest.mark.parametrize("motion", ["roll", "pitch", "yaw"])
def test_table_5_2_has_its_own_mean_and_deviation_and_lies_on_the_grid(published, motion: str) -> None:
    rows = published("table-5-2.csv")
    peaks = np.array([float(row[f"{motion}_Hz"]) for row in rows if row["trial"].isdigit()])
    summary = {row["trial"]: float(row[f"{motion}_Hz"]) for row in rows if not row["trial"].isdigit()}
    assert len(peaks) == 8
    assert peaks.mean() == pytest.approx(summary["mean"], abs=5e-5)
    assert peaks.std(ddof=1) == pytest.approx(summary["std"], abs=5e-5)
    bins = peaks * 2048 / 1000
    np.testing.assert_allclose(bins, np.round(bins), atol=2e-4)  # printed to 4 decimals


def test_natural_frequencies_and_damping_ratios_follow_from_peaks_and_decay_rates(published) -> None:
    for row in published("modes-5-9.csv"):
        frequency, rate = float(row["frequency_Hz"]), float(row["decay_rate_1_s"])
        assert natural_frequency(frequency, rate) == pytest.approx(float(row["omega_n_rad_s"]), abs=1e-4)
        assert damping_ratio(frequency, rate) == pytest.approx(float(row["xi"]), abs=6e-5)


def test_inertias_of_5_10_follow_from_the_printed_inputs_but_not_its_dampings(published) -> None:
    printed = by_quantity(published("parameters-5-10.csv"))
    modes = published("modes-5-9.csv")
    natural, xi = (np.array([float(row[key]) for row in modes]) for key in ("omega_n_rad_s", "xi"))
    stiffness = np.array([printed[f"stiffness_{axis}"] for axis in "xyz"])
    geometry = Geometry(printed["height_h"], printed["half_track_c"], printed["half_wheelbase_a"])
    inertia = rotation_inertia(natural, stiffness, geometry)
    assert inertia[[0, 2]] == pytest.approx([printed["inertia_x"], printed["inertia_z"]], abs=0.005)
    # the printed I_y belongs to 19.50 rad/s, its printed natural frequency is 19.48
    assert inertia[1] == pytest.approx(19.873, abs=5e-4)
    assert np.sqrt(inertia[1] * natural[1] ** 2 / printed["inertia_y"]) == pytest.approx(19.50, abs=0.005)
    result = damping_as_printed(natural, xi, stiffness, geometry)
    # 1596 is printed, the printed inputs give 1590; 2284 and 4693 are printed, the inputs give -2516 twice
    assert result.damping[0] == pytest.approx(printed["damping_x"], rel=5e-3)
    products = inertia * natural * xi
    assert result.damping[1] == pytest.approx(
        (2 * products[2] - 4 * geometry.half_track**2 * result.damping[0]) / (4 * geometry.half_wheelbase**2)
    )
    assert result.damping[1:] == pytest.approx([-2516.4, -2516.4], abs=0.5)
    assert len(result.findings) == 2


def test_printed_inertia_is_far_from_the_cad_model_only_where_translation_is_coupled(published) -> None:
    cad = {row["element"]: float(row["cad_kg_m2"]) for row in published("inertia-5-1.csv")}
    printed = by_quantity(published("parameters-5-10.csv"))
    ratios = [printed[f"inertia_{axis}"] / cad[2 * axis] for axis in "xyz"]
    assert ratios == pytest.approx([8.1, 14.1, 1.05], abs=0.05)


def test_forces_belong_together(published) -> None:
    rows = published("forces-3-3.csv")
    low, high = by_quantity(rows, "low"), by_quantity(rows, "high")
    ramp = (low["longitudinal_ramp"] + high["longitudinal_ramp"]) / 2
    assert belt_stiffness(ramp) == low["belt_stiffness"]
    for floor in ("concrete", "carpet"):
        middle = (low[f"lateral_peak_{floor}"] + high[f"lateral_peak_{floor}"]) / 2 / low["platform_weight"]
        top = high[f"lateral_peak_{floor}"] / low["platform_weight"]
        assert middle - 0.005 < low[f"mu_static_{floor}"] <= top + 0.005
    assert low["lateral_stiffness_steel"] == (low["lateral_ramp_steel"] + high["lateral_ramp_steel"]) / 2
    assert low["tire_stiffness_y"] == (low["wheel_drag_ramp_low"] + low["wheel_drag_ramp_high"]) / 2
    # the flat of the spinning force over the weight is the least kinetic friction, within the printed digit
    for floor in ("concrete", "carpet"):
        least = low[f"mu_kinetic_min_{floor}"] * low["platform_weight"]
        assert low["spinning_force"] <= least <= high["spinning_force"]


def test_the_bundled_robot_has_the_published_numbers(published) -> None:
    robot = read_parameters("p3at-extended")
    for row in published("inertia-5-1.csv"):
        assert robot[f"inertia_kg_m2.{row['element']}"].value == float(row["cad_kg_m2"])
    points = [[float(row[f"{axis}_m"]) for axis in "xyz"] for row in published("table-5-1.csv")]
    np.testing.assert_array_equal(robot["contact_points_m"].value, points)
    damping = by_quantity(published("damping-6-5.csv"))
    for axis in "xyz":
        assert robot[f"tire.damping_{axis}_N_s_m"].value == damping[f"damping_{axis}"]
    taken = by_quantity(published("forces-3-3.csv"), "low")
    assert robot["tire.stiffness_x_N_m"].value == taken["belt_stiffness"]
    assert robot["tire.stiffness_y_N_m"].value == taken["tire_stiffness_y"]
    assert robot["tire.stiffness_z_N_m"].value == taken["tire_stiffness_z"]
    assert robot["tire.mu_static"].value == taken["mu_static_concrete"]
