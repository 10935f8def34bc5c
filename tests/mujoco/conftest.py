"""The robot as both engines see it; without the extra ``proof`` whatever runs MuJoCo skips."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from ssmr_ident.physics.robot import Robot, robot_from_parameters
from ssmr_ident.session import read_parameters


@pytest.fixture(scope="session")
def engine() -> object:
    """MuJoCo; skips what asks for it when it is not installed."""
    return pytest.importorskip("mujoco", reason="needs the extra proof")


@pytest.fixture(scope="session")
def robot() -> Robot:
    """The thesis' robot with Coulomb's law of friction (mu_k = mu_s), which both engines know, and no sensor lag."""
    robot = robot_from_parameters(read_parameters("p3at-extended"))
    sensor = replace(robot.accelerometer, bandwidth_hz=np.inf)
    return robot.with_changes(mu_kinetic=robot.mu_static, slip_coupling=0.0, accelerometer=sensor)


@pytest.fixture(scope="session")
def gripping(robot: Robot) -> Robot:
    """The same with wheels that never slide."""
    return robot.with_changes(mu_static=1e9, mu_kinetic=1e9)


@pytest.fixture(scope="session")
def even(robot: Robot) -> Robot:
    """Both axles equally far from the CoM, as chapter 5 puts it, so that the closed forms are short."""
    points = robot.contact_points.copy()
    points[:, 0] = np.sign(points[:, 0]) * 0.14
    return robot.with_changes(contact_points=points)
