"""Robots are built once for all recordings that ask for the same one."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from ssmr_ident.identify.body.builder import GAINS, HEIGHT, RobotBuilder
from ssmr_ident.physics.robot import Robot, robot_from_parameters
from ssmr_ident.session import read_parameters


@pytest.fixture
def nominal() -> Robot:
    robot = robot_from_parameters(read_parameters("p3at-extended"))
    return replace(robot, accelerometer=replace(robot.accelerometer, gain=np.array([1.0, 0.5, 1.0])))


def test_equal_robots_have_one_builder(nominal: Robot) -> None:
    again = replace(nominal, inertia=nominal.inertia.copy())
    assert RobotBuilder.once(again) is RobotBuilder.once(nominal)
    assert RobotBuilder.once(replace(nominal, mass=nominal.mass + 1.0)) is not RobotBuilder.once(nominal)


def test_what_axes_read_makes_no_other_robot(nominal: Robot) -> None:
    builder = RobotBuilder.once(nominal)
    values = {"mass_kg": 21.0, HEIGHT: 0.4}
    robot, read = builder.read(values)
    assert (robot.mass, robot.height) == (21.0, pytest.approx(0.4))
    np.testing.assert_array_equal(read, [1.0, 1.0, 1.0])
    other, read = builder.read({**values, GAINS[1]: 0.75})
    assert other is robot
    np.testing.assert_array_equal(read, [1.0, 1.5, 1.0])


def test_another_mapping_is_another_question(nominal: Robot) -> None:
    builder = RobotBuilder.once(nominal)
    masses = [builder.read({"mass_kg": 20.0 + k})[0].mass for k in range(600)]
    assert masses == [20.0 + k for k in range(600)]
    # the same numbers under other names
    assert builder({"inertia_kg_m2.xx": 3.0}).inertia[0, 0] == builder({"inertia_kg_m2.yy": 3.0}).inertia[1, 1] == 3.0
    assert builder({"inertia_kg_m2.xx": 3.0}).inertia[1, 1] == nominal.inertia[1, 1]
