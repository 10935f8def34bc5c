"""Pulls between behind and sideways: how the force begins, against the matrices of small motions."""

from __future__ import annotations

import numpy as np
import pytest

from ssmr_ident.experiments.pull import pull
from ssmr_ident.physics.linear import linear_robot
from ssmr_ident.physics.robot import Robot, robot_from_parameters
from ssmr_ident.session import read_parameters
from ssmr_ident.simulate.simulation import simulate

HEIGHT = 0.05


@pytest.fixture(scope="module")
def robot() -> Robot:
    return robot_from_parameters(read_parameters("p3at-extended"))


def onset(robot: Robot, angle_deg: float) -> float:
    """Force over travel [N/m] of a hook at the edge, tires and cable in series, while every contact sticks."""
    angle = np.deg2rad(angle_deg)
    along = np.array([-np.cos(angle), np.sin(angle), 0.0])
    edges = np.array([-robot.contact_points[:, 0].min(), robot.half_track])
    hook = along * np.min(edges / np.maximum(np.abs(along[:2]), 1e-12)) + [0.0, 0.0, HEIGHT - robot.height]
    push = np.concatenate([along, np.cross(hook, along)])
    tires = push @ np.linalg.solve(linear_robot(robot).stiffness, push)
    return float(1.0 / (tires + 1.0 / robot.cable_stiffness))


@pytest.mark.parametrize("angle_deg", [0.0, 30.0, 65.0, 90.0])
def test_the_force_begins_with_tires_and_cable_in_series(robot: Robot, angle_deg: float) -> None:
    drawn = pull(speed_mm_s=0.5, duration=2.0, angle_deg=angle_deg, height=HEIGHT)
    force = simulate(robot, drawn, 1000.0)["force"]
    slope = np.polyfit(np.arange(1000) * 0.5e-6, force[1000:2000], 1)[0]
    assert slope == pytest.approx(onset(robot, angle_deg), rel=0.01)


def test_straight_behind_and_sideways_are_the_named_directions(robot: Robot) -> None:
    for name, angle_deg in (("longitudinal", 0.0), ("lateral", 90.0)):
        named, told = (
            simulate(robot, pull(duration=1.0, **how), 200.0)["force"]
            for how in ({"direction": name}, {"angle_deg": angle_deg})
        )
        np.testing.assert_allclose(told, named, rtol=1e-6, atol=1e-9)
