"""The simulator over a grid: what may be swept, what is written, and that nothing is done twice."""

from __future__ import annotations

import csv
import json
import multiprocessing
import time
from pathlib import Path

import numpy as np
import pytest

from ssmr_ident.core.errors import InputError
from ssmr_ident.experiments import SWIVEL, Conditions, Scenario
from ssmr_ident.physics.planar import slip
from ssmr_ident.physics.robot import robot_from_parameters
from ssmr_ident.readers import ReadOptions, read_one
from ssmr_ident.session import read_parameters
from ssmr_ident.simulate.layout import OUTPUTS
from ssmr_ident.simulate.simulation import Simulation
from ssmr_ident.simulate.slips import wheel_slips
from ssmr_ident.workflows.simulate.request import Request
from ssmr_ident.workflows.sweep import run as running
from ssmr_ident.workflows.sweep.axes import axis_of
from ssmr_ident.workflows.sweep.files import write
from ssmr_ident.workflows.sweep.processes import side_by_side
from ssmr_ident.workflows.sweep.run import points_of, sweep

SHORT = Request(SWIVEL, Conditions(yaw_rate_deg_s=60.0), duration_s=0.5)


def test_what_may_be_swept() -> None:
    assert axis_of("lambda_max=0.2:1:9").values == pytest.approx(np.linspace(0.2, 1.0, 9))
    assert axis_of("lambda_max=1e-4:1:5:log").values == pytest.approx([1e-4, 1e-3, 1e-2, 0.1, 1.0])
    assert axis_of("tire.damping_y_N_s_m=10,30").target == axis_of("damping_y_N_s_m=1:2:2").target
    assert axis_of("wheel_eccentricity.eccentricity_m=1e-3").target == "wheel_eccentricity.eccentricity_m"
    assert axis_of("yaw_rate_deg_s=10,20").label == "yaw_rate_deg_s [deg/s]"


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("lambda_mx=1", "lambda_max"),
        ("lambda_max", "NAME=VALUES"),
        ("lambda_max=a,b", "no numbers"),
        ("lambda_max=0:1:3:log", "no numbers"),
        ("lambda_max=-1", "expected a finite number"),
        ("floor=ice", "not known"),
        ("xx_nothing=1", "nothing that can be swept"),
    ],
)
def test_a_wrong_axis_says_what_is_wrong(text: str, words: str) -> None:
    with pytest.raises(InputError, match=words):
        axis_of(text)


def test_a_grid_puts_every_value_where_it_belongs() -> None:
    axes = [axis_of("lambda_max=0.1,0.2"), axis_of("floor=carpet"), axis_of("robot=p3at-extended,p3at-platform")]
    points = points_of("p3at-extended", axes, SHORT)
    assert [(p.values[0], p.values[2]) for p in points[:3]] == [
        (0.1, "p3at-extended"), (0.1, "p3at-platform"), (0.2, "p3at-extended")
    ]  # fmt: skip
    robots = [robot_from_parameters(point.parameters) for point in points]
    assert [robot.lambda_max for robot in robots] == [0.1, 0.1, 0.2, 0.2]
    assert robots[0].mass > robots[1].mass
    assert {robot.mu_static for robot in robots} == {0.98}
    own = read_parameters("p3at-extended")
    ratio = own.number("tire.mu_kinetic") / own.number("tire.mu_static")
    assert robots[0].mu_kinetic / robots[0].mu_static == pytest.approx(ratio)
    with pytest.raises(InputError, match="twice"):
        points_of("p3at-extended", [axes[0], axis_of("tire.lambda_max=1")], SHORT)


def test_slips_are_those_of_the_plane_on_a_level_robot() -> None:
    robot = robot_from_parameters(read_parameters("p3at-extended"))
    values = np.zeros((3, len(OUTPUTS)))
    moving = {
        "vx": [0.2, 0.0, 0.1],
        "wz": [0.5, -1.0, 0.0],
        "rate_left": [1.0, 2.0, 0.0],
        "rate_right": [3.0, -2.0, 0.0],
    }
    for name, course in moving.items():
        values[:, OUTPUTS.index(name)] = course
    found = wheel_slips(robot, Simulation(np.arange(3.0), values, OUTPUTS, Scenario("swivel", 3.0), 1e-3))
    for row in range(3):
        for wheel, (_, across, _) in enumerate(robot.contact_points):
            rate = moving["rate_left" if across > 0 else "rate_right"][row]
            hub = moving["vx"][row] - moving["wz"][row] * across
            assert found[row, wheel] == pytest.approx(slip(rate, hub, robot.radius))


@pytest.mark.slow
def test_a_sweep_writes_everything_once(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    axes = [axis_of("lambda_max=0.5,1")]
    points = points_of("p3at-extended", axes, SHORT, repeats=2)
    told: list[tuple[int, int]] = []
    found = sweep(axes, points, tmp_path, workers=1, progress=lambda done, total: told.append((done, total)))
    assert told[0] == (0, 4)
    assert told[-1] == (4, 4)
    assert found.reused == 0
    log = read_one(str(tmp_path / found.rows[0]["file"]), ReadOptions())
    wanted = {"ax", "wz", "rate_left", "load_4", "force_x_1", "force_y_3", "slip_2 [1]", "vy", "yaw"}
    assert wanted <= {channel.label or channel.name for channel in log.channels} | set(log.names)
    # forces on the wheels are what moves the robot, and loads carry it
    robot = robot_from_parameters(points[0].parameters)
    text = np.genfromtxt(tmp_path / found.rows[0]["file"], delimiter=",", names=True, deletechars="", replace_space="_")
    names = {name.split("_[")[0]: name for name in text.dtype.names or ()}
    push = sum(text[names[f"force_y_{wheel}"]] for wheel in (1, 2, 3, 4))
    speed = text[names["vy"]]
    assert np.trapezoid(push, dx=1e-3) / robot.mass == pytest.approx(speed[-1] - speed[0], abs=2e-3)
    # chaos: repeats differ, and only by what they are begun apart
    assert found.rows[0]["ay_amplitude_m_s2"] != found.rows[1]["ay_amplitude_m_s2"]
    files = write(found, tmp_path)
    assert {file.name for file in files} == {"sweep.csv", "spectra.png", "peaks.png", "amplitudes.png"}
    with (tmp_path / "sweep.csv").open(encoding="utf-8", newline="") as stream:
        rows = list(csv.DictReader(stream))
    assert [float(row["lambda_max"]) for row in rows] == [0.5, 0.5, 1.0, 1.0]
    assert float(rows[0]["az_amplitude_m_s2"]) == found.rows[0]["az_amplitude_m_s2"]

    # one is lost, one is of another robot: those two are done again
    (tmp_path / "runs" / f"{points[1].name}.csv").unlink()
    other = tmp_path / "runs" / f"{points[2].name}.json"
    other.write_text(json.dumps({**json.loads(other.read_text(encoding="utf-8")), "digest": "else"}), encoding="utf-8")
    done: list[str] = []
    real = running.run_point
    monkeypatch.setattr(running, "run_point", lambda folder, point: done.append(point.name) or real(folder, point))
    again = sweep(axes, points, tmp_path, workers=1)
    assert done == [points[1].name, points[2].name]
    assert again.rows == found.rows


def _interrupted(begun: Path) -> None:
    with side_by_side(2, ()) as submit:
        submit(begun.touch)
        submit(time.sleep, 600.0)
        submit(time.sleep, 600.0)
        while not begun.exists():
            time.sleep(0.05)
        raise KeyboardInterrupt


@pytest.mark.slow
def test_processes_that_nobody_waits_for_are_ended(tmp_path: Path) -> None:
    """Whatever they are at, and none is left behind."""
    with pytest.raises(KeyboardInterrupt):
        _interrupted(tmp_path / "begun")
    assert not multiprocessing.active_children()
