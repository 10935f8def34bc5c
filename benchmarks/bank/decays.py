"""Random sessions of a robot that is pushed or turned, let go, and swings."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np

from bank.disturbances import random_accelerometer
from bank.laws import laws
from bank.robot_physics import DECAYS, OTHER, PAIRS, UNLISTED, Left
from bank.robot_plant import run_robot
from bank.robots import draw_robot, true_values
from bank.scaled import AS_IT_IS, Scale
from bank.truth import BankSession, Made, Truth, recording
from ssmr_ident.core.errors import SimulationError
from ssmr_ident.experiments import Scenario
from ssmr_ident.experiments.campaign import Campaign
from ssmr_ident.physics.linear import COORDINATES, linear_robot
from ssmr_ident.physics.robot import GRAVITY, Robot
from ssmr_ident.session import Entry, Session
from ssmr_ident.simulate import simulate

PLAN = [(motion, trial, "target") for motion in ("roll", "pitch", "yaw") for trial in (1, 2, 3)]
PLAN += [("roll", 4, "heldout"), ("roll", 5, "heldout"), ("pitch", 4, "heldout"), ("yaw", 4, "heldout")]
SHORT = [("roll", 1, "target"), ("roll", 2, "target"), ("pitch", 1, "target"), ("yaw", 1, "target")]
SHORT += [("pitch", 2, "heldout"), ("yaw", 2, "heldout")]
PEAK = {"roll": (1.5, 3.5), "pitch": (1.5, 3.0), "yaw": (1.5, 5.0)}
"""Largest acceleration of a release [m/s²]."""

AXES = ("ax", "ay", "az")


def draw_decays(
    kind: str, seed: int, effect: str | None, size: float | None, short: bool, scale: Scale = AS_IT_IS
) -> BankSession:
    """Nine decays to fit and four held out; ``short`` ones are six of a second and a half. Of a robot of another scale
    the truth's numbers are those of the robot that it was scaled from."""
    return _decays(kind, seed, effect, size, short, "rigid6", scale)


def draw_decoupled(kind: str, seed: int, effect: str | None, size: float | None, short: bool) -> BankSession:
    """The same robot against pure rotations (5.3), which leave the translation out."""
    return _decays("one", seed, "translation_coupling", size, short, "decoupled")


def _decays(
    kind: str,
    seed: int,
    effect: str | None,
    size: float | None,
    short: bool,
    baseline: str,
    scale: Scale = AS_IT_IS,
) -> BankSession:
    random = np.random.default_rng([seed, 1])
    robot, file, gains = draw_robot(random)
    left, size = choose(kind, effect, size, robot, random)
    plan = SHORT if short else PLAN
    rate = float(random.choice([1000.0, 1000.0, 500.0])) if not short else 500.0
    seconds = float(random.choice([4.096, 4.096, 3.0])) if not short else 1.6
    lifted = None
    if "wheel_lift" in left.effects:
        lifted = 1.05 * (1.8 / 1.05) ** size
    starts = [release(robot, motion, random, lifted) for motion, _, _ in plan]
    left, runs = _standing(robot, starts, seconds, rate, left, slides=lifted is not None)
    if "sensor_saturation" in left.effects:
        # az carries gravity: what clips is what goes beyond it
        share = left.effects["sensor_saturation"]["share_of_peak"]
        limit = GRAVITY + share * (max(float(np.abs(run).max()) for run in runs) - GRAVITY)
        left = replace(left, effects={"sensor_saturation": {"range_m_s2": limit}})
        runs = [np.clip(run, -limit, limit) for run in runs]
    sensor = random_accelerometer(random)
    logged_at = rate / scale.time
    made = []
    for (motion, trial, role), run in zip(plan, runs, strict=True):
        name = f"{motion}-{trial}.csv"
        clean = {axis: run[:, index] * gains[index] for index, axis in enumerate(AXES)}
        logged = {axis: (sensor.add(samples, logged_at, random), "m/s^2") for axis, samples in clean.items()}
        entry = Entry(name, "free_response", role=role, trial=trial, motion=motion)
        if baseline == "decoupled":  # (5.3) is read from one channel
            main = {"roll": "ay", "pitch": "ax", "yaw": "ay"}[motion]
            clean = {main: clean[main]}
        made.append(Made(entry, recording(name, logged_at, **logged), clean))
    session = Session(f"bank-{seed}", Path("bank"), "robot.yaml", baseline, tuple(one.entry for one in made))
    campaign = Campaign(session, scale.known(file), tuple(one.measurement for one in made))
    effects = {"translation_coupling": {}} if baseline == "decoupled" else left.effects
    truth = Truth(
        "missing_physics" if effects else "nothing_missing",
        effects,
        left.formula,
        true_values(robot),
        {one.entry.file: one.noise_floor for one in made},
    )
    return BankSession("decays" if baseline == "rigid6" else "decoupled", kind, seed, size, campaign, truth)


def _standing(
    robot: Robot, starts: list[np.ndarray], seconds: float, rate: float, left: Left, slides: bool
) -> tuple[Left, list[np.ndarray]]:
    """The runs, with half of the softening as long as the robot falls over: that makes no recording."""
    while True:
        try:
            return left, [_run(robot, start, seconds, rate, left, slides) for start in starts]
        except SimulationError:
            k3 = left.effects.get("nonlinear_stiffness", {}).get("k3_N_m3", 0.0)
            if not k3 < 0.0:
                raise
            left = replace(left, effects={**left.effects, "nonlinear_stiffness": {"k3_N_m3": 0.5 * k3}})


def choose(
    kind: str, effect: str | None, size: float | None, robot: Robot, random: np.random.Generator
) -> tuple[Left, float]:
    """Physics of a kind; where no size is asked for it is drawn evenly."""
    size = float(random.uniform()) if size is None else size
    if kind == "none" or effect == "translation_coupling":
        return Left({}), 0.0
    if kind == "one":
        name = effect or str(random.choice(list(DECAYS)))
        return Left({name: DECAYS[name](size, random)}), size
    if kind == "two":
        pair = PAIRS[int(random.integers(len(PAIRS)))]
        return Left({name: DECAYS[name](max(size, 0.4), random) for name in pair}), size
    table = OTHER if kind == "other" else UNLISTED
    formula = str(random.choice(list(table)))
    name, make = table[formula]
    state = random.bit_generator.state
    rows = []
    for k in robot.stiffness:
        random.bit_generator.state = state  # the same shape on every axis
        rows.append(laws(make(size, float(k), random)))
    if name != "nonlinear_stiffness":
        rows[2] = 0.0 * rows[2]  # upright a tire knows stiffness only
    return Left({name: {}}, (rows[0], rows[1], rows[2]), formula), size


def release(robot: Robot, motion: str, random: np.random.Generator, lifted: float | None) -> np.ndarray:
    """Displacements at the release, (6,): a push or a turn as two hands make it, no two alike.

    Scaled to the peak acceleration drawn, or for ``lifted`` to that multiple of the motion at which the linear
    robot's first wheel would carry nothing.
    """
    force, point, moment = np.zeros(3), np.zeros(3), np.zeros(3)
    if motion == "roll":
        force[1], point = 1.0, np.array([random.normal(0.04, 0.015), 0.0, random.normal(0.6, 0.03)])
    elif motion == "pitch":
        force[0], point = 1.0, np.array([0.0, random.normal(0.0, 0.02), random.uniform(0.15, 0.25)])
    else:
        moment = np.array([random.normal(0.0, 0.1), random.normal(0.0, 0.03), 1.0])
    linear = linear_robot(robot)
    offset = np.linalg.solve(linear.stiffness, np.concatenate([force, np.cross(point, force) + moment]))
    sign = random.choice([-1.0, 1.0])
    if lifted is not None and motion != "yaw":
        sinks = [offset[2] + offset[3] * p[1] - offset[4] * p[0] for p in robot.contact_points]
        depth = robot.mass * GRAVITY / 4.0 / robot.stiffness[2]
        return offset * sign * lifted * random.uniform(0.7, 1.0) * depth / max(np.abs(sinks))
    acceleration = linear.state_matrix[6:, :6] @ offset
    levers = acceleration[:3] + np.cross(acceleration[3:], robot.accelerometer.position)
    return offset * sign * random.uniform(*PEAK[motion]) / np.abs(levers).max()


def _run(robot: Robot, start: np.ndarray, seconds: float, rate: float, left: Left, slides: bool) -> np.ndarray:
    """(n, 3) specific forces; a release that would make a contact slide is made smaller."""
    for _ in range(12):
        if left.rows is not None:
            run, used = run_robot(robot, np.concatenate([start, np.zeros(6)]), seconds, rate, *left.rows)
            slid = not used < 1.0
        else:
            effects = {name: values for name, values in left.effects.items() if name != "sensor_saturation"}
            offset = dict(zip(COORDINATES, map(float, start), strict=True))
            simulation = simulate(robot, Scenario("free_response", seconds, offset=offset), rate, effects=effects)
            run, slid = simulation.values[:, :3], bool(simulation["sliding"].any())
        if slides or not slid:
            return run
        start = 0.8 * start
    raise RuntimeError("contacts slide however small the release is")
