"""Pulls of a robot off its centre, by either law of sliding."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from ssmr_ident.core.parameter import Estimate
from ssmr_ident.core.recording import Channel, Provenance, Recording
from ssmr_ident.doctor.robots.run import SLIDES
from ssmr_ident.experiments import Scenario
from ssmr_ident.experiments.campaign import Campaign, Measurement
from ssmr_ident.physics.robot import robot_from_parameters
from ssmr_ident.session import Entry, Session
from ssmr_ident.session.parameters_file import read_parameters
from ssmr_ident.simulate import simulate

RATE, NOISE = 50.0, 0.3
PULLS = ((1.0, (1, 2, 3, 4)), (1.0, (1, 2)), (0.6, (1, 2, 3, 4)), (1.5, (3, 4)))
AXLES = ((1.0, (1, 2, 3, 4)), (1.0, (1, 4)), (0.6, (1, 2, 3, 4)), (1.5, (2, 3)))
"""About one gripping axle a robot turns, so that wheels slide along both axes: there the two laws differ."""


def pulled(cone: bool, plan: tuple[tuple[float, tuple[int, ...]], ...] = PULLS, noise: float = NOISE) -> Campaign:
    random = np.random.default_rng(6)
    known = read_parameters("p3at-extended")
    known = known.updated({"tire.mu_kinetic": known["tire.mu_static"]})
    points = np.asarray(known["contact_points_m"].value, dtype=float) + np.array([-0.009, 0.004, 0.0])
    true = known.updated({"contact_points_m": Estimate(points, None, "m")})
    if cone:
        true = true.updated({SLIDES: Estimate(0.3, None, "m/s")})
    robot = robot_from_parameters(true)
    made = []
    for number, (speed, wheels) in enumerate(plan):
        head = speed * 1e-3 / RATE * np.arange(round(7.0 / speed * RATE) + 1)
        scenario = Scenario(
            "pull", len(head) / RATE, head=np.append(head, 2.0 * head[-1] - head[-2]), head_step=1.0 / RATE,
            direction="lateral", height=0.05, wheels_gripping=wheels, wheel_rates=np.zeros((1, 2)),
        )  # fmt: skip
        force = simulate(robot, scenario, RATE)["force"] + noise * random.standard_normal(len(head))
        log = Recording(
            np.arange(len(head)) / RATE,
            (Channel("force", force, "N"), Channel("position", head, "m")),
            Provenance("made", "", "test"),
        )
        entry = Entry(
            f"pull-{number}.csv", "pull", direction="lateral", speed_mm_s=speed, height_m=0.05,
            wheels_gripping=wheels, cable="steel",
        )  # fmt: skip
        made.append(Measurement(entry, log))
    return Campaign(Session("pulled", Path(), "robot", "rigid6", tuple(m.entry for m in made)), known, tuple(made))
