"""Whole sessions of swivels, simulated, so that their truth is known. Practice sessions: `make bench-doctor`."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from ssmr_ident.compare import compare
from ssmr_ident.core.errors import InputError
from ssmr_ident.core.parameter import Estimate
from ssmr_ident.core.recording import Channel, Provenance, Recording
from ssmr_ident.diagnose.turning import diagnose_turning
from ssmr_ident.diagnose.turning.bench import STEP, Bench, measure
from ssmr_ident.diagnose.turning.conditions import conditions_of, held_back
from ssmr_ident.diagnose.turning.spectral_distance import channel_logs, distance_db
from ssmr_ident.experiments.campaign import Campaign, Measurement
from ssmr_ident.experiments.swivel import swivel
from ssmr_ident.physics.motor import wheel_rates
from ssmr_ident.physics.robot import robot_from_parameters
from ssmr_ident.session import Entry, Session, read_parameters
from ssmr_ident.simulate.simulation import simulate

pytestmark = pytest.mark.slow

JOINTS = {"ground_joints": {"pitch_m": 0.03, "depth_m": 6e-4, "width_m": 6e-3}}


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


def test_nothing_is_missing_where_targets_repeat_the_calibration():
    stages = []
    found = diagnose_turning(
        campaign(run(40, "calibration", {}, 1), run(40, "target", {}, 2)),
        progress=lambda stage, done, total: stages.append((stage, done, total)),
    )
    assert found.verdict == "nothing_missing"
    assert found.effects == ()
    assert found.before == found.after
    assert "lambda_max" in " ".join(found.notes)
    assert all(done <= total for _, done, total in stages)
    assert {stage for stage, done, total in stages if done == total} == {stage for stage, _, _ in stages}


def test_joints_are_named_and_their_distance_found():
    found = diagnose_turning(
        campaign(
            run(40, "calibration", {}, 1), run(40, "target", JOINTS, 2), run(28, "heldout", JOINTS, 3),
        )
    )  # fmt: skip
    assert found.verdict == "missing_physics"
    assert "ground_joints" in (found.effects[0].id, *found.effects[0].indistinguishable_from)
    assert found.heldout.recordings == ("heldout-28-3.csv",)
    assert found.heldout.after < 2.0 / 3.0 * found.heldout.before
    assert found.located[0].recording == "target-40-2.csv"
    assert found.evidence.speeds[0].recorded.shape == (2, 50)
    yaml = found.as_dict()
    assert set(yaml["fit"]) == {"metric", "training", "heldout"}
    again = compare(campaign(run(28, "heldout", JOINTS, 3)), found.after)
    assert again.overall["log_psd_db"] == pytest.approx(found.heldout.after, abs=1.5)


def test_without_held_out_recordings_some_are_kept_back():
    three = campaign(*(run(speed, "target", {}, speed, 13.0) for speed in (24, 36, 48)))
    kept, notes = held_back(three)
    assert [m.entry.role for m in kept] == ["target", "heldout", "target"]
    assert "36" in notes[0]
    one = campaign(run(24, "target", {}, 1))
    halves, notes = held_back(one)
    assert [m.entry.role for m in halves] == ["target", "heldout"]
    assert halves[0].recording.time[-1] < halves[1].recording.time[0]


def test_too_short_a_session_is_refused_in_one_line():
    short = run(24, "target", {}, 1)
    cut = replace(short.recording, time=short.recording.time[:500], channels=tuple(
        replace(c, samples=c.samples[:500]) for c in short.recording.channels
    ))  # fmt: skip
    with pytest.raises(InputError, match="no swivel of"):
        diagnose_turning(campaign(replace(short, recording=cut)))


def test_the_step_of_the_search_is_short_enough():
    """Spectra at 0.5 ms lie as near those at 0.125 ms as two runs over different floors do."""
    conditions, _ = conditions_of(campaign(run(40, "target", {}, 1)), known())
    bench = Bench(known())
    usual = bench.run(conditions[0], {}, {}, (1, 2, 3))
    robot = robot_from_parameters(known())
    logs = []
    for step in (STEP, STEP / 4.0):
        looks = []
        for seed in (1, 2, 3):
            grain = {"height_m": 3e-5, "length_m": 6e-3, "seed": float(seed)}
            scenario = swivel(wheel_rates(robot, 0.0, np.deg2rad(40.0)), 14.0)
            simulation = simulate(robot, scenario, 500.0, step, {"ground_roughness": grain})
            looks.append(channel_logs(measure(simulation, conditions[0], seed).look, conditions[0].noise))
        logs.append(np.mean(looks, axis=0))
    assert usual is not None
    assert distance_db(*logs) < 1.5
