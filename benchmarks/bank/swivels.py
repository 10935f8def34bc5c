"""Random swivelling sessions: a robot of its own over a floor of its own, and something left out that can be seen.

The robot is drawn about the bundled one; its file knows the robot as well as a lab does. The recordings are simulated
with shorter steps than a diagnosis takes, over floors that it does not know, and go through the sensor's volts. An
effect is drawn anew until it moves the spectra by more than twice what two runs of one kind differ by: smaller ones
cannot be seen by anyone.
"""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np

from ssmr_ident.core.errors import SimulationError
from ssmr_ident.core.parameter import Estimate, ParameterSet
from ssmr_ident.doctor.swivels.spectra import look
from ssmr_ident.doctor.swivels.spectral_distance import channel_logs, distance_db
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


def draw_session(seed: int, effect: str | None, calibrated: bool, count: int | None = None) -> tuple[Campaign, dict]:
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


def draw_swivels(seed: int, missing: bool) -> tuple[Campaign, dict]:
    """A session, effect by effect in turn and two of three with calibration; where none can be seen, the next draw."""
    names = list(DRAWS)
    effect = names[seed % len(names)] if missing else None
    calibrated = (seed + seed // len(names)) % 3 != 2
    campaign, truth = None, {}
    while campaign is None:
        campaign, truth = draw_session(seed, effect, calibrated)
        seed += 1_000_000
    return campaign, truth
