"""Rigs, single wheels and blocks against scipy's integrators and closed forms."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest
from scipy.integrate import solve_ivp
from scipy.special import ellipk

from ssmr_ident.core.errors import InputError, SimulationError
from ssmr_ident.identify.trials.pull import QUICK
from ssmr_ident.physics.rig import Block, Rig
from ssmr_ident.physics.robot import Robot, robot_from_parameters
from ssmr_ident.session import read_parameters
from ssmr_ident.signals.grid import band_limited
from ssmr_ident.simulate.bench import compress_wheel, drag_wheel, pull_block
from ssmr_ident.simulate.rig import simulate_rig

RATE = 1000.0
TIME = np.arange(2000) / RATE
RIG = Rig(8.0, 50.0, 20000.0)


@pytest.fixture(scope="module")
def robot() -> Robot:
    return robot_from_parameters(read_parameters("p3at-extended"))


def _force(t: np.ndarray) -> np.ndarray:
    return 20.0 * np.sin(2 * np.pi * 5.0 * t) + 8.0 * np.sin(2 * np.pi * 11.0 * t + 1.0)


def _reference(beside: object = lambda x, v: 0.0) -> np.ndarray:
    def rate(t: float, y: np.ndarray) -> list[float]:
        x, v = y
        return [v, (_force(t) - RIG.damping * v - RIG.stiffness * x - beside(x, v)) / RIG.mass]

    return solve_ivp(rate, (0, TIME[-1]), [1e-3, 0.0], "DOP853", TIME, rtol=1e-10, atol=1e-13).y


def test_a_linear_rig_is_exact() -> None:
    motion = simulate_rig(RIG, _force(TIME), RATE, position=1e-3)
    x, v = _reference()
    inner = slice(20, -20)  # the mirror at the ends is not what the force did before and after
    assert motion[inner, 0] == pytest.approx(x[inner], abs=2e-4 * np.abs(x).max())
    assert motion[inner, 1] == pytest.approx(v[inner], abs=2e-4 * np.abs(v).max())
    acceleration = (_force(TIME) - RIG.damping * v - RIG.stiffness * x) / RIG.mass
    assert motion[inner, 2] == pytest.approx(acceleration[inner], abs=2e-4 * np.abs(acceleration).max())


@pytest.mark.parametrize(("friction", "share", "apart"), [(2.0, 0.0, 1e-3), (12.0, 0.1, 2e-3), (25.0, 0.6, 4e-3)])
def test_friction_holds_a_rig_at_rest(friction: float, share: float, apart: float) -> None:
    def rate(t: float, y: np.ndarray) -> list[float]:
        rubs = friction * np.tanh(y[1] / 1e-4)
        return [y[1], (_force(t) - RIG.damping * y[1] - RIG.stiffness * y[0] - rubs) / RIG.mass]

    true = solve_ivp(rate, (0, TIME[-1]), [2e-3, 0.0], "LSODA", TIME, rtol=1e-9, atol=1e-12).y
    assert share <= np.mean(np.abs(true[1]) < 1e-4) < share + 0.3
    own = simulate_rig(
        RIG, _force(TIME), RATE, position=2e-3, effects={"dry_friction": {"F_c_N": friction, "rounding_m_s": 1e-4}}
    )
    inner = slice(20, -20)
    assert np.std(own[inner, 1] - true[1, inner]) < apart * np.std(true[1])


@pytest.mark.parametrize(
    ("effects", "beside"),
    [
        ({"nonlinear_stiffness": {"k3_N_m3": 2e9}}, lambda x, v: 2e9 * x**3),
        ({"quadratic_damping": {"d2_N_s2_m2": 400.0}}, lambda x, v: 400.0 * v * abs(v)),
    ],
)
def test_effects_on_a_rig_follow_their_equation(effects: dict, beside: object) -> None:
    motion = simulate_rig(RIG, _force(TIME), RATE, position=1e-3, effects=effects)
    x, _ = _reference(beside)
    plain, _ = _reference()
    assert np.abs(x - plain).max() > 0.05 * np.abs(x).max()
    assert np.abs(motion[20:-20, 0] - x[20:-20]).max() < 1e-3 * np.abs(x).max()


@pytest.mark.parametrize(
    "effects",
    [
        {"nonlinear_stiffness": {"k3_N_m3": 2e9}},
        {"quadratic_damping": {"d2_N_s2_m2": 400.0}},
        {"hysteresis": {"alpha": 0.8, "yield_m": 1e-3}},
    ],
)
def test_oversampling_converges_with_an_effect(effects: dict) -> None:
    runs = [simulate_rig(RIG, _force(TIME), RATE, 1e-3, oversampling=n, effects=effects)[:, 0] for n in (2, 4, 8)]
    coarse, fine = np.abs(runs[0] - runs[1]).max(), np.abs(runs[1] - runs[2]).max()
    assert np.log2(coarse / fine) > 1.7


def test_a_spring_that_hardens_is_followed_to_the_fourth_order() -> None:
    """Against scipy's DOP853, from 27 steps a period of the rig on."""
    rate, turning, phases = 400.0, 2.0 * math.pi * np.arange(8.0, 22.0, 1.3), np.arange(11) ** 2.0
    rig, k3 = Rig(1.5, 3.0, 1.5 * (2.0 * math.pi * 15.0) ** 2), 2e7

    def force(time: np.ndarray) -> np.ndarray:
        return np.asarray(5.0 * np.sin(np.multiply.outer(time, turning) + phases).sum(axis=-1))

    def rate_of(t: float, y: np.ndarray) -> list[float]:
        return [y[1], float(force(t) - rig.damping * y[1] - rig.stiffness * y[0] - k3 * y[0] ** 3) / rig.mass]

    time, off = np.arange(300) / rate, []
    true = solve_ivp(rate_of, (0, time[-1]), [0.0, 0.0], "DOP853", time, rtol=1e-11, atol=1e-14).y
    for finer in (2, 4, 8):
        given = force(np.arange(299 * finer + 1) / (rate * finer))
        effects = {"nonlinear_stiffness": {"k3_N_m3": k3}}
        found = simulate_rig(rig, given, rate, oversampling=finer, effects=effects, fine=True)
        off.append([np.std(found[:, k] - true[k]) / np.std(true[k]) for k in (0, 1)])
    order = np.log2(np.divide(off[:-1], off[1:]))
    assert order[:, 0].min() > 3.8
    assert order[:, 1].min() > 2.8  # the rise of the force is that of the step before
    assert max(off[0]) < 5e-5


def test_band_limited_samples_lie_on_the_curve() -> None:
    factor = 8
    fine = band_limited(_force(TIME), factor)
    t = np.arange(len(fine)) / (RATE * factor)
    assert np.array_equal(np.round(fine[::factor], 9), np.round(_force(TIME), 9))
    inner = slice(40 * factor, -40 * factor)
    assert np.abs(fine - _force(t))[inner].max() < 2e-4 * np.abs(_force(t)).max()


def test_a_mass_without_a_spring_obeys_newton() -> None:
    motion = simulate_rig(Rig(2.0, 0.0, 0.0), np.full(1000, 4.0), RATE)
    t = np.arange(1000) / RATE
    assert motion[:, 0] == pytest.approx(t**2, abs=1e-12)
    assert motion[:, 2] == pytest.approx(2.0)


def test_a_pendulum_has_the_period_of_the_elliptic_integral() -> None:
    """T = 4 K(sin²(A/2))/ω for a swing to A; at 160 degrees twice that of a small one."""
    omega, rate, top = 5.0, 2000.0, math.radians(160.0)
    rig = Rig(1.0, 0.0, omega**2, rotary=True)
    run = simulate_rig(rig, np.zeros(int(8.0 * rate)), rate, top, effects={"nonlinear_stiffness": {"sine_share": 1.0}})
    angle = run[:, 0]
    up = np.flatnonzero((angle[:-1] < 0.0) & (angle[1:] >= 0.0))
    crossing = up - angle[up] / (angle[up + 1] - angle[up])
    expected = 4.0 * ellipk(math.sin(0.5 * top) ** 2) / omega
    assert np.diff(crossing).mean() / rate == pytest.approx(expected, rel=1e-5)
    assert expected > 2.0 * 2.0 * math.pi / omega
    with pytest.raises(InputError, match="of a rig that turns"):
        simulate_rig(Rig(1.0, 0.0, omega**2), np.zeros(9), rate, effects={"nonlinear_stiffness": {"sine_share": 1.0}})


def test_an_effect_that_no_rig_has_is_refused() -> None:
    with pytest.raises(InputError, match="does not act on a rig"):
        simulate_rig(RIG, _force(TIME), RATE, effects={"wheel_lift": {}})


def test_a_rig_that_runs_away_says_so() -> None:
    with pytest.raises(SimulationError, match=r"t = .*nonlinear_stiffness"):
        simulate_rig(RIG, 1e3 * _force(TIME), RATE, effects={"nonlinear_stiffness": {"k3_N_m3": -9e9}})


def test_a_dragged_wheel_rises_with_its_stiffness_and_lets_go_at_the_limit(robot: Robot) -> None:
    step, speed = 0.01, 1e-3
    head = speed * step * np.arange(1600)
    force = drag_wheel(robot, head, step)
    load = robot.mass * 9.8 / 4
    assert np.polyfit(head[20:200], force[20:200], 1)[0] == pytest.approx(robot.stiffness[1], rel=1e-6)
    assert force.max() == pytest.approx(robot.mu_static * load, abs=robot.stiffness[1] * speed * step)
    # a sample that falls into the millisecond of a release sees the hub unloaded; the others stay above the lower limit
    below = force[500:] < robot.mu_kinetic * load - 0.1
    assert below.mean() < 0.03
    assert force[500:][~below].min() == pytest.approx(
        robot.mu_kinetic * load, abs=2 * robot.stiffness[1] * speed * step
    )
    held = drag_wheel(robot, head, step, free_normal=False)
    assert held[-1] == pytest.approx(robot.stiffness[1] * head[-1] + robot.damping[1] * speed, rel=1e-3)


def test_a_rope_adds_its_compliance_to_a_dragged_wheel(robot: Robot) -> None:
    """(3.9): two springs in series."""
    head = 1e-5 * np.arange(300)
    force = drag_wheel(robot, head, 0.01, effects={"cable_compliance": {"K_cable_N_m": 6000.0}})
    tire = robot.stiffness[1]
    assert np.polyfit(head[50:], force[50:], 1)[0] == pytest.approx(6000.0 * tire / (6000.0 + tire), rel=1e-3)


@pytest.mark.parametrize(
    "effects",
    [
        {},
        {"dry_friction": {"F_c_N": 8.0, "element_stiffness_N_m": 1e4}},
        {"viscoelastic_relaxation": {"K_m_N_m": 8000.0, "tau_s": 0.02}},
        {"hysteresis": {"alpha": 0.6, "yield_m": 1e-3}},
        {"free_play": {"gap_m": 1e-3}},
        {"stribeck": {"kinetic_share": 0.8, "stribeck_velocity_m_s": 2e-3}},
    ],
    ids=lambda effects: next(iter(effects), "none"),
)
@pytest.mark.parametrize("damping", [0.3, 1.0])
def test_the_long_steps_of_a_fit_say_the_same(robot: Robot, effects: dict, damping: float) -> None:
    """A load cell's noise is some 0.5 N; where friction falls with the speed, steps are not lengthened."""
    soft = replace(robot, damping=tuple(damping * d for d in robot.damping))
    head = 1e-3 * np.maximum(5e-3 * np.arange(3000) - 0.5, 0.0)
    fine, quick = (drag_wheel(soft, head, 5e-3, effects=effects, longest=s) for s in (None, QUICK))
    assert quick == pytest.approx(fine, abs=0.2)
    assert np.sqrt(np.mean((quick - fine) ** 2)) < 0.1


def test_a_force_of_no_list_acts_on_a_dragged_wheel(robot: Robot) -> None:
    head = 1e-5 * np.arange(300)
    plain = drag_wheel(robot, head, 0.01)
    force = drag_wheel(robot, head, 0.01, effects={"unlisted": {"c_s2_N_m2": 4e5}})
    assert force[50:] - plain[50:] == pytest.approx(4e5 * head[50:] ** 2, rel=1e-6, abs=1e-9)


def test_a_pressed_wheel_follows_spring_and_damper(robot: Robot) -> None:
    head = np.concatenate([np.zeros(10), 1e-5 * np.arange(1, 200), np.full(20, 2e-3)])
    force = compress_wheel(robot, head, 0.01, gap=5e-4)
    assert force[20] == 0.0
    assert force[-1] == pytest.approx(robot.stiffness[2] * 1.5e-3, rel=1e-9)
    assert force[150] == pytest.approx(robot.stiffness[2] * (head[150] - 5e-4) + robot.damping[2] * 1e-3, rel=1e-9)


def test_a_block_is_pulled_with_its_friction() -> None:
    head = 2e-6 * np.arange(4000)
    stiff = pull_block(Block(1.1, 0.4, 0.3, np.inf), head, 0.01)
    assert stiff[10:-10] == pytest.approx(0.3 * 1.1 * 9.8)
    still = pull_block(Block(1.1, 0.4, 0.3, np.inf), np.round(head, 5), 0.01)  # an encoder with coarse steps
    assert still[10:-10] == pytest.approx(0.3 * 1.1 * 9.8)
    soft = pull_block(Block(1.1, 0.3, 0.3, 8e4, 60.0), head, 0.01)
    rise = np.polyfit(head[3:16], soft[3:16], 1)[0]
    assert rise == pytest.approx(8e4, rel=1e-3)
    assert soft[1000:-1] == pytest.approx(0.3 * 1.1 * 9.8, rel=1e-3)
