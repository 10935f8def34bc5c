"""The force that a robot's tires are missing, against the law that was put into the simulation."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from ssmr_ident.core.recording import Channel, Provenance, Recording
from ssmr_ident.diagnose.surface import surfaces
from ssmr_ident.diagnose.tire_force import tire_state
from ssmr_ident.experiments.campaign import Measurement
from ssmr_ident.experiments.free_response import free_response
from ssmr_ident.identify.body.builder import RobotBuilder
from ssmr_ident.identify.fitting.coordinates import Model
from ssmr_ident.identify.fitting.joint import JointFit, evaluate
from ssmr_ident.identify.trials.decay import SCALES, STATES, decay_trial
from ssmr_ident.session import Entry, read_parameters
from ssmr_ident.simulate.simulation import simulate

PARAMETERS = read_parameters("p3at-extended")
CONTACTS = RobotBuilder.of(PARAMETERS).nominal.contact_points
LOUD = slice(20, 160)


def _turned(effects: dict, stiffer: float = 1.0) -> JointFit:
    """A yaw decay of a robot with effects or stiffer tires, held against the baseline with the true start."""
    builder = RobotBuilder.of(PARAMETERS)
    robot = builder({})
    scenario = free_response("yaw", 0.001, 2.5)
    plant = replace(robot, stiffness=robot.stiffness * np.array([stiffer, stiffer, 1.0]))
    seen = simulate(plant, scenario, 1000.0, effects=effects)
    rng = np.random.default_rng(1)
    channels = tuple(
        Channel(name, seen[name] + 1e-4 * rng.standard_normal(len(seen.time)), "m/s^2") for name in ("ax", "ay", "az")
    )
    recording = Recording(seen.time, channels, Provenance("yaw.csv", "", "test"))
    trial = decay_trial(Measurement(Entry("yaw.csv", "free_response", motion="yaw"), recording), builder)
    start = np.zeros(len(STATES))
    start[STATES.index("yaw")] = scenario.offset["yaw"]
    return evaluate([trial], Model((), (), {}), np.zeros(0), [start / SCALES])


def test_a_little_more_stiffness_shows_as_a_force_in_proportion_to_the_deflection() -> None:
    fit = _turned({}, stiffer=1.01)
    state = tire_state(fit, 0, PARAMETERS, fit.simulated)
    assert state.place == "deflection of the tires along x"
    # turned about the centre, tires deflect along x by their distance to the side, along y by that to the front
    along_y = np.mean(np.abs(CONTACTS[:, 0])) / np.mean(np.abs(CONTACTS[:, 1]))
    stiffness = PARAMETERS.number("tire.stiffness_x_N_m"), PARAMETERS.number("tire.stiffness_y_N_m")
    expected = 0.01 * (stiffness[0] + along_y**2 * stiffness[1]) / (1.0 + along_y**2)
    force, deflection = state.forces[0][LOUD], state.deflection[LOUD]
    assert np.corrcoef(force, deflection)[0, 1] > 0.9
    assert force @ deflection / (deflection @ deflection) == pytest.approx(expected, rel=0.25)


def test_the_missing_force_of_a_hardening_tire_follows_the_cube_of_its_deflection() -> None:
    fit = _turned({"nonlinear_stiffness": {"k3_N_m3": 2e8}})
    state = tire_state(fit, 0, PARAMETERS, fit.simulated)
    assert np.corrcoef(state.forces[0][LOUD], state.deflection[LOUD] ** 3)[0, 1] > 0.8


def test_the_surface_of_a_robot_is_that_of_its_tires() -> None:
    (surface,) = surfaces(_turned({"nonlinear_stiffness": {"k3_N_m3": 2e8}}), None, PARAMETERS)
    assert surface.where == "yaw: deflection of the tires along x"
    assert surface.units == ("m", "m/s", "N")
    assert len(surface.displacement) == len(surface.before) > 50
    (clean,) = surfaces(_turned({}), None, PARAMETERS)
    assert clean.before.std() < 0.1 * surface.before.std()
