"""Whole sessions of swivels, simulated, so that their truth is known. Practice sessions: `make bench-doctor`."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from simulated_swivels import campaign, known, run

from ssmr_ident.core.errors import InputError
from ssmr_ident.doctor.swivels import diagnose_swivels
from ssmr_ident.doctor.swivels.bench import STEP, Bench, measure
from ssmr_ident.doctor.swivels.conditions import conditions_of, held_back
from ssmr_ident.doctor.swivels.spectral_distance import channel_logs, distance_db
from ssmr_ident.experiments.swivel import swivel
from ssmr_ident.physics.motor import wheel_rates
from ssmr_ident.physics.robot import robot_from_parameters
from ssmr_ident.simulate.simulation import simulate

pytestmark = pytest.mark.slow


def test_nothing_is_missing_where_targets_repeat_the_calibration():
    stages = []
    found = diagnose_swivels(
        campaign(run(40, "calibration", {}, 1), run(40, "target", {}, 2)),
        progress=lambda stage, done, total: stages.append((stage, done, total)),
    )
    assert found.verdict == "nothing_missing"
    assert found.effects == ()
    assert found.before == found.after
    assert "lambda_max" in " ".join(found.notes)
    assert all(done <= total for _, done, total in stages)
    assert {stage for stage, done, total in stages if done == total} == {stage for stage, _, _ in stages}


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
        diagnose_swivels(campaign(replace(short, recording=cut)))


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
