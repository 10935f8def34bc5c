"""Small motions with linear effects in closed form, against the simulator's time steps."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from ssmr_ident.experiments import Scenario
from ssmr_ident.physics.effects import CATALOGUE
from ssmr_ident.physics.extended import PLACES, added, numbers, small_motion, tilted
from ssmr_ident.physics.linear import linear_robot
from ssmr_ident.physics.robot import robot_from_parameters
from ssmr_ident.session import read_parameters
from ssmr_ident.simulate.simulation import simulate

RATE = 1000.0
EFFECTS = {
    "none": {},
    "mast": {"flexible_mast": {"f_mast_Hz": 9.0, "mass_kg": 2.0, "height_above_com_m": 0.3, "damping_ratio": 0.04}},
    "belt": {"motor_belt": {"K_b_N_m": 2e4, "D_b_N_s_m": 50.0, "rim_mass_kg": 1.0}},
    "branch": {"viscoelastic_relaxation": {"K_m_N_m": 4e3, "tau_s": 0.03}},
    "offset": {"com_offset": {"offset_x_m": 0.02, "offset_y_m": -0.03}},
    "turned": {"sensor_misalignment": {"angle_x_rad": 0.1, "angle_y_rad": -0.06, "angle_z_rad": 0.08}},
}


@pytest.fixture(scope="module")
def robot():
    found = robot_from_parameters(read_parameters("p3at-extended"))
    return replace(found, accelerometer=replace(found.accelerometer, bandwidth_hz=float("inf")))


def closed_form(robot, effects, state, seconds):
    row = numbers(robot, robot.accelerometer.gain, effects)
    a, c, start, carried = small_motion(row, *tilted(row), *added(effects))
    assert carried
    poles, right = np.linalg.eig(a)
    into = np.linalg.solve(right, start[:, : len(state)] @ state)
    time = np.arange(round(seconds * RATE) + 1) / RATE
    return ((c @ right * into) @ np.exp(np.outer(poles, time))).real.T


@pytest.mark.parametrize("effects", EFFECTS.values(), ids=EFFECTS.keys())
def test_closed_form_is_what_the_simulator_steps_to(robot, effects):
    size = 1e-5
    offset = {"x": 0.3, "y": -0.7, "z": 0.1, "roll": 1.5, "pitch": -1.0, "yaw": 2.0}
    state = np.concatenate([size * np.array(list(offset.values())), np.zeros(6)])
    complete = {name: CATALOGUE[name].begun(values) for name, values in effects.items()}
    scenario = Scenario("free_response", 0.5, offset={name: size * v for name, v in offset.items()})
    stepped = simulate(robot, scenario, RATE, step=1e-4, effects=effects).values[:, :3]
    still = simulate(robot, Scenario("free_response", 0.5), RATE, step=1e-4, effects=effects).values[:, :3]
    exact = closed_form(robot, complete, state, 0.5)[: len(stepped)]
    assert np.abs(stepped - still - exact).max() < 2e-3 * np.abs(exact).max()


def test_without_effects_it_is_the_linear_robot(robot):
    row = numbers(robot, np.ones(3), {})
    a, _, _, _ = small_motion(row, *tilted(row), *added({}))
    np.testing.assert_allclose(a, linear_robot(robot).state_matrix, rtol=1e-9, atol=1e-9)


def test_a_mast_heavier_than_its_robot_is_none(robot):
    heavy = {"flexible_mast": {"f_mast_Hz": 9.0, "mass_kg": 2.0 * robot.mass, "height_above_com_m": 0.3,
                               "damping_ratio": 0.04}}  # fmt: skip
    row = numbers(robot, np.ones(3), heavy)
    assert not small_motion(row, *tilted(row), *added(heavy))[3]


def test_an_offset_moves_what_contacts_and_sensor_do_together():
    offset, both = dict(PLACES["com_offset.offset_x_m"]), dict(PLACES["contact_shift_x_m"])
    both |= dict(PLACES["accelerometer.position_m.x"])
    assert offset == {place: -factor for place, factor in both.items()}
