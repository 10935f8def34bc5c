"""Pulls of a robot that the bundled simulator makes, with something hidden in them."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from pathlib import Path

import numpy as np

from ssmr_ident.core.parameter import Estimate, ParameterSet
from ssmr_ident.core.recording import Channel, Provenance, Recording
from ssmr_ident.diagnose.setup import Setup, set_up
from ssmr_ident.experiments import Scenario
from ssmr_ident.experiments.campaign import Campaign, Measurement
from ssmr_ident.physics.robot import robot_from_parameters
from ssmr_ident.session import Entry, Session
from ssmr_ident.session.parameters_file import read_parameters
from ssmr_ident.simulate import simulate

RATE, NOISE = 50.0, 0.5
"""Hz; N."""


def made_pulls(
    pulls: Sequence[tuple[str, float, float]],
    effects: Mapping[str, Mapping[str, float]],
    seed: int,
    aside: float = 0.0,
    real: Mapping[str, float] | None = None,
    turning: Sequence[float] = (),
) -> tuple[Setup, ParameterSet]:
    """Pulls of given direction, speed [mm/s] and travel [m]; the robot slides along both axes together.

    Its contacts lie ``aside`` [m] of where its file has them, and its ``real`` values differ from those in its file.
    Where wheels turn at rates of ``turning`` [rad/s], one per pull, each axis slides by itself, and the file does not
    say how turning takes grip away.
    """
    random = np.random.default_rng(seed)
    known = read_parameters("p3at-extended")
    known = known.updated({"tire.mu_kinetic": known["tire.mu_static"]})
    if turning:
        known = replace(known, estimates={path: e for path, e in known.items() if path != "tire.lambda_max"})
    else:
        known = known.updated({"tire.sliding_speed_m_s": Estimate(0.01, None, "m/s")})
    moved = Estimate(known["contact_points_m"].value + np.array([0.0, aside, 0.0]), None, "m")
    own = {path: Estimate(value) for path, value in (real or {}).items()}
    robot = robot_from_parameters(known.updated({"contact_points_m": moved, **own}))
    measurements = []
    for k, (direction, speed, travel) in enumerate(pulls):
        rate = turning[k] if turning else 0.0
        head = speed * 1e-3 / RATE * np.arange(round(travel / speed * 1e3 * RATE) + 1)
        scenario = Scenario(
            "pull", len(head) / RATE, head=np.append(head, 2.0 * head[-1] - head[-2]), head_step=1.0 / RATE,
            direction=direction, height=0.05, wheels_gripping=(1, 2, 3, 4), wheel_rates=np.full((1, 2), rate),
            held=rate > 0.0,
        )  # fmt: skip
        force = simulate(robot, scenario, RATE, effects=effects)["force"]
        seen = force + NOISE * random.standard_normal(len(head))
        channels = Channel("force", seen, "N"), Channel("position", head, "m")
        entry = Entry(
            f"pull-{k}.csv", "pull", direction=direction, speed_mm_s=speed, height_m=0.05, cable="steel",
            wheel_rate_rad_s=rate or None,
        )  # fmt: skip
        log = Recording(np.arange(len(head)) / RATE, channels, Provenance("made", "", "test"))
        measurements.append(Measurement(entry, log))
    session = Session("pulled", Path(), "robot", "rigid6", tuple(m.entry for m in measurements))
    return set_up(Campaign(session, known, tuple(measurements)), known), known
