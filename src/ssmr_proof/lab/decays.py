"""Decays of the robot, as a lab would make them: pushed sideways, lengthwise or turned, and let go."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from ssmr_ident.core.recording import Channel
from ssmr_ident.physics.robot import Robot
from ssmr_proof.drawn.cases import Case
from ssmr_proof.drawn.hidden import Change
from ssmr_proof.lab.logs import Log
from ssmr_proof.lab.robots import Drawn
from ssmr_proof.plant.robot_bench import DECAY_STEP, Bench, Plant, Push
from ssmr_proof.plant.sensing import Chain, converted
from ssmr_proof.plant.spring_laws import law_vector

RATE = 1000.0  # Hz
AXES = ("ax", "ay", "az")


@dataclass(frozen=True)
class Programme:
    """How many decays, how long, and how hard the robot is pushed in them.

    Parameters
    ----------
    targets, heldout : tuple of str
        Motions.
    samples : int
    """

    targets: tuple[str, ...] = ("roll",) * 3 + ("pitch",) * 3 + ("yaw",) * 3
    heldout: tuple[str, ...] = ("roll", "roll", "pitch", "yaw")
    samples: int = 4096


def changed(robot: Robot, change: Change) -> Plant:
    """The plant: the true robot with its hidden physics."""
    offset = np.array([*change.offset_m, 0.0])
    sensor = robot.accelerometer
    slow = sensor.bandwidth_hz if change.bandwidth_hz is None else change.bandwidth_hz
    sensor = replace(sensor, position=sensor.position - offset, bandwidth_hz=slow)
    moved = robot.with_changes(contact_points=robot.contact_points - offset, accelerometer=sensor)
    cable = robot.cable_stiffness
    if change.cable_stiffness is not None:
        cable = cable * change.cable_stiffness / (cable + change.cable_stiffness)
    return Plant(
        moved, law_vector(**change.laws), change.frame, change.turned, change.kinetic_share,
        change.slip_speed, change.load_exponent, cable,
    )  # fmt: skip


def push(motion: str, strength: float, random: np.random.Generator) -> Push:
    """No two alike: none goes through one mode alone.

    Parameters
    ----------
    motion : str
    strength : float
        1 pushes hard, but no wheel lifts.
    random : numpy Generator
    """
    sign = float(random.choice([-1.0, 1.0])) * strength
    if motion == "roll":
        force, height, aside = sign * random.uniform(30.0, 45.0), random.normal(0.5, 0.04), random.normal(0.02, 0.03)
        return Push((0.0, force, 0.0), (-force * height, 0.0, force * aside))
    if motion == "pitch":
        force, height, aside = sign * random.uniform(28.0, 42.0), random.uniform(0.15, 0.3), random.normal(0.0, 0.02)
        return Push((force, 0.0, 0.0), (0.0, force * height, -force * aside))
    moment, side = sign * random.uniform(11.0, 19.0), random.normal(0.0, 3.0)
    return Push((0.0, side, 0.0), (-0.3 * side, 0.0, moment))


def decays(case: Case, drawn: Drawn, random: np.random.Generator, programme: Programme) -> list[Log]:
    """All recordings of a case of this family."""
    change = case.change
    plant = changed(drawn.robot, change)
    bench = Bench(plant, DECAY_STEP)
    white = float(random.uniform(0.007, 0.0125))
    hum = float(random.uniform(0.04, 0.14))
    if case.trap == "noise":
        white *= 6.0
    if case.trap == "hum":
        hum = float(random.uniform(0.5, 1.3))
    chain = Chain(white, hum, plant.robot.accelerometer.bandwidth_hz, drawn.robot.accelerometer.range_m_s2)
    logs = []
    for heldout, motions in ((False, programme.targets), (True, programme.heldout)):
        counts: dict[str, int] = {}
        # trials fall from hard to soft; held-out ones lie between them and beside them
        levels = (1.0, 0.62, 0.36) if not heldout else (0.8, 0.5)
        for motion in motions:
            trial = counts[motion] = counts.get(motion, 0) + 1
            # of the loud ones some stay soft: there the baseline holds
            level = levels[(trial - 1) % len(levels)] * random.uniform(0.9, 1.1)
            loud = change.loud if motion != "yaw" and trial < 3 else 1.0
            logs.append(_decay(bench, motion, trial, loud * level, chain, drawn.robot, random, heldout, programme))
    return logs


def _decay(
    bench: Bench, motion: str, trial: int, level: float, chain: Chain, robot: Robot, random: np.random.Generator,
    heldout: bool, programme: Programme,
) -> Log:  # fmt: skip
    stride = round(1.0 / (RATE * bench.step))
    # the release triggers the log
    fine, _ = bench.decay(push(motion, level, random), programme.samples / RATE)
    clean = chain.clean(fine, 1.0 / bench.step, stride)
    sensor = robot.accelerometer
    volts = converted(sensor.volts_zero + sensor.volts_per_m_s2 * chain.noisy(clean, RATE, random))
    logged = (volts - sensor.volts_zero) / sensor.volts_per_m_s2
    time = np.arange(len(clean)) / RATE
    channels = tuple(Channel(name, volts[:, i], "V", f"Voltage_{i}") for i, name in enumerate(AXES))
    entry = {"experiment": "free_response", "motion": motion, "trial": trial}
    return Log(f"{motion}-{trial}", entry, time, channels, clean, logged, AXES, 50.0, heldout)
