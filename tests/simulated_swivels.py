"""Swivels simulated on floors of their own, with noise, so that their truth is known."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from ssmr_ident.core.parameter import Estimate
from ssmr_ident.core.recording import Channel, Provenance, Recording
from ssmr_ident.experiments.campaign import Campaign, Measurement
from ssmr_ident.experiments.swivel import swivel
from ssmr_ident.physics.motor import wheel_rates
from ssmr_ident.physics.robot import robot_from_parameters
from ssmr_ident.session import Entry, Session, read_parameters
from ssmr_ident.simulate.simulation import simulate


def known():
    changes = {"tire.sliding_speed_m_s": Estimate(0.35, 0.1, "m/s"), "floor.height_m": Estimate(3e-5, 1e-5, "m")}
    return read_parameters("p3at-extended").updated(changes)


def run(speed, role, effects, seed, seconds=14.0):
    """One recording, in SI, with noise; its floor is its own."""
    parameters = known()
    robot = robot_from_parameters(parameters)
    grain = {"height_m": 3e-5, "length_m": 6e-3, "seed": 1e5 + seed}
    scenario = swivel(wheel_rates(robot, 0.0, np.deg2rad(speed)), seconds + 3.0)
    simulation = simulate(robot, scenario, 500.0, 2.5e-4, {"ground_roughness": grain, **effects})
    part = slice(1500, None)
    random = np.random.default_rng(seed)
    time = simulation.time[part] - simulation.time[1500]
    channels = tuple(
        Channel(name, simulation[name][part] + 0.04 * random.standard_normal(len(time)), "m/s^2") for name in
        ("ax", "ay", "az")
    )  # fmt: skip
    entry = Entry(f"{role}-{speed}-{seed}.csv", "swivel", role=role, yaw_rate_deg_s=float(speed))
    return Measurement(entry, Recording(time, channels, Provenance("drawn", "", "simulator")))


def campaign(*measurements):
    session = Session("drawn", Path(), "p3at-extended", "rigid6", tuple(m.entry for m in measurements))
    return Campaign(session, known(), measurements)
