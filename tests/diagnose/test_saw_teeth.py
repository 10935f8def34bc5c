"""Few teeth, compared in time: a constant friction goes through their middle, and no single probe leads away."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from ssmr_ident.campaign import Campaign, Measurement
from ssmr_ident.core.parameter import Estimate
from ssmr_ident.core.recording import Channel, Provenance, Recording
from ssmr_ident.diagnose.explore import fit_baseline
from ssmr_ident.diagnose.race import combined
from ssmr_ident.diagnose.scan import Suspect
from ssmr_ident.diagnose.setup import set_up
from ssmr_ident.physics.robot import robot_from_parameters
from ssmr_ident.session import Entry, Session
from ssmr_ident.session.parameters_file import read_parameters
from ssmr_ident.simulate import Scenario, simulate

RATE, NOISE = 50.0, 0.5
TRUE = {"kinetic_share": 0.72, "stribeck_velocity_m_s": 3e-3}
PULLS = (("longitudinal", 1.5, 21e-3), ("lateral", 1.0, 7e-3))


def test_all_combinations_show_the_falling_friction_and_the_limit_that_was_hidden() -> None:
    random = np.random.default_rng(4)
    known = read_parameters("p3at-extended")
    together = {"tire.mu_kinetic": known["tire.mu_static"], "tire.sliding_speed_m_s": Estimate(0.01, None, "m/s")}
    known = known.updated(together)
    measurements = []
    for k, (direction, speed, travel) in enumerate(PULLS):
        head = speed * 1e-3 / RATE * np.arange(round(travel / speed * 1e3 * RATE) + 1)
        scenario = Scenario(
            "pull", len(head) / RATE, head=np.append(head, 2.0 * head[-1] - head[-2]), head_step=1.0 / RATE,
            direction=direction, height=0.05, wheels_gripping=(1, 2, 3, 4), wheel_rates=np.zeros((1, 2)),
        )  # fmt: skip
        force = simulate(robot_from_parameters(known), scenario, RATE, effects={"stribeck": TRUE})["force"]
        seen = force + NOISE * random.standard_normal(len(head))
        channels = Channel("force", seen, "N"), Channel("position", head, "m")
        entry = Entry(f"pull-{k}.csv", "pull", direction=direction, speed_mm_s=speed, height_m=0.05, cable="steel")
        log = Recording(np.arange(len(head)) / RATE, channels, Provenance("made", "", "test"))
        measurements.append(Measurement(entry, log))
    session = Session("pulled", Path(), "robot", "rigid6", tuple(m.entry for m in measurements))
    setup = set_up(Campaign(session, known, tuple(measurements)), known)
    base = fit_baseline(setup.fitted, setup, known)
    probe = Suspect("stribeck", {"kinetic_share": 0.8, "stribeck_velocity_m_s": 0.01}, {}, {}, 0.0, np.zeros(1))
    found = combined(base, probe)
    hidden = known.number("tire.mu_static") / base.model.split(base.point)[0]["tire.mu_static"]
    assert hidden > 1.03
    values, effects = found[-1].model.split(found[-1].point)
    assert effects["stribeck"]["kinetic_share"] in (0.7, 0.8)
    assert values["tire.mu_static"] > base.model.split(base.point)[0]["tire.mu_static"]
    assert np.log(found[-1].parts / base.parts).mean() < -0.5
    assert combined(base, Suspect("motor_belt", {}, {}, {}, 0.0, np.zeros(1))) == []
