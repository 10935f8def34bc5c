"""A file that gives static and kinetic friction the same number has one unknown for both."""

from __future__ import annotations

import pytest

from ssmr_ident.core.parameter import Estimate, ParameterSet
from ssmr_ident.diagnose.setup import twin
from ssmr_ident.identify.body.builder import RobotBuilder
from ssmr_ident.physics.robot import Robot, robot_from_parameters
from ssmr_ident.session import read_parameters


@pytest.fixture(scope="module")
def robot() -> Robot:
    return robot_from_parameters(read_parameters("p3at-extended"))


def test_equal_coefficients_move_together(robot: Robot) -> None:
    one = robot.with_changes(mu_static=0.8, mu_kinetic=0.8)
    moved = RobotBuilder(one)({"tire.mu_static": 0.7})
    assert moved.mu_kinetic == moved.mu_static == 0.7
    apart = RobotBuilder(one)({"tire.mu_static": 0.7, "tire.mu_kinetic": 0.6})
    assert (apart.mu_static, apart.mu_kinetic) == (0.7, 0.6)


def test_different_coefficients_stay_two(robot: Robot) -> None:
    two = robot.with_changes(mu_static=0.8, mu_kinetic=0.75)
    assert RobotBuilder(two)({"tire.mu_static": 0.7}).mu_kinetic == 0.75


@pytest.mark.parametrize(
    ("kinetic", "fixed", "found"), [(0.8, False, "tire.mu_static"), (0.7, False, None), (0.8, True, None)]
)
def test_a_fixed_or_different_kinetic_friction_is_its_own(kinetic: float, fixed: bool, found: str | None) -> None:
    known = ParameterSet(
        "robot",
        {"tire.mu_static": Estimate(0.8, 0.04), "tire.mu_kinetic": Estimate(kinetic, 0.04, fixed=fixed)},
    )
    assert twin("tire.mu_kinetic", known) == found
    assert twin("tire.mu_static", known) is None
