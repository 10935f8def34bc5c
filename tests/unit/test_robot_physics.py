"""The 6-DOF simulator against laws that share no code with it."""

from __future__ import annotations

import itertools
from dataclasses import replace

import numpy as np
import pytest
from scipy.linalg import expm
from scipy.optimize import brentq

from ssmr_ident.core.errors import SimulationError
from ssmr_ident.experiments import Scenario
from ssmr_ident.experiments.pull import pull
from ssmr_ident.experiments.swivel import swivel
from ssmr_ident.physics.linear import linear_robot
from ssmr_ident.physics.motor import wheel_rates
from ssmr_ident.physics.robot import GRAVITY, Robot, robot_from_parameters
from ssmr_ident.physics.slots import effect_vector
from ssmr_ident.physics.statics import rest_loads, rest_pose
from ssmr_ident.physics.tire import contact_force, release_share
from ssmr_ident.session import read_parameters
from ssmr_ident.simulate import simulate
from ssmr_ident.simulate.step import choose_step

NAMES = ("x", "y", "z", "roll", "pitch", "yaw")
START = dict(zip(NAMES, np.array([1e-4, -5e-5, 2e-5, 1e-4, 2e-4, 1e-4]), strict=True))


@pytest.fixture(scope="module")
def robot() -> Robot:
    return robot_from_parameters(read_parameters("p3at-extended"))


def _gripping(robot: Robot, **changes: object) -> Robot:
    return robot.with_changes(mu_static=1e9, mu_kinetic=1e9, **changes)


def _energy(robot: Robot, result: object) -> np.ndarray:
    """Kinetic, elastic and potential energy from the stored states alone, per sample [J]."""
    s = result
    pose = np.column_stack([s["x"], s["y"], s["z"], s["roll"], s["pitch"], s["yaw"]])
    rate = 1.0 / (s.time[1] - s.time[0])
    velocity = np.gradient(pose[:, :3], 1.0 / rate, axis=0, edge_order=2)
    omega = np.column_stack([s["wx"], s["wy"], s["wz"]])
    kinetic = 0.5 * robot.mass * (velocity**2).sum(1) + 0.5 * np.einsum("ni,ij,nj->n", omega, robot.inertia, omega)
    height, roll0, pitch0 = rest_pose(robot)
    elastic = np.zeros(len(pose))
    for point in robot.contact_points:
        set_down = _world(np.array([0, 0, height, roll0, pitch0, 0.0]), point)
        now = np.array([_world(q, point) for q in pose])
        slip = now[:, :2] - set_down[:2]
        cos, sin = np.cos(pose[:, 5]), np.sin(pose[:, 5])
        along, across = cos * slip[:, 0] + sin * slip[:, 1], -sin * slip[:, 0] + cos * slip[:, 1]
        stiffness = robot.stiffness
        elastic += 0.5 * (stiffness[0] * along**2 + stiffness[1] * across**2 + stiffness[2] * now[:, 2] ** 2)
    return kinetic + elastic + robot.mass * GRAVITY * pose[:, 2]


def _world(pose: np.ndarray, point: np.ndarray) -> np.ndarray:
    """Contact point in the world by matrix products of single rotations, written out independently."""
    x, y, z, roll, pitch, yaw = pose
    rx = np.array([[1, 0, 0], [0, np.cos(roll), -np.sin(roll)], [0, np.sin(roll), np.cos(roll)]])
    ry = np.array([[np.cos(pitch), 0, np.sin(pitch)], [0, 1, 0], [-np.sin(pitch), 0, np.cos(pitch)]])
    rz = np.array([[np.cos(yaw), -np.sin(yaw), 0], [np.sin(yaw), np.cos(yaw), 0], [0, 0, 1]])
    return np.array([x, y, z]) + rz @ ry @ rx @ point


def test_energy_is_kept_without_damping_and_friction(robot: Robot) -> None:
    free = _gripping(robot, damping=np.zeros(3))
    offset = {name: 3.0 * value for name, value in START.items()}
    result = simulate(free, Scenario("free_response", 2.0, offset=offset), 2000.0, step=1e-4, effects={"coriolis": {}})
    energy = _energy(free, result)[10:-10]
    rest = simulate(free, Scenario("free_response", 0.01), 2000.0)
    swing = energy[0] - _energy(free, rest)[3]
    assert swing > 0.001
    assert np.ptp(energy) < 2e-3 * swing


@pytest.mark.slow
def test_energy_never_grows_with_damping_and_friction(robot: Robot) -> None:
    result = simulate(robot, Scenario("free_response", 2.0, offset={"roll": 0.004, "y": 0.001}), 2000.0)
    damped = _energy(_gripping(robot), result)
    assert damped[10] - damped[-10] > 1e-3
    gripping = simulate(_gripping(robot), Scenario("free_response", 2.0, offset=START), 2000.0)
    energy = _energy(robot, gripping)[5:-5]
    assert np.diff(energy).max() < 1e-3 * np.ptp(energy)


def test_wheel_loads_at_rest_are_the_static_split(robot: Robot) -> None:
    """(2.24): each axle carries the share of the other's distance, each side half."""
    a, b = 0.15, 0.13
    weight = robot.mass * GRAVITY
    expected = weight / 2 * np.array([b, a, a, b]) / (a + b)
    assert rest_loads(robot) == pytest.approx(expected, rel=2e-3)
    result = simulate(robot, Scenario("free_response", 0.5), 1000.0)
    loads = np.column_stack([result[f"load_{i}"] for i in (1, 2, 3, 4)])
    assert loads == pytest.approx(np.broadcast_to(rest_loads(robot), loads.shape), rel=1e-6)
    assert loads[-1].sum() == pytest.approx(weight, rel=1e-9)


def test_at_rest_the_accelerometer_reads_plus_g(robot: Robot) -> None:
    result = simulate(robot, Scenario("free_response", 0.2))
    assert result["az"] == pytest.approx(GRAVITY, rel=1e-4)
    # what tilt of the springs remains shows as gravity along x
    assert result["ax"] == pytest.approx(-GRAVITY * np.sin(rest_pose(robot)[2]), abs=1e-9)


def test_small_decays_match_the_coupled_determinants(robot: Robot) -> None:
    """Roots of thesis.md section 5's determinants, found by bisection on a symmetric robot, to 0.1 %."""
    points = robot.contact_points.copy()
    points[:, 0] = np.sign(points[:, 0]) * 0.14
    plain = _gripping(robot, contact_points=points, inertia=np.diag(np.diag(robot.inertia)), damping=np.zeros(3))
    m, g, h, c, a = plain.mass, GRAVITY, 0.23, 0.18, 0.14
    kx, ky, kz = plain.stiffness
    sink = m * g / (4 * kz)
    h = h - sink  # the arms end where the tires touch the floor: the robot stands that much lower

    def determinant(omega: float, inertia: float, k: float, lever: float) -> float:
        s2 = -(omega**2)
        side = m * s2 + 4 * k
        return side * (inertia * s2 + 4 * (0.23**2 * k + lever**2 * kz) - m * g * 0.23) - (4 * 0.23 * k) ** 2

    for channel, inertia, k, lever, guess in (
        ("roll", plain.inertia[0, 0], ky, c, (30.0, 50.0)),
        ("pitch", plain.inertia[1, 1], kx, a, (12.0, 25.0)),
    ):
        root = brentq(determinant, *guess, args=(inertia, k, lever))
        other = "y" if channel == "roll" else "x"
        # start in the shape of the mode, so that the count of zero crossings is that of one line
        ratio = -(4 * 0.23 * k) / (4 * k - m * root**2) * (1.0 if channel == "roll" else -1.0)
        result = simulate(plain, Scenario("free_response", 4.0, offset={channel: 1e-5, other: 1e-5 * ratio}), 2000.0)
        course = result[channel] - result[channel].mean()
        up = np.flatnonzero((course[:-1] < 0) & (course[1:] >= 0))
        exact = up - course[up] / (course[up + 1] - course[up])
        found = 2 * np.pi * (len(exact) - 1) / ((exact[-1] - exact[0]) / 2000.0)
        assert found == pytest.approx(root, rel=1e-3)


def test_both_routes_agree_for_small_decays(robot: Robot) -> None:
    """Full kernel against the matrix exponential of the linear model, all six coordinates."""
    result = simulate(robot, Scenario("free_response", 1.0, offset={n: 0.1 * v for n, v in START.items()}), 500.0)
    transition = expm(linear_robot(robot).state_matrix / 500.0)
    state = np.concatenate([0.1 * np.array(list(START.values())), np.zeros(6)])
    expected = [state]
    for _ in range(len(result.time) - 1):
        expected.append(transition @ expected[-1])
    rest = dict(zip(NAMES, [0, 0, *rest_pose(robot), 0], strict=True))
    for index, name in enumerate(NAMES):
        course = np.array(expected)[:, index]
        assert np.abs(result[name] - rest[name] - course).max() < 5e-4 * np.abs(course).max()


def test_step_halving_converges_at_second_order(robot: Robot) -> None:
    scenario = Scenario("free_response", 0.5, offset=START)
    runs = [simulate(_gripping(robot), scenario, 500.0, step=step).values[:, 3:12] for step in (4e-4, 2e-4, 1e-4)]
    coarse, fine = (np.abs(a - b).max(axis=0) for a, b in itertools.pairwise(runs))
    order = np.log2(coarse / fine)
    assert np.all(order > 1.7)


def test_the_step_that_is_chosen_keeps_its_error_estimate(robot: Robot) -> None:
    """Measured frequency error of a long step against (omega h)²/24, and the step that follows from it."""
    plain = _gripping(robot, damping=np.zeros(3))
    roll = linear_robot(plain).modes()[1]
    shape = np.real(_mode_shape(plain, roll[0]))
    offset = dict(zip(NAMES, 1e-4 * shape / np.abs(shape).max(), strict=True))
    counted = {}
    for step in (2e-3, 1e-4):
        course = simulate(plain, Scenario("free_response", 8.0, offset=offset), 500.0, step=step)["roll"]
        course = course - course.mean()
        up = np.flatnonzero((course[:-1] < 0) & (course[1:] >= 0))
        exact = up - course[up] / (course[up + 1] - course[up])
        counted[step] = (len(exact) - 1) / (exact[-1] - exact[0])
    measured = counted[2e-3] / counted[1e-4] - 1.0
    assert measured == pytest.approx((roll[0] * 2e-3) ** 2 / 24.0, rel=0.1)
    choice = choose_step(robot, swivel(wheel_rates(robot, 0.0, 0.5)), effect_vector({}))
    fastest = linear_robot(robot).modes()[-1, 0]
    assert choice.error == pytest.approx((fastest * choice.step) ** 2 / 24.0, rel=0.05)
    assert choice.error <= 1.01e-5


def _mode_shape(robot: Robot, omega: float) -> np.ndarray:
    linear = linear_robot(robot)
    values, vectors = np.linalg.eig(np.linalg.solve(linear.mass, linear.stiffness))
    return vectors[:, np.argmin(np.abs(np.sqrt(values.real) - omega))]


def test_a_sliding_contact_moves_with_the_force_on_it_never_against(robot: Robot) -> None:
    """Friction never pushes: the contact point runs where the carcass pulls it, and the carcass gives energy up."""
    random = np.random.default_rng(7)
    for _ in range(2000):
        deflection, hub, velocity = random.normal(0, 3e-3), random.normal(0, 0.05), random.normal(0, 0.1)
        breakaway, share = random.uniform(1, 100), random.uniform(0.3, 1.0)
        force = 18000.0 * deflection + 30.0 * hub
        velocity = abs(velocity) * np.sign(force)
        sliding, after, on_hub = contact_force(
            deflection, True, velocity, hub, 0.0, 18000.0, 30.0, 0.035, breakaway, share * breakaway, 0.0, 1e-4
        )
        if sliding:
            assert abs(force) > share * breakaway
            assert after * force >= -abs(hub * force)  # at the least it is carried along with the hub
            assert on_hub * force <= abs(30.0 * after * force)


def test_momentum_is_kept_without_a_floor(robot: Robot) -> None:
    """Thrown off the floor, with wheels that lift, only gravity acts: a straight path and a parabola in the world,
    although the axes in which the velocity is kept turn with the robot."""
    robot = robot.with_changes(effective_mass=0.0)
    result = simulate(
        robot,
        Scenario("free_response", 0.3, offset={"z": 2.0}, velocity={"x": 0.3, "yaw": 1.0}),
        effects={"wheel_lift": {}, "coriolis": {}},
    )
    t = result.time
    assert result["z"] - result["z"][0] == pytest.approx(-0.5 * GRAVITY * t**2, abs=1e-9)
    assert result["x"] == pytest.approx(0.3 * t, abs=1e-9)
    momentum = robot.inertia @ np.array([result["wx"], result["wy"], result["wz"]])
    assert np.linalg.norm(momentum, axis=0) == pytest.approx(np.linalg.norm(momentum[:, 0]), rel=1e-6)


def test_a_mirrored_swivel_is_the_mirror_image(robot: Robot) -> None:
    mirror = robot.with_changes(inertia=robot.inertia * np.array([[1, -1, 1], [-1, 1, -1], [1, -1, 1]]))
    left = simulate(robot, swivel(wheel_rates(robot, 0.0, 0.7), 2.0))
    right = simulate(mirror, swivel(wheel_rates(robot, 0.0, -0.7), 2.0))
    early = left.time < 0.3  # stick-slip is chaotic: rounding tells the two apart later on
    for name, sign in (("ax", 1), ("ay", -1), ("az", 1), ("yaw", -1)):
        assert left[name][early] == pytest.approx(sign * right[name][early], abs=1e-6)
    assert left["yaw"][-1] > 0.5


def test_a_cable_never_pushes(robot: Robot) -> None:
    travel = np.concatenate([np.linspace(0, 0.004, 50), np.linspace(0.004, 0.0, 50)])
    result = simulate(robot, replace(pull("lateral", 1.0, 4.0), head=travel, head_step=0.04))
    assert result["force"].min() == 0.0
    assert result["force"].max() > 100.0


def test_friction_holds_less_than_its_limit(robot: Robot) -> None:
    result = simulate(robot, pull("lateral", 1.0, 12.0, height=0.0), 100.0)
    assert result["force"].max() < robot.mu_static * robot.mass * GRAVITY * 1.02


def test_equal_frictions_slide_without_a_tooth(robot: Robot) -> None:
    """With mu_k = mu_s the relay is Coulomb's law: the pull ends at mu m g, whatever the step."""
    smooth = robot.with_changes(mu_static=0.8, mu_kinetic=0.8)
    for step in (2e-4, 5e-5):
        force = simulate(smooth, pull("lateral", 1.0, 8.0), 100.0, step=step)["force"][600:]
        assert force == pytest.approx(0.8 * robot.mass * GRAVITY, rel=0.01)


@pytest.mark.parametrize("step", [2e-4, 1e-3])
def test_a_contact_of_one_friction_slides_with_all_of_it(step: float) -> None:
    """Coulomb's law: a hub that moves on evenly carries mu N, however fast it is, and whatever the step."""
    limit, hub, deflection, velocity, slides = 60.0, 0.05, 0.0, 0.0, False
    drag = release_share(0.8, 0.8, 0.0) * limit
    carried = []
    for _ in range(round(0.5 / step)):
        slides, velocity, force = contact_force(
            deflection, slides, velocity, hub, 0.0, 18000.0, 42.0, 0.035, limit, limit, drag, step
        )
        deflection += step * (hub - velocity)
        carried.append(-force)
    assert carried[-100:] == pytest.approx(np.full(100, limit), rel=1e-6)


def test_a_fixture_takes_steps_that_are_long_for_it(robot: Robot) -> None:
    """It is stiffer than all else: explicit, its own vibration burst beyond 0.4 ms."""
    smooth = robot.with_changes(mu_static=0.8, mu_kinetic=0.8)
    turning = replace(pull("lateral", 1.0, 6.0), wheel_rates=np.full((1, 2), 0.2), held=True)
    fine, coarse = (simulate(smooth, turning, 50.0, step)["force"][50:] for step in (5e-5, 5e-4))
    assert np.sqrt(np.mean((coarse - fine) ** 2)) < 0.2 < 0.05 * np.ptp(fine)


def test_friction_that_falls_by_next_to_nothing_is_friction_that_does_not_fall(robot: Robot) -> None:
    smooth = robot.with_changes(mu_static=0.8, mu_kinetic=0.8)
    for scenario in (pull("lateral", 1.0, 8.0), pull("longitudinal", 2.0, 8.0)):
        falling = {"stribeck": {"kinetic_share": 1.0 - 1e-6, "stribeck_velocity_m_s": 0.003}}
        without, beside = (simulate(smooth, scenario, 100.0, 2e-4, e)["force"] for e in (None, falling))
        assert beside == pytest.approx(without, abs=0.05)


def test_a_run_away_names_time_and_parameters(robot: Robot) -> None:
    wild = robot.with_changes(damping=np.array([50.0, 30.0, -1e6]))
    with pytest.raises(SimulationError, match=r"t = .* damping"):
        simulate(wild, Scenario("free_response", 1.0, offset=START))
