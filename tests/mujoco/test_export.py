"""Exported models in the engine they are for: decays as the simulator has them, and a fit that finds the numbers."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from ssmr_ident.core.parameter import Estimate, ParameterSet
from ssmr_ident.physics.rig import Rig
from ssmr_ident.session import read_parameters
from ssmr_ident.simulate.rig import simulate_rig
from ssmr_ident.workflows.export import parameters_as
from ssmr_ident.workflows.fit.run import fit_session

mujoco = pytest.importorskip("mujoco")
STEPS, EVERY = 20_000, 10
STRAIGHT = {"mass_kg": (2.0, "kg"), "stiffness_N_m": (1800.0, "N/m"), "damping_N_s_m": (3.0, "N s/m")}
ROTARY = {
    "inertia_kg_m2": (0.02, "kg m^2"), "stiffness_N_m_rad": (18.0, "N m/rad"), "damping_N_m_s_rad": (0.02, "N m s/rad"),
}  # fmt: skip


def rig(values: dict[str, tuple[float, str]], friction: float = 0.0) -> ParameterSet:
    effects = {"dry_friction": {"F_c_N": Estimate(friction, None, "N")}} if friction else {}
    return ParameterSet("rig", {key: Estimate(value, None, unit) for key, (value, unit) in values.items()}, effects)


def let_go(xml: str, start: float) -> np.ndarray:
    """Position at every ``EVERY``-th step of 0.1 ms."""
    model = mujoco.MjModel.from_xml_string(xml)
    data = mujoco.MjData(model)
    data.qpos[0] = start
    log = np.empty(STEPS // EVERY)
    for row in range(len(log)):
        log[row] = data.qpos[0]
        mujoco.mj_step(model, data, EVERY)
    return log


@pytest.mark.parametrize("values", [STRAIGHT, ROTARY])
def test_a_rig_let_go_in_the_engine_swings_as_in_the_simulator(values: dict[str, tuple[float, str]]) -> None:
    found = let_go(parameters_as(rig(values), "mjcf").decode(), 1e-3)
    mass, stiffness, damping = (value for value, _ in values.values())
    simulated = simulate_rig(Rig(mass, damping, stiffness), np.zeros(len(found)), 1e4 / EVERY, position=1e-3)[:, 0]
    assert np.abs(found - simulated).max() < 2e-3 * 1e-3 * 3.0


def test_friction_takes_the_same_from_every_swing() -> None:
    values = {**STRAIGHT, "damping_N_s_m": (0.0, "N s/m")}
    found = let_go(parameters_as(rig(values, friction=0.05), "mjcf").decode(), 1e-3)
    turns = 1 + np.flatnonzero(np.diff(np.sign(np.diff(found))))
    lost = -np.diff(np.abs(found[turns[:8]]))
    np.testing.assert_allclose(lost, 2 * 0.05 / 1800.0, rtol=0.02)  # 2 F_c / k a half swing


@pytest.mark.slow
def test_a_fit_of_the_engines_decay_finds_what_was_exported(tmp_path: Path) -> None:
    found = let_go(parameters_as(rig(STRAIGHT), "mjcf").decode(), 1e-3)
    noise = np.random.default_rng(1).normal(0.0, 1e-7, len(found))
    rows = np.column_stack([np.arange(len(found)) * EVERY * 1e-4, found + noise])
    np.savetxt(tmp_path / "decay.csv", rows, "%.9g", ",", header="time [s],position [m]", comments="")
    (tmp_path / "rig.yaml").write_text(
        "schema: ssmr-ident/parameters/1\nname: rig\nmass_kg: {value: 2.0, fixed: true}\n"
        "stiffness_N_m: {value: 1500}\ndamping_N_s_m: {value: 5}\n",
        encoding="utf-8",
    )
    (tmp_path / "session.yaml").write_text(
        "schema: ssmr-ident/session/1\nname: engine\nrobot: rig.yaml\nbaseline: sdof\nrecordings:\n"
        "  - {file: decay.csv, experiment: free_response}\n",
        encoding="utf-8",
    )
    fit = fit_session(tmp_path).parameters
    assert fit.number("stiffness_N_m") == pytest.approx(1800.0, rel=0.01)
    assert fit.number("damping_N_s_m") == pytest.approx(3.0, rel=0.01)


def test_the_robot_weighs_in_the_engine_what_the_file_says() -> None:
    robot = read_parameters("p3at-extended")
    model = mujoco.MjModel.from_xml_string(parameters_as(robot, "mjcf").decode())
    assert model.body_subtreemass[0] == pytest.approx(robot.number("mass_kg"), rel=1e-9)
