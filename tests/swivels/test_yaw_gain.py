"""Yaw rate over what the wheels ask for: closed forms against the simulator, and estimates against what was made."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from simulated_swivels import campaign, known, run

from ssmr_ident.core.parameter import Estimate, ParameterSet
from ssmr_ident.core.recording import Channel, Provenance, Recording
from ssmr_ident.doctor.swivels import diagnose_swivels
from ssmr_ident.doctor.swivels.yaw_gain import YawGain, yaw_gain
from ssmr_ident.experiments.campaign import Measurement
from ssmr_ident.experiments.swivel import swivel
from ssmr_ident.physics.motor import wheel_rates
from ssmr_ident.physics.robot import robot_from_parameters
from ssmr_ident.report.diagnosis_page import verdict
from ssmr_ident.session import Entry, read_parameters
from ssmr_ident.simulate.simulation import simulate

HALF_TRACK, HALF_BASE = 0.18, 0.14
PLAIN = YawGain(0.7, 0.69, 0.71, {}, HALF_TRACK, HALF_BASE)


def equal_axles(law: str, lambda_max: float) -> ParameterSet:
    x, y = HALF_BASE, HALF_TRACK
    points = np.array([[-x, y, -0.23], [x, y, -0.23], [x, -y, -0.23], [-x, -y, -0.23]])
    changes = {"contact_points_m": Estimate(points, None, "m"), "tire.lambda_max": Estimate(lambda_max)}
    robot = read_parameters("p3at-extended").updated(changes)
    return replace(robot.updated({"tire.mu_kinetic": robot["tire.mu_static"]}), choices={"tire.contact": law})


@pytest.mark.parametrize(("law", "lambda_max"), [("relay", 0.1), ("relay", 0.3), ("cone", 0.1)])
def test_gain_is_what_the_simulator_turns_at(law: str, lambda_max: float) -> None:
    robot = robot_from_parameters(equal_axles(law, lambda_max))
    asked = np.deg2rad(40.0)
    found = simulate(robot, swivel(wheel_rates(robot, 0.0, asked), 5.0), 200.0, 5e-4)["wz"][400:].mean() / asked
    expected = 1.0 - lambda_max * HALF_BASE / HALF_TRACK if law == "relay" else PLAIN.isotropic
    assert found == pytest.approx(expected, rel=0.05)
    if law == "relay":
        assert PLAIN.lambda_max(expected) == pytest.approx(lambda_max)


def test_starts_and_clocks_apart_leave_the_estimate_alone() -> None:
    """Wheels that start, turn and stop; a gyroscope whose clock is 0.4 s late; five recordings."""
    random = np.random.default_rng(3)
    parameters = read_parameters("p3at-extended")
    robot = robot_from_parameters(parameters)
    made = []
    for k, speed in enumerate((0.05, 0.08, -0.08, 0.15, 0.2)):
        slow, quick = np.arange(0.0, 14.0, 0.15), np.arange(0.0, 14.0, 0.01)

        def course(time: np.ndarray, speed: float = speed) -> np.ndarray:
            return speed * np.clip(np.minimum(time - 1.0, 12.0 - time), 0.0, 1.0)

        wheels = Recording(
            slow,
            (Channel("v_left", -course(slow), "m/s"), Channel("v_right", course(slow), "m/s")),
            Provenance("w", "", "test"),
        )
        rate = 0.72 * course(quick - 0.4) / robot.half_track + 0.01 * random.standard_normal(len(quick))
        gyro = Recording(quick, (Channel("wz", rate, "rad/s"),), Provenance("g", "", "test"))
        made.append(Measurement(Entry(f"{k}.csv", "swivel", wheel_speed_m_s=speed), gyro, wheels))
    found = yaw_gain(made, parameters)
    assert found is not None
    assert len(found.each) == 5
    assert found.gain == pytest.approx(0.72, abs=0.005)
    assert found.lower < 0.72 < found.upper
    assert found.upper - found.lower < 0.05
    assert found.sideways(found.gain) < 1.0
    assert "0.72" in str(found)
    assert yaw_gain([run(30, "target", {}, 1, 4.0)], parameters) is None  # no gyroscope


def test_tires_of_which_nothing_is_known_are_not_asked_what_shakes(tmp_path: Path) -> None:
    stiffness = [f"tire.stiffness_{axis}_N_m" for axis in "xyz"]
    vague = known().updated({path: replace(known()[path], std=None, fixed=False) for path in stiffness})
    found = diagnose_swivels(campaign(run(30, "target", {}, 1), run(50, "target", {}, 2)), vague)
    assert found.verdict == "undetermined"
    assert "stiffness" in found.summary
    assert "Pull the robot" in found.next_experiment
    assert verdict(found).sentence == found.summary
