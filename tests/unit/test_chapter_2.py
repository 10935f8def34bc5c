"""Chapter 2: constraint, reduced model, axis of rotation, torques and energy, each against a law of its own."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from ssmr_ident.experiments.swivel import swivel
from ssmr_ident.physics import constrained
from ssmr_ident.physics.drive import drive_matrix, motor_torques, torques_for
from ssmr_ident.physics.motor import wheel_rates
from ssmr_ident.physics.planar import rotation_centres, world_velocity
from ssmr_ident.physics.robot import Robot, robot_from_parameters
from ssmr_ident.physics.screw import screw_axis
from ssmr_ident.session import read_parameters
from ssmr_ident.simulate.energy import body_energy, floor_power
from ssmr_ident.simulate.simulation import simulate


@pytest.fixture(scope="module")
def robot() -> Robot:
    return robot_from_parameters(read_parameters("p3at-extended"))


@pytest.mark.parametrize("heading", [0.0, 0.7, -2.5])
def test_what_is_free_meets_the_constraint(heading: float) -> None:
    directions = constrained.free_directions(heading, 0.05)
    assert constrained.constraint(heading, 0.05) @ directions == pytest.approx(np.zeros((1, 2)), abs=1e-15)
    ahead, forward, turning = 0.05, 0.3, 0.8
    expected = world_velocity(np.array([forward, -ahead * turning, turning]), heading)
    assert directions @ [forward, turning] == pytest.approx(expected)
    step = 1e-6
    change = (constrained.free_directions(heading + turning * step, ahead) - directions) / step
    assert constrained.free_directions_rate(heading, ahead, turning) == pytest.approx(change, abs=1e-5)


def test_the_reduced_model_is_the_full_one_with_the_constraint_as_a_stiff_spring() -> None:
    """Newton's equations of a sledge whose runner x_0 ahead is kept from skidding by a viscous force of 1e5 N s/m."""
    mass, inertia, ahead, wrench = 30.0, 0.9, 0.05, np.array([6.0, 0.0, 0.4])

    def reduced(_: float, motion: np.ndarray) -> np.ndarray:
        return constrained.reduced_acceleration(mass, inertia, ahead, motion, wrench)

    def full(_: float, v: np.ndarray) -> list[float]:
        hold = -1e5 * (v[1] + ahead * v[2])
        return [
            wrench[0] / mass + v[2] * v[1],
            (wrench[1] + hold) / mass - v[2] * v[0],
            (wrench[2] + ahead * hold) / inertia,
        ]

    begin = np.array([0.2, 0.5])
    short = solve_ivp(reduced, (0.0, 2.0), begin, rtol=1e-10, atol=1e-12).y[:, -1]
    whole = solve_ivp(full, (0.0, 2.0), [begin[0], -ahead * begin[1], begin[1]], "Radau", rtol=1e-8, atol=1e-10)
    end = whole.y[:, -1]
    assert short == pytest.approx([end[0], end[2]], rel=1e-3)
    hold = -1e5 * (end[1] + ahead * end[2])
    assert constrained.constraint_force(mass, inertia, ahead, short, wrench) == pytest.approx(hold, rel=5e-3)


def test_the_axis_of_rotation_in_three_dimensions() -> None:
    random = np.random.default_rng(5)
    for _ in range(20):
        velocity, rates = random.normal(size=3), random.normal(size=3)
        axis = screw_axis(velocity, rates)
        there = velocity + np.cross(rates, axis.point)
        assert np.cross(there, rates) == pytest.approx(np.zeros(3), abs=1e-12)
        assert there == pytest.approx(axis.pitch * rates)
        assert axis.point @ rates == pytest.approx(0.0, abs=1e-12)
    plane = rotation_centres(np.array([0.3, -0.1, 0.9]), np.array([1.0, 4.0]), 0.111)
    axis = screw_axis(np.array([0.3, -0.1, 0.0]), np.array([0.0, 0.0, 0.9]))
    assert axis.point == pytest.approx([plane.x, plane.body, 0.0])
    assert screw_axis(np.array([0.0, 2.0, 0.0]), np.zeros(3)).direction == pytest.approx([0.0, 1.0, 0.0])


def test_torques_and_back(robot: Robot) -> None:
    left = robot.contact_points[:, 1] > 0
    forces = np.array([3.0, -1.0, 4.0, 2.0])
    torques = motor_torques(forces, left, robot.radius)
    pushed = drive_matrix(robot.radius, robot.half_track) @ torques
    assert pushed[0] == pytest.approx(forces.sum())
    assert pushed[5] == pytest.approx(-robot.contact_points[:, 1] @ forces)
    assert torques_for(pushed[0], pushed[5], robot.radius, robot.half_track) == pytest.approx(torques)
    # no power is lost between motors and floor while nothing slips
    rates = wheel_rates(robot, 0.3, 0.5)
    assert torques @ rates == pytest.approx(pushed[0] * 0.3 + pushed[5] * 0.5)


@pytest.mark.slow
def test_what_the_floor_does_on_the_body_is_its_energy(robot: Robot) -> None:
    """The work of all wheel forces, which the simulator logs, is the change of ½VᵀMV + mgz, which its poses give."""
    run = simulate(robot, swivel(wheel_rates(robot, 0.0, 1.2), 1.5), 5000.0, step=1e-4)
    energy, power = body_energy(robot, run), floor_power(robot, run)
    work = np.concatenate([[0.0], np.cumsum(0.5 * (power[1:] + power[:-1]) / 5000.0)])
    turned = 0.5 * robot.inertia[2, 2] * run["wz"][-1] ** 2
    assert energy - energy[0] == pytest.approx(work, abs=0.03 * turned)
    assert energy[-1] - energy[0] > 0.5 * turned
