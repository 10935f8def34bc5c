"""Pulls in both engines: ramps, loads and the final plateau within 1 %."""

from __future__ import annotations

import numpy as np
import pytest

from ssmr_ident.experiments.pull import pull
from ssmr_ident.physics.robot import GRAVITY, Robot
from ssmr_ident.simulate import Simulation, simulate
from ssmr_ident.simulate.mjcf.build import Build, Cable
from ssmr_proof.mujoco_run import MujocoRun, run_mujoco

pytestmark = [pytest.mark.slow, pytest.mark.usefixtures("engine")]


def _cable(robot: Robot, direction: str, height: float, speed_mm_s: float) -> Cable:
    return Cable(direction, height, speed_mm_s * 1e-3, robot.cable_stiffness, robot.cable_damping)


def _slope(run: Simulation | MujocoRun, speed_mm_s: float, start: float, end: float) -> float:
    part = (run.time > start) & (run.time < end)
    return float(np.polyfit(speed_mm_s * 1e-3 * run.time[part], run["force"][part], 1)[0])


@pytest.mark.parametrize("height", [0.0, 0.1, 0.2, 0.3])
@pytest.mark.parametrize(("direction", "speed"), [("lateral", 1.0), ("longitudinal", 5.0)])
def test_ramps_have_the_same_slope_and_the_same_loads(
    gripping: Robot, direction: str, speed: float, height: float
) -> None:
    ours = simulate(gripping, pull(direction, speed, 2.0, height=height), 100.0, 1e-4)
    build = Build(friction="grip", wheel_mass=0.01)
    theirs = run_mujoco(gripping, 2.0, build, sample_rate=100.0, cable=_cable(gripping, direction, height, speed))
    # from 0.8 s on the start of the head has died out
    assert _slope(theirs, speed, 0.8, 1.8) == pytest.approx(_slope(ours, speed, 0.8, 1.8), rel=0.01)
    for wheel in (1, 2, 3, 4):
        change = np.ptp(ours[f"load_{wheel}"])
        difference = theirs[f"load_{wheel}"][-1] - ours[f"load_{wheel}"][-1]
        # the plate's own 0.1 N hangs below the spring
        assert abs(difference) < 0.01 * max(change, 10.0) + 0.01 * GRAVITY


@pytest.mark.parametrize("height", [0.0, 0.1])
def test_a_sliding_robot_pulls_with_mu_m_g(robot: Robot, height: float) -> None:
    """Both engines against Coulomb, and so against each other."""
    weight = robot.mu_static * robot.mass * GRAVITY
    ours = simulate(robot, pull("lateral", 1.0, 10.0, height=height), 1000.0, 1e-4)
    build = Build(tires="strut", friction="cone")
    theirs = run_mujoco(robot, 10.0, build, cable=_cable(robot, "lateral", height, 1.0))
    for run in (ours, theirs):
        assert run["force"][9000:].mean() == pytest.approx(weight, rel=0.01)
    assert theirs["force"][9000:].mean() == pytest.approx(ours["force"][9000:].mean(), rel=0.01)


def test_with_a_high_cable_the_same_two_wheels_let_go_first(even: Robot) -> None:
    """The far side, relieved by the pull, slides before the near side in both engines."""
    ours = simulate(even, pull("lateral", 1.0, 5.0, height=0.2), 1000.0, 1e-4)
    build = Build(tires="strut", friction="cone")
    theirs = run_mujoco(even, 5.0, build, cable=_cable(even, "lateral", 0.2, 1.0))
    first = int(np.flatnonzero(ours["sliding"])[0])
    assert ours["sliding"][first] == 2.0
    shares = {}
    for wheel in (1, 2, 3, 4):
        share = -theirs[f"tire_y_{wheel}"] / (even.mu_static * theirs[f"load_{wheel}"])
        shares[wheel] = share[first]
    assert min(shares[3], shares[4]) > 0.97
    assert max(shares[1], shares[2]) < 0.80
