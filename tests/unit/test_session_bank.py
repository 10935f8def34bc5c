"""The benchmark's own plants agree with the simulator, and its sessions are what they say."""

from __future__ import annotations

import numpy as np
import pytest
from bank import KINDS, draw
from bank.laws import law, laws
from bank.rig_plant import run_rig
from bank.robot_plant import run_robot
from bank.robots import draw_robot

from ssmr_ident.experiments.free_response import released
from ssmr_ident.physics.linear import COORDINATES
from ssmr_ident.physics.rig import Rig
from ssmr_ident.signals.grid import band_limited
from ssmr_ident.simulate import simulate
from ssmr_ident.simulate.rig import simulate_rig

RIG = Rig(8.0, 50.0, 2e4)
SAME = {
    "nonlinear_stiffness": ({"k3_N_m3": 4e9}, law("cubic", 4e9)),
    "dry_friction": ({"F_c_N": 0.5, "element_stiffness_N_m": 2e5}, law("dahl", 0.5, 2e5)),
    "hysteresis": ({"alpha": 0.8, "yield_m": 4e-4}, law("bouc_wen", 4e3, 4e-4, 2.0, 0.5)),
    "quadratic_damping": ({"d2_N_s2_m2": 600.0}, law("quadratic", 600.0)),
    "viscoelastic_relaxation": ({"K_m_N_m": 3e3, "tau_s": 0.02}, law("maxwell", 3e3, 0.02)),
    "free_play": ({"gap_m": 3e-4, "rounding": 0.1}, law("rounded_play", 2e4, 1.5e-4, 3e-5)),
}


@pytest.fixture(scope="module")
def force() -> np.ndarray:
    rough = np.random.default_rng(3).standard_normal(200)
    return 10.0 * band_limited(rough, 10)[:1500]


@pytest.mark.parametrize("effect", SAME)
def test_rig_plant_agrees_with_the_simulator(effect: str, force: np.ndarray) -> None:
    parameters, row = SAME[effect]
    ours = run_rig(RIG, force, 1000.0, laws(row))
    theirs = simulate_rig(RIG, force, 1000.0, effects={effect: parameters}, oversampling=16)
    without = simulate_rig(RIG, force, 1000.0)
    size = theirs.std(axis=0)
    assert np.abs(ours - theirs).max(axis=0) / size == pytest.approx(0.0, abs=3e-4)
    assert ((ours - without).std(axis=0) / size).min() > 0.01


def test_stranger_laws_do_what_they_say(force: np.ndarray) -> None:
    slider = run_rig(RIG, force, 1000.0, laws(law("jenkins", 0.5, 2e5)))
    dahl = run_rig(RIG, force, 1000.0, laws(law("dahl", 0.5, 2e5)))
    coulomb = run_rig(RIG, force, 1000.0, laws(law("tanh_friction", 0.5, 1e-4)))
    linear = run_rig(RIG, force, 1000.0, laws())
    apart = np.std(slider[:, 0] - dahl[:, 0])
    # three formulas of one physics: near to each other, far from none
    assert apart < 0.5 * np.std(slider[:, 0] - linear[:, 0])
    assert np.std(coulomb[:, 0] - slider[:, 0]) < 0.5 * np.std(coulomb[:, 0] - linear[:, 0])
    sharp, soft = (law("play", 2e4, 1e-4), law("smooth_play", 2e4, 1e-4, 1e-6))
    play, rounded = (run_rig(RIG, force, 1000.0, laws(row))[:, 0] for row in (sharp, soft))
    assert np.abs(play - rounded).max() / play.std() < 0.01


@pytest.mark.slow
@pytest.mark.parametrize("motion", ["roll", "pitch", "yaw"])
def test_robot_plant_agrees_with_the_simulator(motion: str) -> None:
    robot, _, _ = draw_robot(np.random.default_rng(1))
    scenario = released(robot, motion, 12.0, 0.6)
    start = np.array([scenario.offset[name] for name in COORDINATES] + [0.0] * 6)
    for effects, row, upright in (
        ({}, law("quadratic", 0.0), 0.0),
        ({"nonlinear_stiffness": {"k3_N_m3": 1e9}}, law("cubic", 1e9), 1.0),
        ({"dry_friction": {"F_c_N": 1.0, "element_stiffness_N_m": 3e5}}, law("dahl", 1.0, 3e5), 0.0),
    ):
        theirs = simulate(robot, scenario, step=5e-5, effects=effects).values[:, :3]
        ours, used = run_robot(robot, start, 0.6, 1000.0, laws(row), laws(row), laws(upright * row))
        assert used < 1.0
        assert np.abs(ours - theirs).max() < 1e-3 * np.abs(theirs - theirs[-1]).max()


@pytest.mark.parametrize("family", KINDS)
def test_sessions_follow_their_seed_and_hide_their_truth(family: str) -> None:
    kinds = KINDS[family]
    drawn = [draw(family, kind, 21, short=True) for kind in kinds if kind in ("none", "one")]
    again = draw(family, drawn[-1].kind, 21, short=True)
    for one, other in zip(drawn[-1].campaign.measurements, again.campaign.measurements, strict=True):
        for name in one.recording.names:
            assert np.array_equal(one.recording[name], other.recording[name])
    for session in drawn:
        assert session.campaign.session.name == "bank-21"
        assert not session.campaign.parameters.effects
        assert all(0.0 < floor < 100.0 for floor in session.truth.noise_floor.values())
        assert any(m.entry.role == "heldout" for m in session.campaign.measurements)
