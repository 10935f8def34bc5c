"""Swivel sessions drawn at random, diagnosed, and counted: right, tied, false alarms.

    python benchmarks/bench_swivel.py effects 60 --seed 1 -o effects.jsonl
    python benchmarks/bench_swivel.py null 20 --seed 2 -o null.jsonl
    python benchmarks/bench_swivel.py repeat 200 --seed 3 -o repeat.jsonl
    python benchmarks/bench_swivel.py loose 20 --seed 4 -o loose.jsonl
    python benchmarks/bench_swivel.py ten 4 --seed 5 -o ten.jsonl
    python benchmarks/bench_swivel.py report effects.jsonl repeat.jsonl loose.jsonl

``null`` are sessions with nothing missing, two of three with calibration; ``repeat`` have calibration, and only those
whose targets do not repeat it within chance are diagnosed further, since a diagnosis of the others ends there;
``loose`` have none; ``ten`` are sessions of ten recordings, for what they take.

Every session has a robot of its own, drawn about the bundled one; its file knows the robot as well as a lab does. The
recordings are simulated with shorter steps than a diagnosis takes, over floors that it does not know, and go through
the sensor's volts. An effect is drawn anew until it moves the spectra by more than twice what two runs of one kind
differ by: smaller ones cannot be seen by anyone. Results are appended one by one: a run may be broken off and taken up.
"""

from __future__ import annotations

import argparse
import json
import time
from collections import Counter
from dataclasses import replace
from pathlib import Path

import numpy as np
from scipy.stats import beta

from ssmr_ident.core.errors import SimulationError
from ssmr_ident.core.parameter import Estimate, ParameterSet
from ssmr_ident.diagnose.diagnosis import MISSING, NOTHING
from ssmr_ident.diagnose.turning.anchor import scale_of
from ssmr_ident.diagnose.turning.assemble import MODEL_SPREAD, diagnosis_of
from ssmr_ident.diagnose.turning.bench import Bench
from ssmr_ident.diagnose.turning.conditions import conditions_of
from ssmr_ident.diagnose.turning.engine import LEFT, Outcome, examine, repeated
from ssmr_ident.diagnose.turning.search import SPREAD_FACTOR
from ssmr_ident.diagnose.turning.spectra import look
from ssmr_ident.diagnose.turning.spectral_distance import channel_logs, distance_db
from ssmr_ident.diagnose.turning.verdict import findings_of
from ssmr_ident.experiments.campaign import Campaign, Measurement
from ssmr_ident.experiments.quantities import to_quantities
from ssmr_ident.experiments.swivel import swivel
from ssmr_ident.physics.motor import wheel_rates
from ssmr_ident.physics.robot import accelerometer_from_parameters, robot_from_parameters
from ssmr_ident.physics.sensor import Noise
from ssmr_ident.session import Entry, Session, read_parameters
from ssmr_ident.simulate.measure import accelerometer_log
from ssmr_ident.simulate.simulation import simulate

SECONDS, STEP, SETTLE = 20.0, 1.5e-4, 4.0
VISIBLE = 2.0  # times the repeatability
TRIES = 6
SPEEDS = (18, 24, 30, 36, 42, 48, 54, 60, 72)
SPREADS = {  # what the truth is off nominal by, and what the file knows it to, relative
    "mass_kg": 0.01, "inertia_kg_m2.xx": 0.08, "inertia_kg_m2.yy": 0.08, "inertia_kg_m2.zz": 0.08,
    "tire.stiffness_x_N_m": 0.15, "tire.stiffness_y_N_m": 0.1, "tire.stiffness_z_N_m": 0.1,
    "tire.damping_x_N_s_m": 0.3, "tire.damping_y_N_s_m": 0.3, "tire.damping_z_N_s_m": 0.3,
    "tire.mu_static": 0.05, "tire.mu_kinetic": 0.06,
}  # fmt: skip
NOMINAL = {
    "mass_kg": 28.5, "inertia_kg_m2.xx": 1.21, "inertia_kg_m2.yy": 1.41, "inertia_kg_m2.zz": 0.92,
    "tire.stiffness_x_N_m": 3300.0, "tire.stiffness_y_N_m": 18500.0, "tire.stiffness_z_N_m": 80000.0,
    "tire.damping_x_N_s_m": 53.0, "tire.damping_y_N_s_m": 48.0, "tire.damping_z_N_s_m": 75.0,
    "tire.mu_static": 0.83, "tire.mu_kinetic": 0.62,
}  # fmt: skip


def _log(random, low, high):
    return float(np.exp(random.uniform(np.log(low), np.log(high))))


def _either(random, low, high):
    return float(random.choice([-1.0, 1.0]) * random.uniform(low, high))


DRAWS = {
    "ground_roughness": lambda r: {"height_m": _log(r, 8e-5, 8e-4), "length_m": _log(r, 0.006, 0.08)},
    "ground_joints": lambda r: {"pitch_m": _log(r, 8e-3, 0.2), "depth_m": _log(r, 1e-4, 1.5e-3), "width_m": 6e-3},
    "wheel_eccentricity": lambda r: {"eccentricity_m": _log(r, 2e-4, 3e-3)},
    "flexible_mast": lambda r: {"f_mast_Hz": _log(r, 4.0, 16.0), "mass_kg": _log(r, 0.8, 4.0),
                                "height_above_com_m": float(r.uniform(0.25, 0.4)),
                                "damping_ratio": _log(r, 0.015, 0.06)},
    "com_offset": lambda r: {"offset_x_m": _either(r, 0.01, 0.05), "offset_y_m": _either(r, 0.005, 0.04)},
    "wheel_lift": lambda r: {"active": 1.0},
    "motor_belt": lambda r: {"K_b_N_m": _log(r, 1.5e3, 3e4), "D_b_N_s_m": _log(r, 20.0, 80.0), "rim_mass_kg": 1.0},
    "stribeck": lambda r: {"kinetic_share": float(r.uniform(0.6, 0.9)),
                           "stribeck_velocity_m_s": _log(r, 0.01, 0.3)},
    "load_sensitive_friction": lambda r: {"exponent": float(r.uniform(0.1, 0.5))},
    "slip_coupling": lambda r: {"weight": 1.0, "lambda_max": float(r.uniform(0.4, 1.0))},
    "rolling_resistance": lambda r: {"c_rr": _log(r, 0.01, 0.2)},
    "coriolis": lambda r: {"share": 1.0},
    "sensor_saturation": lambda r: {"range_m_s2": float(r.uniform(9.9, 11.0)), "range_N": float("inf")},
    "sensor_bandwidth": lambda r: {"bandwidth_hz": _log(r, 5.0, 30.0)},
    "sensor_misalignment": lambda r: {f"angle_{axis}_rad": float(r.normal(0.0, 0.12)) for axis in "xyz"},
    "unlisted": lambda r: {},
}  # fmt: skip
UNLISTED = {
    "nonlinear_stiffness": lambda r: {"k3_N_m3": _log(r, 3e8, 3e9)},
    "quadratic_damping": lambda r: {"d2_N_s2_m2": _log(r, 1e3, 1e4)},
    "hysteresis": lambda r: {"alpha": float(r.uniform(0.3, 0.7))},
}


def robots(random: np.random.Generator) -> tuple[ParameterSet, ParameterSet]:
    """The truth, and what its file says."""
    base = read_parameters("p3at-extended")
    true, file = {}, {}
    for path, nominal in NOMINAL.items():
        value = nominal * float(np.exp(SPREADS[path] * random.standard_normal()))
        said = value * float(np.exp(SPREADS[path] * random.standard_normal()))
        unit = base[path].unit
        true[path] = Estimate(value, None, unit)
        file[path] = Estimate(said, SPREADS[path] * said, unit)
    file["tire.lambda_max"] = Estimate(0.1, 0.05, "1")
    true["tire.lambda_max"] = Estimate(float(random.uniform(0.02, 0.25)), None, "1")
    true["tire.mu_kinetic"] = Estimate(min(true["tire.mu_kinetic"].value, 0.85 * true["tire.mu_static"].value))
    true["tire.sliding_speed_m_s"] = Estimate(0.33 * float(np.exp(0.25 * random.standard_normal())), None, "m/s")
    true["floor.height_m"] = Estimate(3.5e-5 * float(np.exp(0.3 * random.standard_normal())), None, "m")
    for points in ("contact_points_m", "tire.radius_m", "motor.gain_1_s"):
        if points in base:
            true[points] = file[points] = base[points]
    return base.updated(true), base.updated(file)


class Lab:
    """One robot and its sensor; every recording is over another floor."""

    def __init__(self, random: np.random.Generator) -> None:
        self.random = random
        self.true, self.file = robots(random)
        self.robot = robot_from_parameters(self.true)
        self.noise = Noise(white=float(random.uniform(0.03, 0.05)), hum=float(random.uniform(0.05, 0.15)))

    def run(self, speed: float, effects: dict, seconds: float = SECONDS):
        floor = {
            "height_m": self.true.number("floor.height_m"), "length_m": 6e-3,
            "seed": float(self.random.integers(10**6, 10**8)),
        }  # fmt: skip
        active = {"ground_roughness": floor, **effects}
        active["ground_roughness"] = {**floor, **effects.get("ground_roughness", {})}
        scenario = swivel(wheel_rates(self.robot, 0.0, np.deg2rad(speed)), seconds + SETTLE)
        return simulate(self.robot, scenario, 1000.0, STEP, active)

    def measurement(self, speed: float, role: str, effects: dict, number: int) -> Measurement:
        simulation = self.run(speed, effects)
        skip = round(SETTLE * 1000)
        part = replace(simulation, time=simulation.time[skip:] - SETTLE, values=simulation.values[skip:])
        sensor = accelerometer_from_parameters(self.true)
        zeros = sensor.volts_zero + 0.015 * self.random.standard_normal()
        log = accelerometer_log(part, replace(sensor, volts_zero=float(zeros)), self.noise, self.random)
        entry = Entry(f"v0-w{speed}-{role}-{number}.lvm", "swivel", role=role, yaw_rate_deg_s=float(speed))
        return Measurement(entry, to_quantities(log, entry, accelerometer_from_parameters(self.file)))

    def change_db(self, speeds, effects) -> tuple[float, float]:
        """How far the effect moves the spectra, and how far they differ from run to run."""
        moved, same = [], []
        for speed in speeds:
            logs = []
            for active in ({}, {}, effects):
                run = self.run(speed, active)
                samples = np.column_stack([run[a][4000:] for a in ("ax", "ay", "az")])
                samples = samples + self.noise.white * self.random.standard_normal(samples.shape)
                logs.append(channel_logs(look(samples, 1000.0)))
            same.append(distance_db(logs[0], logs[1]))
            moved.append(0.5 * (distance_db(logs[0], logs[2]) + distance_db(logs[1], logs[2])))
        return float(np.mean(moved)), float(np.mean(same))


def session(seed: int, effect: str | None, calibrated: bool, count: int | None = None) -> tuple[Campaign, dict]:
    """A campaign in memory and its truth; ``effect`` None is a null session.

    ``count`` is how many speeds are recorded as targets, two with calibration and four without where it is None.
    """
    random = np.random.default_rng(seed)
    lab = Lab(random)
    pool = np.array(SPEEDS if effect != "wheel_lift" else (54, 60, 72, 84, 96))
    wanted = count or (2 if calibrated else 4)
    speeds = [int(s) for s in sorted(random.choice(pool, min(wanted, len(pool) - 1), replace=False))]
    effects, name, seen = {}, effect, (0.0, 0.0)
    if effect is not None:
        for _ in range(TRIES):
            key, draw = (effect, DRAWS[effect])
            if effect == "unlisted":
                key = str(random.choice(list(UNLISTED)))
                draw = UNLISTED[key]
            effects = {key: draw(random)}
            try:
                seen = lab.change_db(speeds, effects)
            except SimulationError:  # too stiff a law for the robot drawn
                continue
            if seen[0] > VISIBLE * seen[1]:
                break
        else:
            return None, {"seed": seed, "effect": name, "seen_db": seen, "speeds": speeds}
    runs = []
    for number, speed in enumerate(speeds):
        if calibrated:
            runs.append(lab.measurement(speed, "calibration", {}, number))
        runs.append(lab.measurement(speed, "target", effects, number))
    other = int(random.choice([s for s in pool if s not in speeds]))
    for number in (9,) if count is None else (9, 10):
        runs.append(lab.measurement(other, "heldout", effects, number))
    entries = tuple(m.entry for m in runs)
    plain = Session(f"drawn-{seed}", Path(), "p3at-extended", "rigid6", entries)
    truth = {
        "seed": seed, "effect": name, "effects": effects, "calibrated": calibrated, "speeds": speeds, "seen_db": seen,
    }  # fmt: skip
    return Campaign(plain, lab.file, tuple(runs)), truth


def row_of(outcome: Outcome, truth: dict, begun: float) -> dict:
    """What the whole diagnosis says, and the numbers behind it."""
    answer = diagnosis_of(outcome, str(truth["seed"]))
    seconds = time.perf_counter() - begun
    fitted = {
        one.id: {free.name: (one.values[free.name], None if one.spread is None else float(one.spread[i]), free.log)
                 for i, free in enumerate(one.candidate.free)}
        for one in outcome.explanations
    }  # fmt: skip
    named = [name for one in answer.effects for name in (one.id, *one.indistinguishable_from)]
    heldout = (answer.heldout.before, answer.heldout.after, answer.heldout.noise_floor)
    return {
        **truth, "verdict": answer.verdict, "named": named, "heldout_db": heldout,
        "findings": findings_of(outcome).as_dict(), "fitted": fitted, "seconds": round(seconds, 1),
    }  # fmt: skip


def run_many(kind: str, count: int, seed: int, output: Path) -> None:
    done = {json.loads(line)["seed"] for line in output.read_text().splitlines()} if output.exists() else set()
    names = list(DRAWS)
    for i in range(count):
        number = 1000 * seed + i
        if number in done:
            continue
        effect = names[i % len(names)] if kind == "effects" else None
        campaign, truth = session(number, effect, calibrated=kind != "loose" and (i + i // len(names)) % 3 != 2)
        begun = time.perf_counter()
        row = truth if campaign is None else row_of(examine(campaign), truth, begun)
        with output.open("a") as file:
            file.write(json.dumps(row) + "\n")
        said = (row["verdict"], row["named"], np.round(row["heldout_db"], 1).tolist()) if campaign else "cannot be seen"
        print(number, effect, row.get("calibrated"), row.get("seconds"), said, flush=True)


def repeats(count: int, seed: int, output: Path) -> None:
    """Null sessions with calibration: the whole diagnosis of those alone whose targets do not repeat it within chance.

    A diagnosis of the others ends there, with nothing missing.
    """
    rows = [json.loads(line) for line in output.read_text().splitlines()] if output.exists() else []
    done = {row["seed"] for row in rows}
    for number in range(1000 * seed, 1000 * seed + count):
        if number in done:
            continue
        campaign, truth = session(number, None, calibrated=True)
        conditions, _ = conditions_of(campaign, campaign.parameters)
        calibration = tuple(c for c in conditions if c.role == "calibration")
        targets = tuple(c for c in conditions if c.role == "target")
        found = repeated(Bench(campaign.parameters), calibration, targets, scale_of(calibration), (1, 2))
        row = {**truth, "verdict": NOTHING, "named": []}
        if found.left > LEFT:
            begun = time.perf_counter()
            row = row_of(examine(campaign), truth, begun)
            print(number, round(found.left, 1), row["verdict"], row["named"], flush=True)
        rows.append({**row, "left": found.left})
        with output.open("a") as file:
            file.write(json.dumps(rows[-1]) + "\n")
        if len(rows) % 20 == 0:
            said = Counter(row["verdict"] for row in rows if row["left"] > LEFT)
            alarms = sum(row["verdict"] == MISSING for row in rows)
            print(f"{len(rows)} null sessions: {said.total()} above {LEFT:g}: {dict(said)}; "
                  f"false alarms {_interval(alarms, len(rows))}", flush=True)  # fmt: skip


def ten(count: int, seed: int, output: Path) -> None:
    """How long ten recordings take: five speeds before and after, in turn with eight targets and two kept back."""
    names = [name for name in DRAWS if name not in ("wheel_lift", "coriolis")]
    for i in range(count):
        campaign, truth = session(1000 * seed + i, names[i % len(names)], i % 2 == 0, 5 if i % 2 == 0 else 8)
        if campaign is None:
            continue
        kept = campaign.measurements
        if truth["calibrated"]:  # five speeds twice are ten: the middle one is kept back by the diagnosis
            kept = tuple(m for m in kept if m.entry.role != "heldout")
        entries = tuple(m.entry for m in kept)
        campaign = Campaign(replace(campaign.session, entries=entries), campaign.parameters, kept)
        begun, busy = time.perf_counter(), time.process_time()
        row = row_of(examine(campaign), truth, begun)
        row["processor_seconds"] = round(time.process_time() - busy, 1)
        with output.open("a") as file:
            file.write(json.dumps(row) + "\n")
        print(len(kept), truth["effect"], truth["calibrated"], row["seconds"], row["processor_seconds"], row["named"],
              np.round(row["heldout_db"], 1).tolist(), flush=True)  # fmt: skip


def report(paths: list[Path]) -> None:
    """Rates with exact intervals, and the confusion matrix, of what was stored."""
    rows = [json.loads(line) for path in paths for line in path.read_text().splitlines()]
    unseen = Counter(row["effect"] for row in rows if "verdict" not in row)
    rows = [row for row in rows if "verdict" in row]
    for calibrated in (True, False, None):
        part = [row for row in rows if calibrated is None or row["calibrated"] == calibrated]
        label = {True: "with calibration", False: "without calibration", None: "all"}[calibrated]
        nulls = [row for row in part if row["effect"] is None]
        drawn = [row for row in part if row["effect"] is not None]
        right = sum(row["effect"] in row["named"] for row in drawn)
        alone = sum(row["named"] == [row["effect"]] for row in drawn)
        alarms = sum(row["verdict"] == "missing_physics" for row in nulls)
        unsure = sum(row["verdict"] == "undetermined" for row in nulls)
        print(f"\n{label}: {len(drawn)} sessions with an effect, {right} right or tied "
              f"({_interval(right, len(drawn))}), {alone} right alone; "
              f"{len(nulls)} null sessions, {alarms} false alarms "
              f"({_interval(alarms, len(nulls))}), {unsure} undetermined")  # fmt: skip
    drawn = [row for row in rows if row["effect"] is not None]
    print("\n| acted | sessions | right or tied | alone | first named (times) |\n| --- | --- | --- | --- | --- |")
    for effect in DRAWS:
        mine = [row for row in drawn if row["effect"] == effect]
        if mine:
            first = Counter((row["named"] or [row["verdict"]])[0] for row in mine)
            said = ", ".join(f"`{name}` {times}" for name, times in first.most_common())
            print(f"| `{effect}` | {len(mine)} | {sum(effect in row['named'] for row in mine)} "
                  f"| {sum(row['named'] == [effect] for row in mine)} | {said} |")  # fmt: skip
    named = [row for row in drawn if row["named"][:1] == [row["effect"]]]
    if named:
        before, after, floor = np.array([row["heldout_db"] for row in named]).T
        print(f"\nheld out, effect named first: median {np.median(before):.1f} dB to {np.median(after):.1f} dB, "
              f"cut by a third or more in {np.sum(after < 2 / 3 * before)} of {len(named)}, "
              f"within 1.5 dB of repeatability in {np.sum(after < floor + 1.5)}")  # fmt: skip
        for width in (1.0, 2.0, 3.0):
            inside = [ok for row in named for ok in _inside(row, width)]
            print(f"parameters within {width:g} printed standard deviations: {sum(inside)} of {len(inside)}")
    if unseen:
        print(f"\nnever moved the spectra by {VISIBLE:g} times their scatter: {dict(unseen)}")
    seconds = [row["seconds"] for row in rows if "seconds" in row]
    print(f"\nseconds per whole diagnosis: median {np.median(seconds):.0f}, longest {np.max(seconds):.0f}")


def _interval(hits: int, count: int) -> str:
    """Clopper and Pearson, 95 %."""
    if not count:
        return "-"
    low = beta.ppf(0.025, hits, count - hits + 1) if hits else 0.0
    high = beta.ppf(0.975, hits + 1, count - hits) if hits < count else 1.0
    return f"{low:.1%} to {high:.1%}"


def _inside(row: dict, width: float) -> list[bool]:
    """Whether each fitted parameter of the effect that acted lies within ``width`` printed standard deviations."""
    found = []
    for name, (value, spread, log) in row["fitted"].get(row["effect"], {}).items():
        true = row["effects"].get(row["effect"], {}).get(name)
        if spread is None or true is None:
            continue
        sigma = np.hypot(SPREAD_FACTOR * spread, MODEL_SPREAD if log else 0.0)
        found.append(bool(abs(np.log(value / true) if log else value - true) < width * sigma))
    return found


if __name__ == "__main__":
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("kind", choices=("effects", "null", "loose", "repeat", "ten", "report"))
    parser.add_argument("arguments", nargs="+")
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("-o", "--output", type=Path, default=Path("swivel.jsonl"))
    given = parser.parse_args()
    if given.kind == "report":
        report([Path(path) for path in given.arguments])
    elif given.kind == "repeat":
        repeats(int(given.arguments[0]), given.seed, given.output)
    elif given.kind == "ten":
        ten(int(given.arguments[0]), given.seed, given.output)
    else:
        run_many(given.kind, int(given.arguments[0]), given.seed, given.output)
