"""Random geared drives under position control: a spring or a weight at the joint, friction of three kinds.

The plant is integrated by small steps with friction that holds exactly, and shares no code with the package.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from pathlib import Path

import numba
import numpy as np

from bank.truth import BankSession, Made, Truth, recording
from ssmr_ident.core.parameter import Estimate, ParameterSet
from ssmr_ident.experiments.campaign import Campaign
from ssmr_ident.session import Entry, Session

KINDS = ("none", "dry_friction", "load_dependent_friction")
"""What rubs in the gears: grease alone, the same whatever they carry, or more the more they carry."""

RATE, SECONDS, FINER = 200.0, 4.0, 50
ENCODER = 2.0 * math.pi / 4096.0
"""rad of a step, of which white noise has a third as its standard deviation."""

GAINS = (0.5, 1.0, 0.7)
"""Of the controllers, in that of the drive; the last is kept back."""


@dataclass(frozen=True)
class Drive:
    """A drawn drive: inertia and damping at the joint, torque of a spring or a weight, motor, gears, friction."""

    inertia: float
    damping: float
    stiffness: float
    weight: bool
    constant: float
    resistance: float
    armature: float
    ratio: float
    coulomb: float
    share: float
    limit: float

    @property
    def gain(self) -> float:
        """Torque per volt."""
        return self.ratio * self.constant / self.resistance


def draw_drive(kind: str, seed: int) -> BankSession:
    """Four recordings at two gains to fit, two at a third one held out.

    Parameters
    ----------
    kind : str
        Of ``KINDS``.
    seed : int
    """
    random = np.random.default_rng([seed, 23])
    drive = _drawn(kind, random)
    goals = [_goal(random, style) for style in (0, 1, 0, 1, 0, 1)]
    made = []
    for index, goal in enumerate(goals):
        gain = GAINS[index // 2] * drive.limit / 0.5
        angle = run_drive(drive, goal, gain)
        noisy = angle + ENCODER / 3.0 * random.standard_normal(len(angle))
        file, role = f"run-{index + 1}.csv", "heldout" if index > 3 else "target"
        controller = {"kp_V_rad": gain, "limit_V": drive.limit}
        entry = Entry(file, "forced", role=role, controller=controller)
        logged = {"position_reference": (goal, "rad"), "angle": (noisy, "rad")}
        made.append(Made(entry, recording(file, RATE, **logged), {"angle": angle}))
    session = Session(f"drive-{seed}", Path("bank"), "rig.yaml", "sdof", tuple(one.entry for one in made))
    effects = {} if kind == "none" else {kind: {"F_c_N": drive.coulomb, "c": drive.share}}
    if drive.weight:
        effects["nonlinear_stiffness"] = {"sine_share": 1.0}
    truth = Truth(
        "missing_physics" if effects else "nothing_missing",
        effects,
        "",
        {"inertia_kg_m2": drive.inertia, "stiffness_N_m_rad": drive.stiffness},
        {one.entry.file: one.noise_floor for one in made},
    )
    campaign = Campaign(session, _known(drive, random), tuple(one.measurement for one in made))
    return BankSession("drive", kind, seed, drive.share, campaign, truth)


def _drawn(kind: str, random: np.random.Generator) -> Drive:
    stiffness = float(10.0 ** random.uniform(-0.7, 0.7))
    inertia = stiffness / (2.0 * np.pi * random.uniform(1.0, 2.5)) ** 2
    ratio = float(random.uniform(20.0, 250.0))
    limit = float(random.choice([5.0, 7.4, 12.0, 24.0]))
    gain = stiffness * random.uniform(2.0, 4.0) / limit  # it lifts its load by two to four times
    damped = random.uniform(0.3, 0.8) * 2.0 * math.sqrt(stiffness * inertia)  # by the motor's own voltage
    constant = damped / gain / ratio
    armature = random.uniform(0.05, 0.4) * inertia / ratio**2
    coulomb, share = 0.0, 0.0
    if kind == "dry_friction":
        coulomb = float(random.uniform(0.04, 0.15)) * stiffness
    elif kind == "load_dependent_friction":
        coulomb, share = float(random.uniform(0.0, 0.03)) * stiffness, float(random.uniform(0.1, 0.35))
    return Drive(
        inertia, 0.1 * damped, stiffness, bool(random.random() < 0.3), constant, ratio * constant / gain, armature,
        ratio, coulomb, share, limit,
    )  # fmt: skip


def _goal(random: np.random.Generator, style: int) -> np.ndarray:
    """Two sines, or ramps between places where it waits; (n,) float [rad]."""
    time = np.arange(round(SECONDS * RATE)) / RATE
    if style == 0:
        slow, fast = random.uniform(0.3, 0.6), random.uniform(0.9, 1.8)
        return 0.7 * np.sin(2.0 * np.pi * slow * time) + 0.25 * np.sin(2.0 * np.pi * fast * time)
    places = np.concatenate([[0.0], random.uniform(-1.0, 1.0, 4), [0.0]])
    at = np.repeat(np.linspace(0.3, SECONDS - 0.3, 6), 2) + np.tile([-0.2, 0.2], 6)
    return np.interp(time, at, np.repeat(places, 2))


def run_drive(drive: Drive, goal: np.ndarray, gain: float) -> np.ndarray:
    """Angle at the samples, (n,) float [rad]."""
    inertia = drive.inertia + drive.ratio**2 * drive.armature
    back = drive.ratio * drive.constant
    load = drive.stiffness, drive.damping, drive.weight, drive.coulomb, drive.share
    return _run(goal, gain, drive.limit, drive.gain, back, inertia, *load, 1.0 / RATE)


@numba.njit
def _run(goal, gain, limit, per_volt, back, inertia, stiffness, damping, weight, coulomb, share, step):
    x, v, out, h = 0.0, 0.0, np.empty(len(goal)), step / FINER
    for n in range(len(goal)):
        out[n] = x
        then = goal[min(n + 1, len(goal) - 1)]
        for k in range(FINER):
            wanted = goal[n] + (then - goal[n]) * k / FINER
            volts = min(max(gain * (wanted - x), -limit), limit)
            motor = per_volt * (volts - back * v)
            load = -stiffness * (math.sin(x) if weight else x)
            free = v + h / inertia * (motor + load - damping * v)
            held = h / inertia * (coulomb + share * abs(motor - load))
            v = 0.0 if abs(free) <= held else free - math.copysign(held, free)
            x += h * v
    return out


def _known(drive: Drive, random: np.random.Generator) -> ParameterSet:
    """Inertia and motor to a tenth, spring to a hundredth, damping as nobody knows it."""

    def told(true: float, share: float, unit: str) -> Estimate:
        value = true * float(np.exp(share * random.standard_normal()))
        return Estimate(value, share * value, unit)

    found = {
        "inertia_kg_m2": told(drive.inertia, 0.1, "kg m^2"),
        "damping_N_m_s_rad": Estimate(drive.damping * random.uniform(0.5, 2.0), None, "N m s/rad"),
        "stiffness_N_m_rad": told(drive.stiffness, 0.01, "N m/rad"),
        "drive.kt_N_m_A": told(drive.constant, 0.1, "N m/A"),
        "drive.R_ohm": told(drive.resistance, 0.1, "ohm"),
        "drive.armature_kg_m2": Estimate(drive.armature, None, "kg m^2", fixed=True),
        "drive.gear_ratio": Estimate(drive.ratio, None, "1", fixed=True),
    }
    return ParameterSet("drive", found)
