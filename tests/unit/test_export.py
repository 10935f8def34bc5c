"""Parameters and logs in other tools' files read back to the same numbers."""

from __future__ import annotations

import csv
import io
import xml.etree.ElementTree as ET
from pathlib import Path

import numpy as np
import pytest
from scipy.io import loadmat

from ssmr_ident.core.errors import InputError
from ssmr_ident.core.parameter import Estimate
from ssmr_ident.core.recording import Channel, Provenance, Recording
from ssmr_ident.readers import read
from ssmr_ident.session import read_parameters
from ssmr_ident.workflows.export import parameters_as, write_recording_as

ROBOT = read_parameters("p3at-extended")


@pytest.fixture
def log() -> Recording:
    time = np.arange(50) / 200.0
    channels = (Channel("force", np.sin(9.0 * time), "N"), Channel("position", np.cos(9.0 * time), "m"))
    return Recording(time, channels, Provenance("log.csv", "", "csv"))


def test_csv_holds_every_number_to_the_last_bit() -> None:
    rows = {row["parameter"]: row for row in csv.DictReader(io.StringIO(parameters_as(ROBOT, "csv").decode()))}
    assert float(rows["mass_kg"]["value"]) == ROBOT.number("mass_kg")
    points = np.array([[float(rows[f"contact_points_m[{i},{k}]"]["value"]) for k in range(3)] for i in range(4)])
    np.testing.assert_array_equal(points, ROBOT["contact_points_m"].value)


def test_matlab_reads_blocks_as_structs() -> None:
    found = loadmat(io.BytesIO(parameters_as(ROBOT, "mat")), simplify_cells=True)["parameters"]
    assert found["tire"]["stiffness_y_N_m"]["value"] == ROBOT.number("tire.stiffness_y_N_m")
    assert found["tire"]["stiffness_y_N_m"]["unit"] == "N/m"


def test_urdf_holds_mass_inertia_and_wheels_and_says_what_it_cannot() -> None:
    text = parameters_as(ROBOT, "urdf").decode()
    root = ET.fromstring(text)
    assert float(root.find("link/inertial/mass").get("value")) == ROBOT.number("mass_kg")
    assert len(root.findall("joint")) == 4
    assert "tire.stiffness_y_N_m" in text.split("-->")[0]


def test_what_mjcf_cannot_hold_is_a_comment() -> None:
    known = ROBOT.updated({}, effects={"quadratic_damping": {"d2_N_s2_m2": Estimate(500.0, 20.0, "N s^2/m^2")}})
    comment = parameters_as(known, "mjcf").decode().split("-->")[0]
    assert "quadratic_damping.d2_N_s2_m2" in comment
    assert "tire.stiffness_y_N_m" not in comment


def test_a_log_comes_back_from_parquet_and_matlab(log: Recording, tmp_path: Path) -> None:
    pandas = pytest.importorskip("pandas")
    frame = pandas.read_parquet(write_recording_as(tmp_path / "log.parquet", log, "parquet"))
    np.testing.assert_array_equal(frame.force, log["force"])
    held = loadmat(write_recording_as(tmp_path / "log.mat", log, "mat"), simplify_cells=True)
    np.testing.assert_array_equal(held["position"], log["position"])
    assert held["units"]["force"] == "N"


def test_a_log_comes_back_from_a_universal_file(log: Recording, tmp_path: Path) -> None:
    pyuff = pytest.importorskip("pyuff")
    sets = pyuff.UFF(str(write_recording_as(tmp_path / "log.uff", log, "uff"))).read_sets()
    np.testing.assert_allclose(sets[0]["data"], log["force"], rtol=1e-9, atol=1e-12)
    assert sets[1]["abscissa_inc"] == pytest.approx(1 / 200.0)


@pytest.mark.parametrize("form", ["parquet", "mat", "uff"])
def test_what_is_written_is_read_again(log: Recording, tmp_path: Path, form: str) -> None:
    pytest.importorskip({"parquet": "pyarrow", "mat": "scipy", "uff": "pyuff"}[form])
    (again,) = read(write_recording_as(tmp_path / f"log.{form}", log, form))
    assert {c.name: c.unit for c in again.channels} == {c.name: c.unit for c in log.channels}
    np.testing.assert_allclose(again["force"], log["force"], rtol=1e-9, atol=1e-12)
    np.testing.assert_allclose(again.time, log.time, atol=1e-9)


def test_uneven_stamps_are_no_universal_file(log: Recording, tmp_path: Path) -> None:
    pytest.importorskip("pyuff")
    uneven = Recording(log.time**1.1, log.channels, log.provenance)
    with pytest.raises(InputError, match="not sampled evenly"):
        write_recording_as(tmp_path / "log.uff", uneven, "uff")
