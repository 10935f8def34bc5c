"""Lanes: what a kernel gives of eight numbers at once is, to the last bit, what it gives of each alone."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest
from numba import njit

from ssmr_ident.core.exponential import exp
from ssmr_ident.core.simd import WIDTH, anywhere, first, lanes_of, lanewise, space, where
from ssmr_ident.experiments.scenario import Scenario
from ssmr_ident.physics.effects import CATALOGUE
from ssmr_ident.physics.robot import Robot, robot_from_parameters
from ssmr_ident.session import read_parameters
from ssmr_ident.simulate.many import Release, simulate_alike, simulate_many
from ssmr_ident.simulate.simulation import simulate
from ssmr_ident.simulate.together import FEWEST

FORMS = {
    "nonlinear_stiffness": ({"k3_N_m3": 1e8}, {"k3_N_m3": 0.0, "knee_share": 0.3, "k3_share_1_m2": 3e4}),
    "dry_friction": ({}, {"slider": 1.0}, {"rounding_m_s": 0.01}),
    "hysteresis": ({}, {"exponent": 1.0, "shape": 0.0}),
    "free_play": ({}, {"share_x": 0.0}),
    "unlisted": (
        {"c_abs_v_N_s_m": 20.0, "c_root_v_N_s05_m05": 5.0, "c_sin_s_N_m": 500.0, "pulse_Hz": 2.0},
        {"c_abs_s_N_m": 500.0, "place_m": 1e-4},
    ),
    "quadratic_damping": ({"d2_N_s2_m2": 50.0},),
    "sensor_misalignment": ({"angle_x_rad": 0.1},),
}
ALL = [(name, values) for name in CATALOGUE if CATALOGUE[name].robot for values in FORMS.get(name, ({},))]


# not kept on disk beside this file, where nobody would throw it away after lanes have changed
kernel = njit(error_model="numpy")


@pytest.fixture(scope="module")
def robot() -> Robot:
    return robot_from_parameters(read_parameters("p3at-extended"))


@kernel
def _own(x, y):
    return math.sin(x) if x > y else x**1.5


_own_in_lanes = lanewise(_own)


@kernel
def _text(p, steps):
    """A bit of everything that a kernel's text may ask of lanes."""
    x, v, most, crossed = p[0], p[1], 0.0, 0.0
    seen = space(p, 2, 2)
    for n in range(steps):
        force = -3.0 * x - 0.1 * v - where(abs(x) > 0.5, x * x / (1.0 + v * v), 0.0)
        v += 0.01 * force
        x = x + 0.01 * v
        most = max(most, math.sqrt(abs(x)))
        rises = (v > 0.0) & (x != 0.0) | (x >= 1.0)
        crossed += where(rises, 1.0, -0.25)
        if anywhere(x < -0.3):
            # a lane is there as well where another one brought it
            seen[1, 0] += where(x < -0.3, min(_own_in_lanes(-x, 0.6), 2.0) * math.tanh(v), 0.0)
        seen[0, 1] = 1.0 * n
    p[0], p[1] = -x, where(math.isfinite(v), exp(v), 0.0)
    p[2], p[3] = most, crossed + seen[0, 1]
    return seen[1, 0]


@kernel
def _text_in_lanes(p, steps):
    p[3] = 0.0
    return first(_text(lanes_of(p, 0), steps))


def test_a_text_in_lanes_gives_the_bits_that_it_gives_alone() -> None:
    numbers = np.random.default_rng(5).standard_normal((4, WIDTH))
    together, alone = numbers.copy(), numbers.copy()
    common = _text_in_lanes(together, 700)
    for column in range(WIDTH):
        own = alone[:, column].copy()
        found = _text(own, 700)
        if column == 0:
            assert found == common
        np.testing.assert_array_equal(together[:, column], own)


def test_the_exponential_is_the_library_s_within_its_last_bit() -> None:
    random = np.random.default_rng(1)
    for x in np.concatenate([random.uniform(-707.0, 707.0, 3000), random.uniform(-1.0, 1.0, 3000), [0.0, -0.0]]):
        assert abs(exp(x) - math.exp(x)) <= 1.5 * np.spacing(math.exp(x))
    assert exp(-math.inf) == exp(-709.0) == 0.0
    assert exp(math.inf) == exp(800.0) == math.inf
    assert math.isnan(exp(math.nan))


@pytest.mark.parametrize(("effect", "values"), ALL, ids=[f"{name}-{len(values)}" for name, values in ALL])
def test_releases_in_lanes(robot: Robot, effect: str, values: dict[str, float]) -> None:
    random = np.random.default_rng(2)
    releases = []
    for k in range(FEWEST + 1):
        away, moving = 1e-3 * random.standard_normal(12), 0.05 * random.standard_normal(8)
        heavier = replace(robot, mass=robot.mass + 0.1 * k)
        releases.append(Release(heavier, {effect: values}, away, moving))
    together = simulate_many(releases, 0.15, 500.0, 2.5e-4, ("ax", "wy"))
    alone = [simulate_many([one], 0.15, 500.0, 2.5e-4, ("ax", "wy"))[0] for one in releases]
    np.testing.assert_array_equal(together, alone)
    assert np.isfinite(together).all()


@pytest.mark.parametrize("sliding_speed", [0.0, 0.01])
@pytest.mark.parametrize("direction", ["lateral", "longitudinal"])
def test_pulls_in_lanes(robot: Robot, sliding_speed: float, direction: str) -> None:
    acting = [(name, values) for name, values in ALL if {"pull", "free_response"} & set(CATALOGUE[name].experiments)]
    head = np.linspace(0.0, 0.012, 120)
    for effect, values in acting:
        pulls = [
            (
                replace(robot, sliding_speed=sliding_speed, mu_static=0.5 + 0.02 * k),
                {effect: values},
                Scenario(
                    "pull", 1.2, head=np.maximum(head - 1e-3 * k, 0.0), head_step=0.01, direction=direction, height=0.2
                ),
            )
            for k in range(FEWEST)
        ]
        together = simulate_alike(pulls, 100.0, 1e-3, ("force",))[:, :, 0]
        alone = [simulate(body, one, 100.0, 1e-3, effects)["force"] for body, effects, one in pulls]
        np.testing.assert_array_equal(together, alone, err_msg=effect)
        assert np.ptp(together) > 10.0


@pytest.mark.parametrize("sliding_speed", [0.0, 0.3])
def test_swivels_over_uneven_floors_in_lanes(robot: Robot, sliding_speed: float) -> None:
    """Each on a floor of its own, of its own height."""
    robot = replace(robot, sliding_speed=sliding_speed)
    rates = np.array([[-3.0, 3.0]])
    heights = [(1e-4 * (1 + k % 3), 1.0 + k % 2) for k in range(WIDTH + FEWEST)]
    floors = [{"ground_roughness": {"height_m": height, "seed": seed}} for height, seed in heights]
    for effect in (
        {},
        {"ground_joints": {"depth_m": 2e-4, "pitch_m": 0.02}},
        {"wheel_eccentricity": {"eccentricity_m": 3e-4}},
        {"wheel_lift": {}, "flexible_mast": {"f_mast_Hz": 9.0}},
    ):
        runs = [(robot, {**floor, **effect}, Scenario("swivel", 0.6, wheel_rates=rates)) for floor in floors]
        together = simulate_alike(runs, 500.0, 5e-4, ("ay", "load_1"))
        alone = [simulate(body, one, 500.0, 5e-4, effects) for body, effects, one in runs]
        np.testing.assert_array_equal(together, [np.column_stack([one["ay"], one["load_1"]]) for one in alone])
        assert len({one.tobytes() for one in together}) == 6  # two floors of three heights


def test_runs_that_are_not_alike_do_not_share_lanes(robot: Robot) -> None:
    """A lane asks the first one what is on: friction in three forms, play, and friction that is off."""
    effects = [
        {"dry_friction": {"F_c_N": 3.0}},
        {"dry_friction": {"F_c_N": 3.0, "slider": 1.0}},
        {"dry_friction": {"F_c_N": 3.0, "rounding_m_s": 0.01}},
        {"dry_friction": {"F_c_N": 0.0}},
        {"free_play": {"gap_m": 2e-4}},
        {"free_play": {"gap_m": 2e-4, "share_x": 0.0}},
    ]
    away, moving = np.zeros(12), np.zeros(8)
    away[:2] = 2e-3
    releases = [Release(robot, one, away, moving) for one in effects * FEWEST]
    together = simulate_many(releases, 0.15, 500.0, 2.5e-4, ("ax", "ay"))
    alone = [simulate_many([one], 0.15, 500.0, 2.5e-4, ("ax", "ay"))[0] for one in releases]
    np.testing.assert_array_equal(together, alone)
    assert len({one.tobytes() for one in together}) == len(effects)


def test_a_lane_that_bursts_spoils_no_other(robot: Robot) -> None:
    away, moving = np.zeros(12), np.zeros(8)
    away[1] = 1e-3
    wild = replace(robot, damping=np.array([1e9, 1e9, 1e9]))
    releases = [Release(one, {}, away, moving) for one in (robot, wild, robot, robot)]
    found = simulate_many(releases, 0.15, 500.0, 2.5e-4, ("ay",))
    assert np.isnan(found[1]).all()
    assert np.isfinite(found[[0, 2, 3]]).all()
    np.testing.assert_array_equal(found[0], found[2])
