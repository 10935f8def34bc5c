"""Tires whose slope changes beyond a knee, pressed upright: against two straight lines."""

from __future__ import annotations

import numpy as np
import pytest

from ssmr_ident.physics.robot import Robot, robot_from_parameters
from ssmr_ident.session import read_parameters
from ssmr_ident.simulate.bench import compress_wheel

SHARE = 0.4


@pytest.fixture(scope="module")
def robot() -> Robot:
    return robot_from_parameters(read_parameters("p3at-extended"))


def _law(knee: float) -> dict[str, dict[str, float]]:
    return {"nonlinear_stiffness": {"k3_N_m3": 0.0, "knee_share": SHARE, "knee_m": knee}}


def test_a_compressed_wheel_is_two_straight_lines(robot: Robot) -> None:
    speed, step, knee = 1e-3, 1e-2, 1.2e-3
    depth = speed * step * np.arange(300)
    force = compress_wheel(robot, depth, step, effects=_law(knee))[1:-1]
    stiffness, damping = robot.stiffness[2], robot.damping[2]
    inside = stiffness * depth[1:-1] + damping * speed
    assert force == pytest.approx(inside + SHARE * stiffness * np.maximum(depth[1:-1] - knee, 0.0), rel=1e-9)
