"""Pulls of the robot by a testing machine."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from ssmr_ident.core.recording import Channel
from ssmr_ident.physics.robot import GRAVITY, Robot
from ssmr_proof.drawn.cases import Case
from ssmr_proof.lab.decays import changed
from ssmr_proof.lab.logs import Log
from ssmr_proof.lab.robots import Drawn
from ssmr_proof.plant.robot_bench import PULL_STEP, Bench, Plant
from ssmr_proof.plant.sensing import Chain

RATE = 100.0  # Hz
SLIDING = 0.0035  # m that a pull goes on after the tires let go


@dataclass(frozen=True)
class Test:
    """One pull: direction, speed [mm/s], height of the cable [m], wheels on the floor."""

    lateral: bool
    speed: float
    height: float
    wheels: tuple[int, ...] = (1, 2, 3, 4)
    heldout: bool = False


TESTS = (
    Test(True, 1.0, 0.05), Test(True, 1.0, 0.05, (1, 2)), Test(True, 0.4, 0.08), Test(False, 1.5, 0.05),
    Test(False, 3.0, 0.05, (1, 4)), Test(True, 2.0, 0.08, (3, 4)),
    Test(True, 0.6, 0.08, heldout=True), Test(False, 2.0, 0.05, (2, 3), heldout=True),
    Test(False, 1.2, 0.08, heldout=True),
)  # fmt: skip


def pulls(case: Case, drawn: Drawn, random: np.random.Generator, tests: tuple[Test, ...] = TESTS) -> list[Log]:
    """All recordings of a case of this family."""
    change = case.change
    plant = changed(drawn.robot, change)
    white = float(random.uniform(0.5, 0.95)) * (3.0 if case.trap == "noise" else 1.0)
    chain = Chain(white, zero_drift=change.zero_drift, gain_drift=change.gain_drift)
    benches: dict[tuple[bool, float], Bench] = {}
    runs = []
    for test in tests:
        key = test.lateral, test.height
        if key not in benches:
            benches[key] = Bench(plant, PULL_STEP, hook(plant.robot, *key))
        slack = float(random.uniform(0.0, 3e-4))
        duration = _travel(plant, test) / (test.speed * 1e-3)
        runs.append(benches[key].pull(test.lateral, test.speed * 1e-3, duration, test.wheels, slack, RATE))
    if change.range is not None:
        highest = max(float(run.max()) for run, test in zip(runs, tests, strict=True) if not test.heldout)
        chain = replace(chain, range=change.range * highest)
    counts: dict[tuple[bool, bool], int] = {}
    logs = []
    for run, test in zip(runs, tests, strict=True):
        number = counts[test.lateral, test.heldout] = counts.get((test.lateral, test.heldout), 0) + 1
        logs.append(_log(run, test, number, chain, random))
    return logs


def hook(robot: Robot, lateral: bool, height: float) -> np.ndarray:
    """Where the cable holds the robot, from its centre of mass: above the side, or the rear axle, that is pulled."""
    side, rear = float(np.abs(robot.contact_points[:, 1]).mean()), float(robot.contact_points[:, 0].min())
    return np.array([0.0 if lateral else rear, side if lateral else 0.0, height - robot.height])


def _travel(plant: Plant, test: Test) -> float:
    """Until all slides and a little further [m], by statics of a soft tire."""
    robot = plant.robot
    axis = 1 if test.lateral else 0
    share = len(test.wheels) / 4.0
    force = robot.mu_static * robot.mass * GRAVITY * share
    tires = force / (robot.stiffness[axis] * len(test.wheels))
    return float(1.15 * tires + force / plant.cable_stiffness + SLIDING)


def _log(run: np.ndarray, test: Test, number: int, chain: Chain, random: np.random.Generator) -> Log:
    clean = chain.clean(run, RATE, 1)
    logged = np.round(chain.noisy(clean, RATE, random), 3)
    time = np.arange(len(run)) / RATE
    position = random.uniform(5e-3, 4e-2) + test.speed * 1e-3 * time
    direction = "lateral" if test.lateral else "longitudinal"
    entry = {
        "experiment": "pull", "direction": direction, "speed_mm_s": test.speed, "height_m": test.height,
        "wheels_gripping": list(test.wheels), "cable": "steel",
    }  # fmt: skip
    channels = (Channel("position", position, "m", "Position"), Channel("force", logged, "N", "Load"))
    stem = f"pull-{direction}-{number}"
    return Log(stem, entry, time, channels, clean[:, None], logged[:, None], ("force",), None, test.heldout)
