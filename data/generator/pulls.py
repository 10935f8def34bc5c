"""Force logs: pulled by a testing machine, wheels stopped or spinning; one wheel dragged or pressed."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np

from generator import truth
from generator.writing import write_robot, write_session
from ssmr_ident.experiments import EXPERIMENTS, Scenario
from ssmr_ident.experiments.pull import cable_properties, fixture_needed
from ssmr_ident.physics.robot import Robot, robot_from_parameters
from ssmr_ident.physics.sensor import Noise
from ssmr_ident.readers.writers import write_mtestquattro
from ssmr_ident.simulate import simulate
from ssmr_ident.simulate.bench import compress_wheel, drag_wheel
from ssmr_ident.simulate.measure import load_cell_log

STEP = 0.01  # s; the machine logs at 100 Hz
SOFT_START = 0.3  # s until the head has its speed
HEIGHT = 0.05  # m, of the cable above the floor
SPIN_RATES = (
    0.02,
    0.05,
    0.1,
    0.2,
    0.4,
    0.6,
)  # rad/s; rims at 2 mm/s to 66 mm/s, about the thesis' knee of 40
NOISE = Noise(truth.LOAD_N, 0.0, quantum=truth.LOAD_QUANTUM_N)


@dataclass(frozen=True)
class Test:
    """One run of the machine: how it is listed, how far the head goes, and how the log is printed."""

    name: str
    entry: dict[str, Any]
    travel: float
    printed: dict[str, Any] = field(default_factory=dict)


CSV = {"style": "csv", "facts": {"Sample": "1", "Procedure": "Pull", "Operator": "synthetic"}}
POUNDS = {"load_unit": "lbf", "position_unit": "in", "decimals": (3, 7, 5)}


def tests(floor: str) -> Iterator[Test]:
    """The programme on one floor; the wheels' own tests are made on concrete only."""

    def pulled(direction: str, cable: str, wheels: tuple[int, ...] = (1, 2, 3, 4), **more: Any) -> dict[str, Any]:
        entry = {"experiment": "pull", "direction": direction, "floor": floor, "speed_mm_s": 1.0}
        return {**entry, "height_m": HEIGHT, "wheels_gripping": wheels, "cable": cable, **more}

    # the thesis pulls at 1 mm/s; repeats at other speeds would show a rate dependence, which this robot has not
    speeds = (1.0, 0.5, 2.0)

    concrete = floor == "concrete"
    styles: tuple[dict[str, Any], ...] = ({}, CSV, POUNDS)
    for repeat in (1, 2, 3):
        yield Test(
            f"lateral-steel-{repeat}",
            pulled("lateral", "steel", speed_mm_s=speeds[repeat - 1]),
            0.020,
            styles[repeat - 1],
        )
    for repeat in (1, 2):
        entry = pulled("longitudinal", "steel", speed_mm_s=speeds[repeat - 1])
        yield Test(f"longitudinal-steel-{repeat}", entry, 0.035, styles[repeat - 1])
    yield Test("lateral-rope-1", pulled("lateral", "rope"), 0.060)
    for number, rate in enumerate(SPIN_RATES, start=1):
        entry = pulled("lateral", "steel", wheel_rate_rad_s=rate)
        yield Test(f"lateral-spinning-{number}", entry, 0.010)
    if not concrete:
        return
    yield Test("longitudinal-rope-1", pulled("longitudinal", "rope"), 0.080)
    yield Test("longitudinal-rear-wheels-1", pulled("longitudinal", "steel", (1, 4)), 0.035)
    yield Test("lateral-left-wheels-1", pulled("lateral", "steel", (1, 2)), 0.016)
    yield Test("lateral-high-1", pulled("lateral", "steel", height_m=0.15), 0.020)
    for repeat in (1, 2):
        entry = pulled("lateral", "steel", (1,), speed_mm_s=speeds[repeat - 1])
        yield Test(f"lateral-one-wheel-{repeat}", entry, 0.014)
    for repeat in (1, 2):
        drag = {"experiment": "wheel_drag", "floor": floor, "speed_mm_s": speeds[repeat - 1]}
        yield Test(f"wheel-drag-free-{repeat}", {**drag, "free_normal": True}, 0.014)
    yield Test("wheel-drag-held-1", {**drag, "free_normal": False}, 0.009)
    for repeat in (1, 2, 3):
        press = {"experiment": "vertical_compression", "speed_mm_s": 0.1 * speeds[repeat - 1]}
        yield Test(f"wheel-compression-{repeat}", press, 0.0045, styles[repeat - 1])


def travel_of(speed: float, travel: float) -> np.ndarray:
    """Head's travel at multiples of STEP, speeding up evenly over SOFT_START; (n,) float [m]."""
    duration = travel / speed + SOFT_START / 2
    time = np.arange(round(duration / STEP) + 1) * STEP
    return speed * np.where(time < SOFT_START, time**2 / (2 * SOFT_START), time - SOFT_START / 2)


def force_of(robot: Robot, entry: dict[str, Any], head: np.ndarray, random: np.random.Generator) -> np.ndarray:
    """What the load cell would read without noise, (n,) float [N]."""
    kind = EXPERIMENTS[entry["experiment"]]
    if kind.vertical:
        return compress_wheel(robot, head, STEP, gap=random.uniform(0.8e-3, 1.4e-3))
    if kind.of_one_wheel:
        return drag_wheel(robot, head, STEP, entry["free_normal"])
    stiffness, damping = cable_properties(entry["cable"])
    rate = entry.get("wheel_rate_rad_s", 0.0)
    scenario = Scenario(
        "pull",
        len(head) * STEP,
        wheel_rates=np.full((1, 2), rate),
        head=head,
        head_step=STEP,
        direction=entry["direction"],
        height=entry["height_m"],
        wheels_gripping=entry["wheels_gripping"],
        cable_stiffness=stiffness,
        cable_damping=damping,
        held=fixture_needed(entry["wheels_gripping"], rate),
    )
    return simulate(robot, scenario, sample_rate=1.0 / STEP, step=truth.INTEGRATION_STEP)["force"]


def make(folder: Path, seed: int) -> None:
    """Write data/raw/pulls."""
    folder.mkdir(parents=True, exist_ok=True)
    everything = []
    for part, floor in enumerate(("concrete", "carpet")):
        parameters = truth.true_robot("frame", floor)
        robot = robot_from_parameters(parameters)
        entries = []
        for number, test in enumerate(tests(floor)):
            random = np.random.default_rng([seed, 2, part, number])
            head = travel_of(test.entry["speed_mm_s"] * 1e-3, test.travel)
            force = force_of(robot, test.entry, head, random)
            time = STEP * np.arange(len(head))
            log = load_cell_log(time, head, force, NOISE, random, test.entry["experiment"])
            printed = {"decimals": (3, 5, 3), **test.printed}
            file = f"{floor}-{test.name}.{'csv' if printed.get('style') == 'csv' else 'txt'}"
            write_mtestquattro(folder / file, log, **printed)
            entries.append({"file": file, **test.entry})
        robot_file = f"robot-{floor}.yaml"
        write_session(folder / f"{floor}.yaml", f"extended-robot-pulls-{floor}", robot_file, entries)
        write_robot(folder / robot_file, truth.lab_robot("frame", floor))
        write_robot(folder / f"truth-{floor}.yaml", parameters)
        everything += entries
    write_session(folder / "session.yaml", "extended-robot-pulls", "robot.yaml", everything)
    write_robot(folder / "robot.yaml", truth.lab_robot("frame"))
