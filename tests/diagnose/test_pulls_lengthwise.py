"""Tires go five times as far lengthwise: what hardens there alone is found beside pulls that show nothing of it."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from ssmr_ident.campaign import Campaign, Measurement
from ssmr_ident.core.parameter import Estimate, ParameterSet
from ssmr_ident.core.recording import Channel, Provenance, Recording
from ssmr_ident.diagnose.explore import best_baseline, search
from ssmr_ident.diagnose.scan import Suspect, both_ways
from ssmr_ident.diagnose.setup import Setup, set_up
from ssmr_ident.diagnose.sizes import sizes_of
from ssmr_ident.physics.robot import robot_from_parameters
from ssmr_ident.session import Entry, Session
from ssmr_ident.session.parameters_file import read_parameters
from ssmr_ident.simulate import Scenario, simulate

RATE, NOISE, K3 = 50.0, 0.5, 1.2e6
"""Hz; N; N/m^3: a third of the tire's stiffness at 30 mm, nothing at the 4 mm of a lateral pull."""

PULLS = (("lateral", 1.0, 6e-3), ("lateral", 0.5, 6e-3), ("longitudinal", 2.0, 30e-3), ("longitudinal", 3.0, 30e-3))


@pytest.fixture(scope="module")
def pulled() -> tuple[Setup, ParameterSet]:
    random = np.random.default_rng(3)
    known = read_parameters("p3at-extended")
    together = {"tire.mu_kinetic": known["tire.mu_static"], "tire.sliding_speed_m_s": Estimate(0.01, None, "m/s")}
    known = known.updated(together)
    measurements = []
    for k, (direction, speed, travel) in enumerate(PULLS):
        head = speed * 1e-3 / RATE * np.arange(round(travel / speed * 1e3 * RATE) + 1)
        going_on = np.append(head, 2.0 * head[-1] - head[-2])
        scenario = Scenario(
            "pull", len(head) / RATE, head=going_on, head_step=1.0 / RATE, direction=direction, height=0.05,
            wheels_gripping=(1, 2, 3, 4), wheel_rates=np.zeros((1, 2)),
        )  # fmt: skip
        force = simulate(robot_from_parameters(known), scenario, RATE, effects={"nonlinear_stiffness": {"k3_N_m3": K3}})
        seen = force["force"] + NOISE * random.standard_normal(len(head))
        channels = Channel("force", seen, "N"), Channel("position", head, "m")
        entry = Entry(f"pull-{k}.csv", "pull", direction=direction, speed_mm_s=speed, height_m=0.05, cable="steel")
        log = Recording(np.arange(len(head)) / RATE, channels, Provenance("made", "", "test"))
        measurements.append(Measurement(entry, log))
    session = Session("pulled", Path(), "robot", "rigid6", tuple(m.entry for m in measurements))
    campaign = Campaign(session, known, tuple(measurements))
    return set_up(campaign, known), known


def test_hardening_is_found_in_the_direction_that_goes_far(pulled: tuple[Setup, ParameterSet]) -> None:
    setup, known = pulled
    base, lengths = best_baseline(setup.fitted, setup, known)
    load = max(float(np.ptp(t.target)) for t in base.trials)
    sizes = sizes_of(base)
    values, _ = base.model.split(base.point)
    assert sizes["reach"] == pytest.approx(load / (4.0 * values["tire.stiffness_x_N_m"]), rel=0.1)
    assert sizes["deflection"] < 0.3 * sizes["reach"]
    left = {t.name: p / t.size for t, p in zip(base.trials, base.parts, strict=True)}
    assert max(left.values()) > 20.0
    first = search(base, "rigid6", lengths).tried[0]
    assert first.model.ids == ("nonlinear_stiffness",)
    assert first.model.split(first.point)[1]["nonlinear_stiffness"]["k3_N_m3"] == pytest.approx(K3, rel=0.1)
    assert np.max(first.parts / [t.size for t in first.trials]) < 4.0


def test_what_may_change_sign_is_tried_the_other_way_too() -> None:
    suspect = Suspect("nonlinear_stiffness", {"k3_N_m3": -4e6}, {}, {"k3_N_m3": 1e7}, 17.0, np.zeros(1))
    _, back = both_ways(suspect)
    assert back.at["k3_N_m3"] > 0.0
    friction = Suspect("dry_friction", {"F_c_N": 3.0}, {}, {}, 17.0, np.zeros(1))
    assert both_ways(friction) == [friction]
