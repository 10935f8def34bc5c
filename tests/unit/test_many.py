"""Many releases in one call are to the last bit what each of them gives alone; the short loop is the long one."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from ssmr_ident.core import threads
from ssmr_ident.core.errors import Impossible, InputError
from ssmr_ident.core.recording import Channel, Provenance, Recording
from ssmr_ident.experiments.campaign import Measurement
from ssmr_ident.experiments.free_response import free_response
from ssmr_ident.experiments.scenario import Scenario
from ssmr_ident.identify.body.builder import RobotBuilder
from ssmr_ident.identify.fitting.coordinates import Model
from ssmr_ident.identify.fitting.joint import differentiate, evaluate
from ssmr_ident.identify.posterior.objective import Unknown
from ssmr_ident.identify.trials.decay import decay_trial
from ssmr_ident.physics.robot import Robot, robot_from_parameters
from ssmr_ident.physics.slots import Effects
from ssmr_ident.session import Entry, read_parameters
from ssmr_ident.simulate import body as bodies
from ssmr_ident.simulate.angles import SMALL, sin_cos
from ssmr_ident.simulate.body import AWAY, MOVING
from ssmr_ident.simulate.many import Release, simulate_many
from ssmr_ident.simulate.simulation import simulate

SECONDS = 0.3
NAMES = ("ax", "az", "wy")
EFFECTS = (
    {},
    {"nonlinear_stiffness": {"k3_N_m3": 1e8}},
    {"sensor_misalignment": {"angle_x_rad": 0.1}},
    {"dry_friction": {"F_c_N": 3.0}},
    {"flexible_mast": {"f_mast_Hz": 9.0}},
    {"ground_roughness": {"height_m": 1e-4}},
    {"sensor_bandwidth": {"bandwidth_hz": 14.0}},
)
TOO_HEAVY = {"flexible_mast": {"f_mast_Hz": 9.0, "mass_kg": 15.0, "height_above_com_m": 1.5}}


@pytest.fixture(scope="module")
def robot() -> Robot:
    return robot_from_parameters(read_parameters("p3at-extended"))


def _starts(count: int) -> list[Scenario]:
    random = np.random.default_rng(3)
    return [
        Scenario(
            "free_response",
            SECONDS,
            offset={"x": 1e-3 * a, "roll": 0.01 * b, "brace_y": 1e-3 * c, "loaded": 0.5, "unseen": 0.2},
            velocity={"z": 0.05 * a, "yaw": 0.2 * b, "sway_x": 0.1 * c},
        )
        for a, b, c in random.standard_normal((count, 3))
    ]


def _release(robot: Robot, effects: Effects, scenario: Scenario) -> tuple[Release, Scenario]:
    away = np.array([scenario.offset.get(name, 0.0) for name in AWAY])
    return Release(robot, effects, away, np.array([scenario.velocity.get(name, 0.0) for name in MOVING])), scenario


def test_many_releases_are_each_release_alone(robot: Robot) -> None:
    robot = robot.sliding_together()
    loud = replace(robot.accelerometer, gain=np.array([1.03, 0.98, 1.01]))
    heavier = robot.with_changes(mass=1.1 * robot.mass, accelerometer=loud)
    asked = [_release(body, e, s) for e in EFFECTS for body in (robot, heavier) for s in _starts(2)]
    asked.insert(5, _release(robot, TOO_HEAVY, _starts(1)[0]))
    found = simulate_many([release for release, _ in asked], SECONDS, 1000.0, 5e-4, ("ax", "ay", "az"))
    for (release, scenario), result in zip(asked, found, strict=True):
        if release.effects is TOO_HEAVY:
            assert np.isnan(result).all()
            with pytest.raises(Impossible):
                bodies.body_of(robot, TOO_HEAVY)
            continue
        alone = simulate(release.robot, scenario, 1000.0, step=5e-4, effects=release.effects)
        np.testing.assert_array_equal(result, alone.values[:, :3])


def test_what_no_robot_has_is_refused(robot: Robot) -> None:
    misspelt, _ = _release(robot, {"flexible_mast": {"mas_kg": 1.0}}, _starts(1)[0])
    with pytest.raises(InputError, match="Did you mean 'mass_kg'"):
        simulate_many([misspelt], SECONDS, 1000.0, 5e-4, NAMES)


def test_one_axis_of_a_turned_sensor_reads_all_three(robot: Robot) -> None:
    turned = {"sensor_misalignment": {"angle_x_rad": 0.1, "angle_z_rad": 0.2}}
    release, scenario = _release(robot, turned, _starts(1)[0])
    (found,) = simulate_many([release], SECONDS, 1000.0, 5e-4, ("wy", "ay"))
    whole = simulate(robot, scenario, 1000.0, step=5e-4, effects=release.effects)
    assert np.array_equal(found, np.column_stack([whole["wy"], whole["ay"]]))


def test_a_robot_that_leaves_the_finite_numbers_spoils_no_other(robot: Robot) -> None:
    away = robot.with_changes(damping=-1e7 * np.ones(3))
    (good, _), (bad, _) = (_release(body, {}, _starts(1)[0]) for body in (robot, away))
    found = simulate_many([good, bad, good], SECONDS, 1000.0, 5e-4, NAMES)
    assert np.isnan(found[1]).all()
    np.testing.assert_array_equal(found[0], found[2])
    np.testing.assert_array_equal(found[0], simulate_many([good], SECONDS, 1000.0, 5e-4, NAMES)[0])


def test_the_loop_without_effects_is_the_loop_with_all_of_them_off(robot: Robot, monkeypatch) -> None:
    short = simulate(robot, free_response("yaw", duration=0.5), step=5e-4)
    monkeypatch.setattr(bodies, "is_plain", lambda vector: False)
    robot = robot.with_changes()  # which no body was made of yet
    np.testing.assert_array_equal(short.values, simulate(robot, free_response("yaw", duration=0.5), step=5e-4).values)


def test_small_angles_by_their_series() -> None:
    for angle in np.linspace(-1.5 * SMALL, 1.5 * SMALL, 2001):
        np.testing.assert_allclose(sin_cos(angle), (np.sin(angle), np.cos(angle)), rtol=4e-16)
    assert np.isnan(sin_cos(np.nan)).all()


def test_slopes_of_many_at_once_are_those_of_one_after_the_other(robot: Robot, monkeypatch) -> None:
    made = simulate(robot, free_response("pitch", duration=1.5), 1000.0, step=1e-4)
    channels = tuple(Channel(axis, made[axis], "m/s^2") for axis in ("ax", "az"))
    recording = Recording(made.time, channels, Provenance("pitch.csv", "", "test"))
    entry = Entry("pitch.csv", "free_response", motion="pitch")
    trial = decay_trial(Measurement(entry, recording), RobotBuilder(robot))
    known = (
        Unknown("tire.stiffness_x_N_m", "N/m", float(robot.stiffness[0]), 500.0),
        Unknown("mass_kg", "kg", 30.0, 1.0),
    )
    model, point = Model(known).with_effect("dry_friction", {"F_c_N": 2.0}, {})
    point = np.concatenate([[0.1, -0.2], point])
    nuisance = 0.1 * np.random.default_rng(5).standard_normal(len(trial.scales))
    fits = [evaluate([one], model, point, [nuisance]) for one in (trial, replace(trial, many=None))]
    monkeypatch.setattr(threads, "_pool", lambda: threads.Pool(1))  # a single processor takes one trial after the other
    together, apart = (differentiate(fit).slopes[0] for fit in fits)
    # matrices are multiplied in another order, and differences of 1e-3 magnify that
    np.testing.assert_allclose(together.shared, apart.shared, atol=1e-11 * np.abs(apart.shared).max())
    np.testing.assert_allclose(together.own, apart.own, atol=1e-11 * np.abs(apart.own).max())
    assert np.all(np.any(together.shared != 0.0, axis=0))
