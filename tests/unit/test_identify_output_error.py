"""Output error of decays: derivatives against differences, elimination against one big least squares, defects."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from ssmr_ident.experiments.scenario import Scenario
from ssmr_ident.identify.body.builder import RobotBuilder
from ssmr_ident.identify.body.defects import defect, small_motion
from ssmr_ident.identify.body.free_decays import BodyDecay, body_decay
from ssmr_ident.identify.body.output_error import START_SCALES, DecaySamples
from ssmr_ident.identify.body.response import body_response, sensor_gains
from ssmr_ident.identify.posterior.identifiability import flat_directions
from ssmr_ident.identify.posterior.most_probable import most_probable
from ssmr_ident.identify.robot.fit import fit_body
from ssmr_ident.identify.robot.unknowns import robot_unknowns
from ssmr_ident.physics.linear import linear_robot, responses
from ssmr_ident.session import read_parameters
from ssmr_ident.signals.noise import AutoregressiveNoise
from ssmr_ident.simulate.simulation import simulate

STEP, COUNT, NOISE = 1e-3, 2048, 0.01
START = {"roll": (3, 0.006), "pitch": (4, 0.012), "yaw": (5, 0.01)}


@pytest.fixture(scope="module")
def builder() -> RobotBuilder:
    return RobotBuilder.of(read_parameters("p3at-extended"))


def made(builder: RobotBuilder, motion: str, seed: int) -> BodyDecay:
    index, size = START[motion]
    start = np.zeros(12)
    start[index] = size
    start[2] = 3e-4
    rng = np.random.default_rng([seed, index])
    samples = small_motion(builder({}), start, COUNT, STEP) + NOISE * rng.standard_normal((COUNT, 3))
    samples[:, 2] += 9.8
    return body_decay(motion, STEP * np.arange(COUNT), [(k, samples[:, k]) for k in range(3)], 80.0)


def test_exponentials_are_the_closed_form_behind_the_sensor(builder: RobotBuilder) -> None:
    robot, start = builder({}), np.array([1e-4, 2e-4, 3e-4, 4e-3, 5e-3, 6e-3, 0.01, 0.02, 0.03, 0.04, 0.05, 0.06])
    response = body_response(robot)
    times = STEP * np.arange(40, 600)
    gains = np.tile(sensor_gains(response.poles, 80.0, STEP), (3, 1))
    course = response.waves(times) @ response.weights_of(gains, (0, 1, 2), start)
    np.testing.assert_allclose(course, small_motion(robot, start, 600, STEP)[40:], atol=1e-5 * np.abs(course).max())


def test_small_motion_is_what_the_simulator_gives(builder: RobotBuilder) -> None:
    """A hundredth of a degree leaves nothing but the integration's own error."""
    robot = builder({})
    start = np.zeros(12)
    start[3] = 2e-4
    scenario = Scenario("free_response", 1.0, offset={"roll": 2e-4})
    run = simulate(robot, scenario, 1000.0).values[:, 1]
    exact = small_motion(robot, start, 1000, STEP)[:, 1]
    assert np.max(np.abs(run - run[-1] - exact + exact[-1])) < 0.01 * np.ptp(exact)


def test_gradient_and_elimination(builder: RobotBuilder) -> None:
    """Gradient against differences of the cost; projected information against the joint least squares."""
    decays = [made(builder, motion, 1) for motion in START]
    samples = DecaySamples(decays, builder)
    names = {"tire.stiffness_y_N_m": 20.0, "tire.damping_z_N_s_m": 0.5, "height_m": 1e-4}
    values = {"tire.stiffness_y_N_m": 18100.0, "tire.damping_z_N_s_m": 75.0, "height_m": 0.2305}
    system = samples.system(values, names)
    for index, (name, move) in enumerate(names.items()):
        ahead = samples.cost({**values, name: values[name] + move})
        behind = samples.cost({**values, name: values[name] - move})
        assert system.gradient[index] == pytest.approx((ahead - behind) / (4 * move), rel=1e-3)

    decay = decays[0]
    alone = DecaySamples([decay], builder).system(values, names)
    waves = body_response(builder(values)).waves(decay.times)
    response = body_response(builder(values))
    gains = decay.whitening(response.poles) * sensor_gains(response.poles, 80.0, STEP) * decay.averaging(response.poles)
    own = [waves @ weight * START_SCALES for weight in response.weights(gains, decay.axes)]
    basis, white = decay.nuisances(), decay.whitened(decay.samples)
    width = basis.shape[1]
    joint = np.zeros((3 * len(waves) + 12, 12 + 3 * width))
    for c in range(3):
        rows = slice(c * len(waves), (c + 1) * len(waves))
        joint[rows, :12] = own[c]
        joint[rows, 12 + c * width : 12 + (c + 1) * width] = basis
    joint[-12:, :12] = np.eye(12)
    target = np.concatenate([*white.T, np.zeros(12)])
    rest = target - joint @ np.linalg.lstsq(joint, target, rcond=None)[0]
    assert alone.cost == pytest.approx(float(rest @ rest), rel=1e-8)


@pytest.mark.slow
def test_parameters_come_back_and_only_the_common_factor_is_flat(builder: RobotBuilder) -> None:
    """M, C and K times one number give the same motion: the Fisher information has exactly that null space."""
    decays = [made(builder, motion, seed) for motion in START for seed in (1, 2)]
    unknowns = [u for u in robot_unknowns(read_parameters("p3at-extended")) if "mu_" not in u.name]
    start = {u.name: u.value(0.5 * (-1) ** k) for k, u in enumerate(unknowns)}
    fit = fit_body(decays, builder, unknowns, start=start, random_starts=0)
    truth = np.array([u.prior for u in unknowns])
    assert np.max(np.abs(fit.posterior.values - truth) / fit.posterior.stds) < 3.5
    assert fit.agreeing == fit.tried == 2
    moves = {u.name: 1e-4 * u.prior_spread if u.prior_std else 1e-3 for u in unknowns}
    values = {u.name: u.prior for u in unknowns}
    system = DecaySamples(fit.decays, builder).system(values, moves)
    spreads = np.array([u.prior_spread if u.prior_std else 1.0 for u in unknowns])
    information = np.outer(spreads, spreads) * system.information
    sizes, vectors = np.linalg.eigh(information)
    assert sizes[0] < 1e-6 < 1e-2 < sizes[1]
    scaled = ("mass", "inertia", "tire.stiffness", "tire.damping")
    common = np.array([u.prior if u.name.startswith(scaled) else 0.0 for u in unknowns]) / spreads
    assert abs(common @ vectors[:, 0]) == pytest.approx(np.linalg.norm(common), rel=1e-6)
    assert len(flat_directions([u.name for u in unknowns], information)) == 1


@pytest.mark.slow
def test_stds_are_those_of_many_noises(builder: RobotBuilder) -> None:
    known = robot_unknowns(read_parameters("p3at-extended"))
    unknowns = [replace(u, prior_std=None) for u in known if u.name.startswith("tire.damping")]
    known_noise = (AutoregressiveNoise(np.ones(1), NOISE / np.sqrt(5.0)),) * 3  # five samples to a block
    scores = []
    for seed in range(25):
        decays = [replace(made(builder, motion, 100 + seed), noises=known_noise) for motion in START]
        samples = DecaySamples(decays, builder)
        fit = most_probable(unknowns, [], [samples])
        scores.append((fit.values - [u.prior for u in unknowns]) / fit.stds)
    # 75 numbers: their variance is known to 16 %
    assert 0.6 < np.mean(np.square(scores)) < 1.5


def test_defect_of_a_small_motion_is_small_and_of_a_sliding_one_large(builder: RobotBuilder) -> None:
    decay, robot = made(builder, "roll", 3), builder({})
    start = np.zeros(12)
    start[3] = 1e-4
    assert np.max(np.abs(defect(decay, robot, start))) < 0.1 * NOISE
    start[3] = 0.05
    assert np.max(np.abs(defect(decay, robot, start))) > 10 * NOISE


def test_responses_agree_with_the_matrix_exponential(builder: RobotBuilder) -> None:
    linear = linear_robot(builder({}))
    found = responses(linear.state_matrix, np.eye(12)[:1], np.array([0.0, 0.1]))
    assert found[0, 0] == pytest.approx(np.eye(12)[0], abs=1e-9)
