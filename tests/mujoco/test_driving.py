"""Driven wheels: what a relay per axis (6.4) and Coulomb's cone can and cannot have in common."""

from __future__ import annotations

import numpy as np
import pytest

from ssmr_ident.experiments.straight import straight
from ssmr_ident.experiments.swivel import swivel
from ssmr_ident.physics.motor import wheel_rates
from ssmr_ident.physics.robot import GRAVITY, Robot
from ssmr_ident.simulate import simulate
from ssmr_ident.simulate.mjcf.build import Build
from ssmr_proof.mujoco_run import run_mujoco

pytestmark = [pytest.mark.slow, pytest.mark.usefixtures("engine")]


def _rolling(friction: str) -> Build:
    return Build(tires="strut", driven=True, friction=friction)


def test_a_swivel_starts_alike_while_nothing_slides(gripping: Robot) -> None:
    wanted = wheel_rates(gripping, 0.0, np.radians(45.0))
    ours = simulate(gripping, swivel(wanted, 0.2), step=1e-4, effects={"coriolis": {}})
    theirs = run_mujoco(gripping, 0.2, _rolling("grip"), wheel_rates=wanted)
    for name in ("yaw", "wz"):
        assert np.abs(ours[name] - theirs[name]).max() < 0.01 * np.ptp(ours[name])
    assert np.abs(ours["ay"] - theirs["ay"]).max() < 0.02 * np.ptp(ours["ay"])


def test_driving_off_straight_agrees(gripping: Robot) -> None:
    wanted = wheel_rates(gripping, 0.3, 0.0)
    ours = simulate(gripping, straight(wanted, 3.0), step=1e-4)
    theirs = run_mujoco(gripping, 3.0, _rolling("grip"), wheel_rates=wanted)
    assert theirs["x"][-1] == pytest.approx(ours["x"][-1], rel=0.01)
    assert np.abs(ours["ax"] - theirs["ax"]).max() < 0.02 * np.ptp(ours["ax"])


def test_loads_differ_by_the_tires_deflection_alone(gripping: Robot) -> None:
    """MuJoCo's wheel carries its load where it stands, the thesis' law (2.53) at the undeflected p_i; K_x ten times
    as stiff takes nine tenths of the deflection away, and with it of the difference."""
    wanted = wheel_rates(gripping, 0.3, 0.0)
    differences = []
    for factor in (1.0, 10.0):
        stiffness = gripping.stiffness * np.array([factor, 1.0, 1.0])
        robot = gripping.with_changes(stiffness=stiffness, damping=gripping.damping * np.array([factor, 1.0, 1.0]))
        ours = simulate(robot, straight(wanted, 2.0), step=1e-4)
        theirs = run_mujoco(robot, 2.0, _rolling("grip"), wheel_rates=wanted)
        differences.append(np.abs(ours["load_1"] - theirs["load_1"]).max() / np.ptp(ours["load_1"]))
    assert 0.05 < differences[0] < 0.15
    assert differences[1] < 0.02


def test_each_friction_law_turns_as_its_own_closed_form_says(even: Robot) -> None:
    """A slow swivel on four sliding wheels at (±a, ±c), moment balance c·f_x = a·f_y.

    Coulomb's cone: the force opposes the slip, so f_x/f_y = s_x/s_y with s_y = a·r and s_x = rim speed - c·r; the yaw
    rate is 1/(1 + (a/c)²) of what the wheels ask for, and the moment of the side forces a·mu·m·g/√(1 + (a/c)²).
    Relay per axis: f_x < mu N sticks, so the yaw rate is the whole, and the moment a·mu·m·g.
    """
    a, c = 0.14, 0.18
    wanted = wheel_rates(even, 0.0, 0.1)
    full = a * even.mu_static * even.mass * GRAVITY
    theirs = run_mujoco(even, 4.0, _rolling("cone"), wheel_rates=wanted)
    part = theirs.time > 3.0
    turning = np.polyfit(theirs.time[part], theirs["yaw"][part], 1)[0] / 0.1
    assert turning == pytest.approx(1.0 / (1.0 + (a / c) ** 2), rel=0.02)
    moment = -sum(theirs[f"tire_y_{i + 1}"] * even.contact_points[i, 0] for i in range(4))
    assert np.abs(moment[part].mean()) == pytest.approx(full / np.sqrt(1.0 + (a / c) ** 2), rel=0.01)

    ours = simulate(even, swivel(wanted, 8.0), step=1e-4, effects={"coriolis": {}})
    part = ours.time > 4.0
    assert np.polyfit(ours.time[part], ours["yaw"][part], 1)[0] / 0.1 == pytest.approx(1.0, rel=0.02)
    for run in (ours, theirs):
        names = [f"load_{i}" if run is ours else f"touch_{i}" for i in (1, 2, 3, 4)]
        half = run.time > 3.0
        loads = np.array([run[name][half].mean() for name in names])
        assert loads == pytest.approx(even.mass * GRAVITY / 4.0, rel=0.02)
