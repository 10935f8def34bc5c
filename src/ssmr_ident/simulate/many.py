"""Many runs in one call of the compiled loop, which lets other threads go on all the while."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from ssmr_ident.core.errors import Impossible
from ssmr_ident.experiments.scenario import Scenario
from ssmr_ident.physics.robot import Robot
from ssmr_ident.physics.slots import Effects
from ssmr_ident.simulate import layout
from ssmr_ident.simulate.body import Body, body_of, let_all_go
from ssmr_ident.simulate.sensed import sensed
from ssmr_ident.simulate.simulation import grid, prepared
from ssmr_ident.simulate.together import STILL, Run, run_together

SENSED = ("ax", "ay", "az", "wx", "wy", "wz", "force", "head")
"""What sensors see, and effects on them may read: one axis of a turned sensor reads all three."""

NO_HEAD, AT_REST = np.zeros(1), np.zeros((1, 2))


@dataclass(frozen=True, eq=False)
class Release:
    """A robot with effects, and how it is let go: a free response on wheels that stand.

    Parameters
    ----------
    robot : Robot
    effects : mapping of effect id to mapping of parameter to value
    away, moving : (12,) and (8,) float
        Offsets and velocities of a scenario, in the order of ``AWAY`` and ``MOVING``.
    """

    robot: Robot
    effects: Effects
    away: np.ndarray
    moving: np.ndarray


def simulate_many(
    releases: Sequence[Release], duration: float, sample_rate: float, step: float, names: Sequence[str]
) -> np.ndarray:
    """Integrate releases; to the last bit what ``simulate`` gives of each.

    Parameters
    ----------
    releases : sequence of Release
    duration : float [s]
    sample_rate : float [Hz]
    step : float [s]
        Upper limit of the integration step.
    names : sequence of str
        Of the channels that are kept.

    Returns
    -------
    (k, n, c) float
        NaN all through where a state was no longer finite, or a mast is too heavy for its robot.
    """
    bodies = _bodies(releases)
    there = [(body, release) for body, release in zip(bodies, releases, strict=True) if body is not None]
    starts = np.zeros((len(there), layout.START))
    if there:
        let_all_go(
            np.array([body.packed for body, _ in there]),
            np.array([body.rest for body, _ in there]),
            np.array([release.away for _, release in there]),
            np.array([release.moving for _, release in there]),
            starts,
        )
    begin = iter(starts)
    runs = [None if body is None else Run(body, body.packed, next(begin), STILL, NO_HEAD) for body in bodies]
    return _channels(runs, duration, sample_rate, step, names, 1.0, AT_REST, 1.0)


def simulate_alike(
    scenarios: Sequence[tuple[Robot, Effects, Scenario]], sample_rate: float, step: float, names: Sequence[str]
) -> np.ndarray:
    """Integrate scenarios of one length, on wheels that turn alike; to the last bit what ``simulate`` gives of each.

    Parameters
    ----------
    scenarios : sequence of (Robot, mapping of effect id to mapping of parameter to value, Scenario)
    sample_rate, step, names
        As ``simulate_many`` takes them.

    Returns
    -------
    (k, n, c) float
        As ``simulate_many`` gives it.
    """
    runs: list[Run | None] = []
    for robot, effects, scenario in scenarios:
        try:
            runs.append(prepared(robot, scenario, effects))
        except Impossible:
            runs.append(None)
    one = scenarios[0][2]
    return _channels(runs, one.duration, sample_rate, step, names, one.head_step, one.wheel_rates, one.wheel_rate_step)


def _channels(
    runs: Sequence[Run | None],
    duration: float,
    sample_rate: float,
    step: float,
    names: Sequence[str],
    head_step: float,
    rates: np.ndarray,
    rate_step: float,
) -> np.ndarray:
    """What the sensors read of runs, (k, n, c) float."""
    step, stride, samples = grid(duration, sample_rate, step)
    read = tuple(names)
    there = [index for index, one in enumerate(runs) if one is not None]
    possible = [one for one in runs if one is not None]
    otherwise = any(one.body.read_otherwise for one in possible)
    if otherwise:
        read = tuple(dict.fromkeys((*names, *SENSED)))
    kept = np.array([layout.OUTPUTS.index(name) for name in read])
    out = run_together(possible, head_step, rates, rate_step, step, stride, samples, kept)
    if len(possible) < len(runs):
        found, out = out, np.full((len(runs), samples, len(read)), np.nan)
        out[there] = found
    if not otherwise and all(one.body.scaled is None for one in possible):
        return out
    time = np.arange(samples) / sample_rate
    for result, one in zip(out, runs, strict=True):
        if one is None:
            continue
        if one.body.scaled is not None:
            result *= one.body.scaled[kept]
        if one.body.read_otherwise:
            channels = {name: result[:, index] for index, name in enumerate(read)}
            result[:] = np.column_stack(list(sensed(time, channels, one.body.active).values()))
    return out if read == tuple(names) else out[:, :, [read.index(name) for name in names]]


def _bodies(releases: Sequence[Release]) -> list[Body | None]:
    found: list[Body | None] = []
    last: Release | None = None
    for release in releases:
        if last is None or release.robot is not last.robot or release.effects is not last.effects:
            last = release
            try:
                body: Body | None = body_of(release.robot, release.effects)
            except Impossible:
                body = None
        found.append(body)
    return found
