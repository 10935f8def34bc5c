"""Planar kinematics and dynamics: round trips, centres of rotation, power, and the 6-DOF simulator's turns."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest

from ssmr_ident.core.errors import InputError
from ssmr_ident.experiments.straight import straight
from ssmr_ident.experiments.swivel import swivel
from ssmr_ident.physics import planar, planar_dynamics
from ssmr_ident.physics.motor import wheel_rates
from ssmr_ident.physics.robot import GRAVITY, Robot, robot_from_parameters
from ssmr_ident.physics.statics import rest_loads
from ssmr_ident.session import read_parameters
from ssmr_ident.simulate import simulate

RADIUS, HALF_TRACK = 0.111, 0.18


@pytest.fixture(scope="module")
def robot() -> Robot:
    return robot_from_parameters(read_parameters("p3at-extended"))


@pytest.mark.parametrize("slips", [(0.0, 0.0), (0.3, -0.2), (-0.9, 0.99)])
@pytest.mark.parametrize(("speed", "turning"), [(0.4, 0.0), (0.0, 1.0), (-0.3, 0.7)])
def test_2_11_and_its_inverse_make_a_round_trip(speed: float, turning: float, slips: tuple[float, float]) -> None:
    rates = planar.wheel_rates_for(speed, turning, np.array(slips), RADIUS, HALF_TRACK)
    assert planar.body_motion(rates, np.array(slips), RADIUS, HALF_TRACK) == pytest.approx([speed, turning], abs=1e-12)
    hubs = planar.hub_speeds(speed, turning, HALF_TRACK)
    assert [planar.slip(r, v, RADIUS) for r, v in zip(rates, hubs, strict=True)] == pytest.approx(slips, abs=1e-12)


def test_without_slip_it_is_the_motors_inversion(robot: Robot) -> None:
    found = planar.wheel_rates_for(0.2, 0.6, np.zeros(2), robot.radius, robot.half_track)
    assert found == pytest.approx(wheel_rates(robot, 0.2, 0.6))


def test_2_11_as_printed() -> None:
    """η = r/2·[[1−λ_L, 1−λ_R], [−(1−λ_L)/c, (1−λ_R)/c]]·(ω_L, ω_R)."""
    left, right, rates = 0.1, 0.4, np.array([2.0, 5.0])
    matrix = RADIUS / 2 * np.array([[1 - left, 1 - right], [-(1 - left) / HALF_TRACK, (1 - right) / HALF_TRACK]])
    assert planar.body_motion(rates, np.array([left, right]), RADIUS, HALF_TRACK) == pytest.approx(matrix @ rates)


def test_slip_is_clamped_on_both_sides_and_for_both_directions() -> None:
    assert planar.slip(3.0, 10.0, RADIUS) == -1.0
    assert planar.slip(3.0, -10.0, RADIUS) == 1.0
    assert planar.slip(-3.0, -3.0 * RADIUS, RADIUS) == 0.0
    assert planar.slip(-3.0, -1.5 * RADIUS, RADIUS) == pytest.approx(0.5)
    assert planar.slip(0.0, 0.0, RADIUS) == 0.0


def test_spinning_wheels_cannot_be_inverted() -> None:
    with pytest.raises(InputError, match="spinning"):
        planar.wheel_rates_for(0.1, 0.0, np.array([0.0, 1.0]), RADIUS, HALF_TRACK)


def test_centres_of_pure_rotation_and_of_straight_motion() -> None:
    turning = 0.8
    rates = np.array([-HALF_TRACK * turning, HALF_TRACK * turning]) / RADIUS
    centres = planar.rotation_centres(np.array([0.0, 0.0, turning]), rates, RADIUS)
    assert (centres.x, centres.body) == (0.0, 0.0)
    # without slip the treads turn about their own contacts
    assert (centres.left, centres.right) == pytest.approx((HALF_TRACK, -HALF_TRACK))
    ahead = planar.rotation_centres(np.array([0.5, 0.0, 0.0]), np.array([6.0, 6.0]), RADIUS)
    assert ahead.body == math.inf
    assert ahead.left == ahead.right == -math.inf  # the rims run ahead of the robot


def test_the_body_centre_stands_still_and_slip_moves_the_treads_outwards() -> None:
    velocity = np.array([0.3, -0.1, 0.9])
    rates = planar.wheel_rates_for(0.3, 0.9, np.array([0.2, 0.2]), RADIUS, HALF_TRACK)
    centres = planar.rotation_centres(velocity, rates, RADIUS)
    x, y, turning = centres.x, centres.body, velocity[2]
    assert velocity[0] - turning * y == pytest.approx(0.0, abs=1e-15)
    assert velocity[1] + turning * x == pytest.approx(0.0, abs=1e-15)
    # what the treads slip is the yaw rate times their distance from the centre
    hubs = planar.hub_speeds(0.3, 0.9, HALF_TRACK)
    for tread, hub, rate, side in zip((centres.left, centres.right), hubs, rates, (1, -1), strict=True):
        assert hub - RADIUS * rate == pytest.approx(turning * (tread - side * HALF_TRACK))


def test_world_velocity_keeps_length_and_goes_round() -> None:
    velocity = np.array([0.3, -0.4, 0.2])
    world = planar.world_velocity(velocity, math.pi / 2)
    assert world == pytest.approx([0.4, 0.3, 0.2])


def test_load_split_is_that_of_the_elastic_robot(robot: Robot) -> None:
    plane = planar_dynamics.planar_robot(robot)
    loads = planar_dynamics.load_split(plane)
    assert loads == pytest.approx(rest_loads(robot), rel=3e-3)
    assert loads.sum() == pytest.approx(robot.mass * GRAVITY)


def test_friction_laws() -> None:
    saturating, peaking = planar_dynamics.saturating_friction(0.8, 0.2), planar_dynamics.peaking_friction(0.8, 0.2)
    assert [saturating(s) for s in (0.0, 0.1, 0.2, 1.0)] == pytest.approx([0.0, 0.4, 0.8, 0.8])
    assert peaking(0.0) == 0.0
    slips = np.linspace(0.0, 1.0, 1001)
    curve = np.array([peaking(s) for s in slips])
    assert slips[np.argmax(curve)] == pytest.approx(0.2, abs=1e-3)
    assert curve.max() == pytest.approx(0.8)
    assert peaking(1e-4) == pytest.approx(2.0 * saturating(1e-4), rel=1e-4)  # twice as steep at the origin


@pytest.mark.parametrize(
    "law", [planar_dynamics.saturating_friction(0.8, 0.2), planar_dynamics.peaking_friction(0.7, 0.1)]
)
def test_power_of_the_motors_is_kinetic_energy_and_heat(law: planar_dynamics.FrictionLaw, robot: Robot) -> None:
    """d/dt(m v²/2 + I w²/2) = ΣF_x·rω − heat, and the floor never gives power."""
    plane = planar_dynamics.planar_robot(robot)
    random = np.random.default_rng(4)
    for _ in range(20):
        velocity, rates = random.normal(0, 0.4, 3), random.normal(0, 4.0, 2)
        rate = planar_dynamics.acceleration(plane, velocity, rates, law)
        growth = plane.mass * velocity[:2] @ rate[:2] + plane.yaw_inertia * velocity[2] * rate[2]
        forces = planar_dynamics.contact_forces(plane, velocity, rates, law)
        motors = float(forces[:, 0] @ (plane.radius * rates[[0, 0, 1, 1]]))
        heat = -float(np.sum(forces * planar_dynamics.sliding_velocities(plane, velocity, rates)))
        assert heat >= 0.0
        assert growth == pytest.approx(motors - heat, rel=1e-9, abs=1e-9)


def test_straight_on_it_ends_at_the_rolling_speed(robot: Robot) -> None:
    plane = planar_dynamics.planar_robot(robot)
    law = planar_dynamics.saturating_friction(0.8, 0.2)
    found = planar_dynamics.settle(plane, wheel_rates(robot, 0.3, 0.0), law)
    assert found == pytest.approx([0.3, 0.0, 0.0], abs=1e-4)
    end = simulate(robot, straight(wheel_rates(robot, 0.3, 0.0), 4.0), 100.0)["vx"][-1]
    assert found[0] == pytest.approx(end, rel=0.02)


@pytest.mark.parametrize("limit", [1.0, 0.1, 0.01])
def test_steady_turns_agree_with_the_six_degrees_of_freedom(robot: Robot, limit: float) -> None:
    """How fast they turn and about which point, in the simulator's mean over 10 s of stick-slip."""
    rates = wheel_rates(robot, 0.0, math.radians(64.0))
    law = planar_dynamics.saturating_friction(robot.mu_static, limit)
    _, left, turning = planar_dynamics.settle(planar_dynamics.planar_robot(robot), rates, law)
    result = simulate(robot.with_changes(lambda_max=limit), swivel(rates, 14.0))
    part = slice(4000, None)
    rate, sideways = float(result["wz"][part].mean()), float(result["vy"][part].mean())
    assert turning == pytest.approx(rate, rel=0.08)
    assert -left / turning == pytest.approx(-sideways / rate, abs=0.015)


@pytest.mark.slow
def test_the_larger_lambda_max_the_slower_the_turn_either_way_round(robot: Robot) -> None:
    plane = planar_dynamics.planar_robot(robot)
    for wanted in (0.8, -0.8):
        rates = wheel_rates(robot, 0.0, wanted)
        laws = [planar_dynamics.saturating_friction(robot.mu_static, limit) for limit in (1.0, 0.1, 0.01)]
        shares = [planar_dynamics.settle(plane, rates, law)[2] / wanted for law in laws]
        assert 0.4 < shares[0] < shares[1] < shares[2] < 1.0


def test_with_unequal_axles_only_an_unsaturated_grip_turns_about_the_middle(robot: Robot) -> None:
    """µ_y < µ grows with sideways speed and centres; saturated, the more loaded front axle holds, at x = b."""
    plane = planar_dynamics.planar_robot(robot)
    rates = wheel_rates(robot, 0.0, 1.0)

    def shift(kind: planar_dynamics.PlanarRobot, limit: float) -> float:
        _, left, turning = planar_dynamics.settle(kind, rates, planar_dynamics.saturating_friction(0.86, limit))
        return -left / turning

    assert abs(shift(plane, 1.0)) < 1e-3
    assert shift(plane, 0.001) == pytest.approx(plane.front, abs=2e-3)
    assert abs(shift(replace(plane, rear=0.14, front=0.14), 0.001)) < 1e-3
    # and with more weight behind, the rear axle holds
    assert shift(replace(plane, rear=0.13, front=0.15), 0.001) == pytest.approx(-0.13, abs=2e-3)
