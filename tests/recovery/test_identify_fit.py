"""``ident fit`` on sessions made here in closed form: known parameters come back, the file is the same every time."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest
import yaml
from typer.testing import CliRunner

from ssmr_ident.cli import app
from ssmr_ident.core.errors import InputError
from ssmr_ident.identify.body.builder import HEIGHT, RobotBuilder
from ssmr_ident.identify.forces.pull_model import pull_stiffness
from ssmr_ident.physics.linear import linear_robot
from ssmr_ident.session import read_parameters, write_parameters
from ssmr_ident.workflows.fit.run import fit_session

STEP = 1e-3
TRUTH = {
    "mass_kg": 30.4,
    "inertia_kg_m2.xx": 1.13,
    "inertia_kg_m2.yy": 1.5,
    "inertia_kg_m2.zz": 0.96,
    "tire.stiffness_x_N_m": 3500.0,
    "tire.stiffness_y_N_m": 19200.0,
    "tire.stiffness_z_N_m": 74000.0,
    "tire.damping_x_N_s_m": 61.0,
    "tire.damping_y_N_s_m": 38.0,
    "tire.damping_z_N_s_m": 90.0,
    "tire.mu_static": 0.83,
    "tire.mu_kinetic": 0.83,
    HEIGHT: 0.233,
}


def known_robot(folder: Path):  # type: ignore[no-untyped-def]
    """The bundled robot's file with friction equal, and the robot that the recordings are made with."""
    parameters = read_parameters("p3at-extended")
    write_parameters(folder / "robot.yaml", parameters)
    return RobotBuilder.of(parameters)(TRUTH)


def release(robot, motion: str, rng: np.random.Generator) -> np.ndarray:  # type: ignore[no-untyped-def]
    """What the accelerometers read after a release, (4096, 3) m/s²: linear, exact, with noise and 60 Hz."""
    system = linear_robot(robot)
    start = np.zeros(12)
    start[{"roll": 3, "pitch": 4, "yaw": 5}[motion]] = rng.uniform(0.012, 0.025)
    values, vectors = np.linalg.eig(system.state_matrix)
    times = STEP * np.arange(4096)
    weights = np.linalg.solve(vectors, start.astype(complex))
    states = np.real((np.exp(np.outer(times, values)) * weights) @ vectors.T)
    accelerations = np.real((np.exp(np.outer(times, values)) * (weights * values)) @ vectors.T)[:, 6:]
    place = np.array([-0.2, 0.0, 0.0])
    reading = accelerations[:, :3] + np.cross(accelerations[:, 3:], place)
    reading[:, 0] -= 9.8 * states[:, 4]
    reading[:, 1] += 9.8 * states[:, 3]
    reading[:, 2] += 9.8
    hum = 0.1 * np.sin(2 * np.pi * 60.01 * times + rng.uniform(0, 6))
    return reading + hum[:, None] + 0.01 * rng.normal(size=reading.shape)


def write_session(folder: Path, rows: list[dict[str, object]], **extra: object) -> None:
    content = {
        "schema": "ssmr-ident/session/1",
        "name": "made-here",
        "robot": "robot.yaml",
        **extra,
        "recordings": rows,
    }
    (folder / "session.yaml").write_text(yaml.safe_dump(content, sort_keys=False))


def write_csv(path: Path, header: str, *columns: np.ndarray) -> None:
    np.savetxt(path, np.column_stack(columns), delimiter=",", header=header, comments="", fmt="%.9g")


@pytest.fixture(scope="module")
def robot_session(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("robot")
    robot = known_robot(folder)
    rng = np.random.default_rng(11)
    rows: list[dict[str, object]] = []
    for motion in ("roll", "pitch", "yaw"):
        for trial in (1, 2, 3):
            name = f"{motion}-{trial}.csv"
            data = release(robot, motion, rng)
            write_csv(folder / name, "time [s],ax [m/s^2],ay [m/s^2],az [m/s^2]", STEP * np.arange(len(data)), data)
            rows.append({"file": name, "experiment": "free_response", "motion": motion, "trial": trial})
    for direction, gripping in (("lateral", [1, 2, 3, 4]), ("longitudinal", [1, 2, 3, 4])):
        slope = pull_stiffness(robot, direction, 0.05, tuple(gripping))
        position = np.linspace(0, 1.5 * 0.83 * 30.4 * 9.8 / slope, 3000)
        force = np.minimum(slope * position, 0.83 * 30.4 * 9.8) + 0.7 * rng.normal(size=len(position))
        name = f"pull-{direction}.csv"
        write_csv(folder / name, "time [s],position [m],force [N]", 0.01 * np.arange(3000), position, force)
        rows.append(
            {
                "file": name,
                "experiment": "pull",
                "direction": direction,
                "speed_mm_s": 1.0,
                "height_m": 0.05,
                "wheels_gripping": gripping,
                "cable": "steel",
            }
        )
    write_session(folder, rows)
    return folder


@pytest.mark.slow
def test_robot_parameters_come_back(robot_session: Path) -> None:
    fit = fit_session(robot_session)
    for path, truth in TRUTH.items():
        if path == HEIGHT:
            estimate = fit.parameters["contact_points_m"]
            value = -float(np.asarray(estimate.value)[:, 2].mean())
        else:
            estimate = fit.parameters[path]
            value = float(estimate.value)
        assert estimate.std is not None
        assert abs(value - truth) < 3 * estimate.std, path
    informed = fit.parameters["tire.stiffness_x_N_m"]
    assert informed.source == "fit of the recordings"
    assert informed.std is not None
    assert informed.std < 0.1 * 600
    assert fit.parameters["inertia_kg_m2.yy"].source == "fit of the recordings"
    assert fit.parameters["tire.damping_z_N_s_m"].std < 0.2 * 35.0, "bounce and upper modes tell it"
    # These motions were made without friction; the simulator would slide, and the fit must say so and stay linear.
    assert any("as small motions on sticking tires" in text for text in fit.findings)
    text = str(fit)
    for part in ("[[Variables]]", "[[Findings]]", "f mean", "kg m^2", "pull-lateral.csv"):
        assert part in text
    assert not fit.conflicts


@pytest.mark.slow
def test_rope_is_told_from_the_tires(tmp_path: Path) -> None:
    """A rope of 6 kN/m in series (3.9): with a steel-cable pull beside it, both stiffnesses come out."""
    robot = known_robot(tmp_path)
    rng = np.random.default_rng(14)
    rows: list[dict[str, object]] = []
    for cable, stiffness in (("steel", robot.cable_stiffness), ("rope", 6000.0)):
        slope = pull_stiffness(robot, "lateral", 0.05, cable_stiffness=stiffness)
        position = np.linspace(0, 1.5 * 0.83 * 30.4 * 9.8 / slope, 2000)
        force = np.minimum(slope * position, 0.83 * 30.4 * 9.8) + 0.7 * rng.normal(size=len(position))
        write_csv(tmp_path / f"{cable}.csv", "time [s],position [m],force [N]", position * 1e3, position, force)
        row: dict[str, object] = {"file": f"{cable}.csv", "experiment": "pull", "direction": "lateral"}
        rows.append({**row, "speed_mm_s": 1.0, "height_m": 0.05, "cable": cable})
    write_session(tmp_path, rows)
    fit = fit_session(tmp_path)
    (sentence,) = [text for text in fit.findings if "rope stretches" in text]
    assert float(sentence.split()[3]) == pytest.approx(6000.0, rel=0.02)
    estimate = fit.parameters["tire.stiffness_y_N_m"]
    assert estimate.std is not None
    assert abs(float(estimate.value) - 19200.0) < 3 * estimate.std


@pytest.mark.slow
def test_command_writes_the_same_file_twice(robot_session: Path, tmp_path: Path) -> None:
    session = yaml.safe_load((robot_session / "session.yaml").read_text())
    few = [row for row in session["recordings"] if row["file"] in ("roll-1.csv", "pull-lateral.csv")]
    two_logs = robot_session / "two-logs.yaml"
    two_logs.write_text(yaml.safe_dump({**session, "recordings": few}, sort_keys=False))
    runner = CliRunner()
    for name in ("one.yaml", "two.yaml"):
        result = runner.invoke(app, ["fit", str(two_logs), "-o", str(tmp_path / name), "-q", "--seed", "3"])
        assert result.exit_code == 0, result.output
        assert result.output == ""
    assert (tmp_path / "one.yaml").read_bytes() == (tmp_path / "two.yaml").read_bytes()
    written = read_parameters(tmp_path / "one.yaml")
    assert written.provenance["seed"] == 3
    assert {row["file"] for row in written.provenance["files"]} >= {"roll-1.csv", "pull-lateral.csv"}
    assert all(len(row["sha256"]) == 64 for row in written.provenance["files"])
    shown = runner.invoke(app, ["fit", str(two_logs), "--json"])
    content = json.loads(shown.output)
    assert content["parameters"]["mass_kg"]["unit"] == "kg"
    assert {"omega_n_rad_s", "xi_std"} <= set(content["recordings"][0])


def test_missing_channel_names_file_and_mend(tmp_path: Path) -> None:
    known_robot(tmp_path)
    times = STEP * np.arange(500)
    write_csv(tmp_path / "roll.csv", "time [s],ax [m/s^2]", times, np.sin(times))
    write_session(tmp_path, [{"file": "roll.csv", "experiment": "free_response", "motion": "roll"}])
    with pytest.raises(InputError, match=r"roll\.csv.*ay.*Map the header"):
        fit_session(tmp_path)


def test_heldout_is_never_fitted(tmp_path: Path) -> None:
    known_robot(tmp_path)
    times = STEP * np.arange(500)
    write_csv(tmp_path / "roll.csv", "time [s],ay [m/s^2]", times, np.sin(times))
    row = {"file": "roll.csv", "experiment": "free_response", "motion": "roll", "role": "heldout"}
    write_session(tmp_path, [row])
    with pytest.raises(InputError, match="heldout"):
        fit_session(tmp_path)
