"""Which swivel would tell the remaining explanations apart best: both are simulated at other speeds."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from ssmr_ident.doctor.swivels.conditions import Condition
from ssmr_ident.doctor.swivels.outcome import Outcome
from ssmr_ident.doctor.swivels.spectral_distance import channel_logs, distance_db
from ssmr_ident.physics.motor import wheel_rates
from ssmr_ident.physics.robot import robot_from_parameters

SPEEDS_DEG_S = (12.0, 20.0, 30.0, 45.0, 60.0, 80.0)


def next_run(outcome: Outcome, named: tuple[str, ...]) -> str:
    """A sentence; empty where nothing is left to tell apart."""
    every = {one.id: one for one in (*outcome.screened[::-1], *outcome.explanations[::-1])}
    rivals = [every[name] for name in named if name in every]
    if len(named) == 1 or len(rivals) < 2:
        if named or outcome.calibrated:
            return ""
        return "Record one of the speeds without the puzzling condition, as role: calibration"
    robot = robot_from_parameters(outcome.bench.parameters)
    model = next((c for c in outcome.targets if c.settling > 0.0), None)
    if model is None:
        return "Record a steady turn of 20 s without the puzzling condition, as role: calibration"
    best, where = 0.0, 0.0
    shown = np.rad2deg([abs(c.turning) for c in outcome.targets])
    speeds = [s for s in SPEEDS_DEG_S if shown.min() <= s <= shown.max()] or [float(shown.max())]
    for speed in speeds:
        turning = float(np.deg2rad(speed))
        c = replace(model, rates=np.atleast_2d(wheel_rates(robot, 0.0, turning)), turning=turning)
        logs = [_logs(outcome, c, one.anchor.values, one.effects) for one in rivals[:2]]
        if logs[0] is None or logs[1] is None:
            continue
        apart = distance_db(logs[0], logs[1])
        if apart > best:
            best, where = apart, speed
    if best == 0.0:
        return ""
    return (
        f"Swivel for 20 s at {where:g} deg/s: {rivals[0].id} and {rivals[1].id} differ there by {best:.1f} dB "
        "in the simulated spectra, more than at any other speed between those recorded"
    )


def _logs(outcome: Outcome, c: Condition, values: dict, effects: dict) -> np.ndarray | None:
    run = outcome.bench.run(c, values, effects, (1,))
    return None if run is None else channel_logs(run.look, c.noise)
