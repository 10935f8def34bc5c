"""What thesis.md section 6 lists for pulls and swivels, as sign and order of each effect."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from ssmr_ident.experiments.pull import pull
from ssmr_ident.experiments.straight import straight
from ssmr_ident.experiments.swivel import swivel
from ssmr_ident.physics.motor import wheel_rates
from ssmr_ident.physics.robot import Robot, robot_from_parameters
from ssmr_ident.session import read_parameters
from ssmr_ident.simulate import Simulation, simulate


@pytest.fixture(scope="module")
def robot() -> Robot:
    return robot_from_parameters(read_parameters("p3at-extended"))


def _slope(result: Simulation, start: float, end: float) -> float:
    """N/m between two moments of a pull at 1 mm/s."""
    force, head, t = result["force"], result["head"], result.time
    part = (t >= start) & (t <= end)
    return float(np.polyfit(head[part], force[part], 1)[0])


def test_a_pull_is_a_saw_tooth(robot: Robot) -> None:
    force = simulate(robot, pull("lateral", 1.0, 16.0), 100.0)["force"][500:]
    drops = np.flatnonzero(np.diff(force) < -10.0)
    assert len(drops) > 5
    assert force.min() > 0.5 * robot.mu_kinetic * robot.mass * 9.8
    assert force.max() < 1.1 * robot.mu_static * robot.mass * 9.8


def test_ramp_slopes_lie_between_two_and_four_tires_with_the_height_of_the_cable(robot: Robot) -> None:
    slopes = [_slope(simulate(robot, pull("lateral", 1.0, 2.0, height=h), 100.0), 0.3, 1.5) for h in (0, 0.1, 0.2, 0.3)]
    stiffness = robot.stiffness[1]
    assert np.all(np.diff(slopes) < 0)
    assert 3.5 * stiffness < slopes[0] < 4.0 * stiffness
    assert 2.0 * stiffness < slopes[-1] < 2.6 * stiffness


def test_with_a_high_cable_two_wheels_let_go_before_the_others(robot: Robot) -> None:
    points = robot.contact_points.copy()
    points[:, 0] = np.sign(points[:, 0]) * 0.14  # chapter 5 puts a = b: both axles alike
    even = robot.with_changes(contact_points=points)
    low, high = (simulate(even, pull("lateral", 1.0, 8.0, height=h), 1000.0) for h in (0.0, 0.2))

    def spread(result: Simulation) -> float:
        loads = [result[f"load_{i}"][1000] for i in (1, 2, 3, 4)]
        return max(loads) - min(loads)

    assert spread(high) > 3.0 * spread(low) > 0.0
    first = high["sliding"][np.flatnonzero(high["sliding"])[0]]
    assert first == 2.0


def test_pulling_a_spinning_robot_takes_less_the_faster_it_slips(robot: Robot) -> None:
    def mean_force(slip: float, lambda_max: float = 0.1) -> float:
        spinning = replace(pull("lateral", 1.0, 12.0), held=True, wheel_rates=np.full((1, 2), slip / robot.radius))
        return float(simulate(replace(robot, lambda_max=lambda_max), spinning, 100.0)["force"][600:].mean())

    forces = [mean_force(slip) for slip in (0.0, 0.001, 0.003, 0.01, 0.04)]
    assert np.all(np.diff(forces) < 0)
    assert forces[-1] < 0.1 * forces[0]
    # lambda is 1 whatever lambda_max is: the wheels do not get anywhere
    assert mean_force(0.01, 1.0) == pytest.approx(mean_force(0.01, 0.01), rel=0.1)


def test_straight_on_lambda_max_hardly_matters(robot: Robot) -> None:
    ends = [
        simulate(replace(robot, lambda_max=value), straight(wheel_rates(robot, 0.3, 0.0), 6.0), 100.0)
        for value in (1.0, 0.1, 0.01)
    ]
    assert np.ptp([run["x"][-1] for run in ends]) < 0.01 * ends[0]["x"][-1]
    assert max(np.ptp(run["ay"][300:]) for run in ends) < 1e-3


def test_the_larger_lambda_max_the_slower_the_turn(robot: Robot) -> None:
    turned = [
        simulate(replace(robot, lambda_max=value), swivel(wheel_rates(robot, 0.0, 0.8), 8.0))["yaw"][-1]
        for value in (1.0, 0.1, 0.01)
    ]
    assert turned[0] < 0.8 * turned[1]
    assert turned[1] < 0.97 * turned[2]
    assert turned[2] < 0.8 * 8.0


@pytest.mark.parametrize("lambda_max", [0.1, 0.01])
def test_vertical_vibration_is_small(robot: Robot, lambda_max: float) -> None:
    result = simulate(replace(robot, lambda_max=lambda_max), swivel(wheel_rates(robot, 0.0, 0.35), 10.0))
    part = slice(3000, None)
    assert result["az"][part].std() < 0.5 * result["ay"][part].std()
