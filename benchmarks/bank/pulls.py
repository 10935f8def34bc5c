"""Random force logs: a robot pulled by a testing machine, one wheel dragged or pressed, a block over a surface."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np

from bank.disturbances import random_load_cell
from bank.rig_physics import between
from bank.robot_physics import BENCH, PULLS, SPINNING
from bank.robots import draw_robot, true_values
from bank.truth import BankSession, Made, Truth, recording
from ssmr_ident.core.parameter import Estimate, ParameterSet
from ssmr_ident.experiments import PULL, VERTICAL_COMPRESSION, WHEEL_DRAG, Scenario
from ssmr_ident.experiments.campaign import Campaign
from ssmr_ident.experiments.pull import fixture_needed
from ssmr_ident.physics.rig import Block
from ssmr_ident.physics.robot import GRAVITY, Robot
from ssmr_ident.session import Entry, Session
from ssmr_ident.simulate import simulate
from ssmr_ident.simulate.bench import load_wheel, pull_block

ALL = (1, 2, 3, 4)
PLAN = (  # direction, speed mm/s, height m, wheels, wheel rate rad/s, role
    ("lateral", 1.0, 0.05, ALL, 0.0, "target"), ("lateral", 1.0, 0.05, (1, 2), 0.0, "target"),
    ("lateral", 0.5, 0.05, ALL, 0.0, "target"), ("longitudinal", 1.0, 0.05, ALL, 0.0, "target"),
    ("longitudinal", 2.0, 0.05, (1, 4), 0.0, "target"), ("lateral", 2.0, 0.08, (3, 4), 0.0, "target"),
    ("lateral", 0.7, 0.08, ALL, 0.0, "heldout"), ("longitudinal", 1.5, 0.05, (2, 3), 0.0, "heldout"),
    ("longitudinal", 0.8, 0.08, ALL, 0.0, "heldout"),
)  # fmt: skip
SPUN = (
    ("lateral", 1.0, 0.05, ALL, 0.1, "target"), ("lateral", 1.0, 0.05, ALL, 0.4, "target"),
    ("lateral", 2.0, 0.05, ALL, 0.2, "target"), ("lateral", 1.0, 0.05, ALL, 0.2, "heldout"),
)  # fmt: skip
TRAVEL = {"lateral": (6e-3, 10e-3), "longitudinal": (24e-3, 32e-3)}  # m
BENCH_PLAN = (  # experiment, mean travel m, speed mm/s, role
    (WHEEL_DRAG, 8e-3, 1.0, "target"), (WHEEL_DRAG, 8e-3, 0.3, "target"), (VERTICAL_COMPRESSION, 4e-3, 1.0, "target"),
    (VERTICAL_COMPRESSION, 4e-3, 0.3, "target"), (PULL, 6e-3, 1.0, "target"), (WHEEL_DRAG, 8e-3, 2.0, "heldout"),
    (VERTICAL_COMPRESSION, 4e-3, 2.0, "heldout"), (PULL, 6e-3, 0.5, "heldout"),
)  # fmt: skip
BLOCKS = {name: PULLS[name] for name in ("cable_compliance", "load_cell_drift", "stribeck", "sensor_saturation")}
BLOCK_PLAN = ((1.0, "target"), (0.3, "target"), (2.0, "target"), (0.6, "heldout"), (1.5, "heldout"))


def draw_pulls(kind: str, seed: int, effect: str | None, size: float | None, short: bool) -> BankSession:
    """Six pulls to fit and three held out, some with wheels that spin; ``short`` ones are the lateral ones."""
    random = np.random.default_rng([seed, 10])
    robot, file, _ = draw_robot(random)
    effects, size = choose(kind, effect, size, tuple(PULLS), random)
    spun = any(name in SPINNING for name in effects) or (kind == "none" and random.random() < 0.05)
    plan = [line for line in PLAN if not short or line[0] == "lateral"] + (list(SPUN) if spun else [])
    if "slip_coupling" in effects:  # it is missing only where the file has no lambda_max
        file = replace(file, estimates={key: e for key, e in file.items() if key != "tire.lambda_max"})
        robot = robot.with_changes(slip_coupling=0.0)
    rate = float(random.choice([100.0, 200.0]))
    length = random.uniform()
    entries, heads, forces = [], [], []
    for number, (direction, speed, height, wheels, spin, role) in enumerate(plan, start=1):
        travel = between(length, *TRAVEL[direction])
        head, slack = travelled(speed, travel, rate, random)
        forces.append(pulled(robot, head - slack, rate, direction, height, wheels, spin, without_cell(effects)))
        heads.append(head)
        entries.append(
            Entry(f"pull-{number}.csv", "pull", role=role, direction=direction, speed_mm_s=speed, height_m=height,
                  wheels_gripping=wheels, wheel_rate_rad_s=spin or None, cable="steel")
        )  # fmt: skip
    return finished("pulls", kind, seed, size, file, entries, heads, forces, effects, rate, true_values(robot), random)


def draw_bench(kind: str, seed: int, effect: str | None, size: float | None, short: bool) -> BankSession:
    """Two drags of one wheel, two compressions and a pull to fit; one of each held out."""
    random = np.random.default_rng([seed, 13])
    robot, file, _ = draw_robot(random)
    effects, size = choose(kind, effect, size, BENCH, random)
    rate = float(random.choice([100.0, 200.0]))
    entries, heads, forces = [], [], []
    for number, (experiment, travel, speed, role) in enumerate(BENCH_PLAN, start=1):
        if short and speed < 0.5:
            continue
        head, slack = travelled(speed, travel * random.uniform(0.8, 1.2), rate, random)
        acting, going_on = without_cell(effects), tightened(head, slack)
        more = {}
        if experiment.of_one_wheel:
            force = load_wheel(robot, experiment, going_on, 1.0 / rate, effects=acting)[:-1]
        else:
            force = pulled(robot, head - slack, rate, "lateral", 0.05, ALL, 0.0, acting)
            more = {"direction": "lateral", "height_m": 0.05, "cable": "steel"}
        entries.append(Entry(f"test-{number}.csv", experiment.name, role=role, speed_mm_s=speed, **more))
        heads.append(head)
        forces.append(force)
    return finished("bench", kind, seed, size, file, entries, heads, forces, effects, rate, true_values(robot), random)


def draw_block(kind: str, seed: int, effect: str | None, size: float | None, short: bool) -> BankSession:
    """A block pulled through a cable: three recordings to fit, two held out; the baseline's cable is stiff."""
    random = np.random.default_rng([seed, 9])
    mass, mu = random.uniform(0.8, 4.0), random.uniform(0.25, 0.6)
    effects, size = choose(kind, effect, size, tuple(BLOCKS), random)
    if "cable_compliance" in effects:
        effects["cable_compliance"]["K_cable_N_m"] /= 10.0  # a small block on a softer cable
    known = {
        "mass_kg": Estimate(mass * (1.0 + 0.005 * random.standard_normal()), 0.005 * mass, "kg"),
        "mu_static": Estimate(mu * (1.0 + 0.1 * random.standard_normal()), 0.1 * mu, "1"),
        "cable.stiffness_N_m": Estimate(np.inf, None, "N/m", fixed=True),
    }
    if "stribeck" in effects or random.random() < 0.3:  # with a compliant cable friction's fall can show
        soft = random.uniform(2e3, 2e4)
        known["cable.stiffness_N_m"] = Estimate(soft * random.uniform(0.9, 1.1), 0.1 * soft, "N/m")
    else:
        soft = np.inf
    known["mu_kinetic"] = known["mu_static"]
    rate = 100.0
    entries, heads, forces = [], [], []
    for number, (speed, role) in enumerate(BLOCK_PLAN, start=1):
        head, slack = travelled(speed, random.uniform(8e-3, 15e-3), rate, random)
        going_on = tightened(head, slack)
        forces.append(pull_block(Block(mass, mu, mu, float(soft)), going_on, 1.0 / rate, without_cell(effects))[:-1])
        heads.append(head)
        entries.append(Entry(f"drag-{number}.csv", "wheel_drag", role=role, speed_mm_s=speed))
    file = ParameterSet("block", known)
    true = {"mass_kg": mass, "mu_static": mu}
    scale = mass * GRAVITY * mu / 50.0  # of the load cell: noise is in proportion to what it measures
    return finished("block", kind, seed, size, file, entries, heads, forces, effects, rate, true, random, scale, "drag")


def choose(
    kind: str, effect: str | None, size: float | None, names: tuple[str, ...], random: np.random.Generator
) -> tuple[dict[str, dict[str, float]], float]:
    """Physics of a kind, in the catalogue's formulas; where no size is asked for it is drawn evenly."""
    size = float(random.uniform()) if size is None else size
    if kind == "none":
        return {}, 0.0
    if kind == "one":
        name = effect or str(random.choice(names))
        return {name: PULLS[name](size, random)}, size
    if kind != "two":
        raise ValueError(f"no plant of another formula pulls: kind {kind!r}")
    # the load cell and the contact, or the contact and the tire: pairs that a lab may meet together
    allowed = [name for name in names if name not in (*SPINNING, "sensor_saturation", "com_offset")]
    pair = random.choice(allowed, 2, replace=False)
    return {str(name): PULLS[str(name)](max(size, 0.4), random) for name in pair}, size


def travelled(speed_mm_s: float, travel: float, rate: float, random: np.random.Generator) -> tuple[np.ndarray, float]:
    """The head's travel at its samples, (n,) float [m], and how far it goes before the cable tightens [m].

    The cable tightens on a sample: the simulator's damped cable answers with a spike of one sample, which no lab
    sees and whose place between two samples nobody should be asked for.
    """
    speed = speed_mm_s * 1e-3
    late = int(random.integers(0, 40)) if random.random() < 0.5 else 0
    n = round(travel / speed * rate) + late + 1
    return speed * np.arange(n) / rate, speed * late / rate


def tightened(head: np.ndarray, slack: float) -> np.ndarray:
    """What the cable's end does, one sample longer than the log: the log ends before the head stops."""
    return np.append(np.maximum(head - slack, 0.0), 2.0 * head[-1] - head[-2] - slack)


def pulled(
    robot: Robot, head: np.ndarray, rate: float, direction: str, height: float, wheels: tuple[int, ...],
    spin: float, effects: dict[str, dict[str, float]],
) -> np.ndarray:  # fmt: skip
    """Force in the cable at the head's samples, (n,) float [N]."""
    going_on = tightened(head, 0.0)
    scenario = Scenario(
        "pull", len(head) / rate, head=going_on, head_step=1.0 / rate, direction=direction,
        height=height, wheels_gripping=wheels, wheel_rates=np.full((1, 2), spin), held=fixture_needed(wheels, spin),
    )  # fmt: skip
    return simulate(robot, scenario, rate, effects=effects)["force"]


def without_cell(effects: dict[str, dict[str, float]]) -> dict[str, dict[str, float]]:
    """What acts on the robot; the cell's own faults follow the clock of the log and come after."""
    return {name: values for name, values in effects.items() if name not in ("load_cell_drift", "sensor_saturation")}


def finished(
    family: str, kind: str, seed: int, size: float, file: ParameterSet, entries: list[Entry],
    heads: list[np.ndarray], forces: list[np.ndarray], effects: dict[str, dict[str, float]], rate: float,
    true: dict[str, float], random: np.random.Generator, scale: float = 1.0, baseline: str = "rigid6",
) -> BankSession:  # fmt: skip
    """Load cell, zeros and the truth put to the forces."""
    cell = random_load_cell(random)
    cell = replace(cell, white=cell.white * scale, wander=cell.wander * scale)
    if "sensor_saturation" in effects:
        limit = effects["sensor_saturation"]["share_of_peak"] * max(float(force.max()) for force in forces)
        effects = {"sensor_saturation": {"range_N": limit}}
        forces = [np.clip(force, -limit, limit) for force in forces]
    drift = effects.get("load_cell_drift", {}).get("zero_drift_N_s", 0.0)
    made = []
    for entry, head, force in zip(entries, heads, forces, strict=True):
        clean = force + drift * np.arange(len(force)) / rate
        zero = 0.0 if "sensor_saturation" in effects else scale * random.normal(0.0, 1.0)
        place = random.uniform(5e-3, 40e-3)
        logged = {"position": (place + head, "m"), "force": (cell.add(clean, rate, random) + zero, "N")}
        made.append(Made(entry, recording(entry.file, rate, **logged), {"force": clean}))
    session = Session(f"bank-{seed}", Path("bank"), "robot.yaml", baseline, tuple(entries))
    campaign = Campaign(session, file, tuple(one.measurement for one in made))
    floors = {one.entry.file: one.noise_floor for one in made}
    verdict = "missing_physics" if effects else "nothing_missing"
    return BankSession(family, kind, seed, size, campaign, Truth(verdict, effects, "", true, floors))
