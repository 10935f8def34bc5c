"""Many free responses in one call of the compiled loop, which lets other threads go on all the while."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from ssmr_ident.core.errors import InputError
from ssmr_ident.core.kernel import kernel
from ssmr_ident.physics.robot import Robot
from ssmr_ident.physics.sensor import low_pass_coefficients
from ssmr_ident.physics.slots import Effects
from ssmr_ident.simulate import layout
from ssmr_ident.simulate.body import Body, body_of, let_go
from ssmr_ident.simulate.pulling import PULLING
from ssmr_ident.simulate.robot_kernel import run
from ssmr_ident.simulate.sensed import sensed
from ssmr_ident.simulate.simulation import grid

_OUTPUTS, _START = len(layout.OUTPUTS), layout.START


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
        NaN all through where a state was no longer finite, or the robot cannot have its effects.
    """
    step, stride, samples = grid(duration, sample_rate, step)
    bodies = _bodies(releases)
    # one axis of a turned sensor reads all three
    read = layout.OUTPUTS if any(body is not None and body.read_otherwise for body in bodies) else tuple(names)
    out = np.empty((len(releases), samples, len(read)))
    kept = np.array([layout.OUTPUTS.index(name) for name in read])
    groups: dict[tuple[int, bool], list[int]] = {}
    for index, body in enumerate(bodies):
        if body is None:
            out[index] = np.nan
        else:
            groups.setdefault((id(body.floor), body.beyond), []).append(index)
    for members in groups.values():
        own = list(dict.fromkeys(body for index in members if (body := bodies[index]) is not None))
        place = {id(body): number for number, body in enumerate(own)}
        run_many(
            np.array([body.packed for body in own]),
            np.array([body.e for body in own]),
            own[0].floor,
            np.array([body.mast for body in own]),
            np.array([low_pass_coefficients(body.robot.accelerometer.bandwidth_hz, step) for body in own]),
            np.array([body.rest for body in own]),
            np.array([(index, place[id(bodies[index])]) for index in members]),
            np.array([releases[index].away for index in members]),
            np.array([releases[index].moving for index in members]),
            step,
            (samples - 1) * stride,
            stride,
            True if own[0].beyond else None,
            kept,
            out,
        )
    for result, body in zip(out, bodies, strict=True):
        if body is not None and np.any(body.robot.accelerometer.gain != 1.0):
            result *= np.append(body.robot.accelerometer.gain, np.ones(_OUTPUTS - 3))[kept]
    time = np.arange(samples) / sample_rate
    for result, body in zip(out, bodies, strict=True):
        if body is not None and body.read_otherwise:
            channels = {name: result[:, index] for index, name in enumerate(read)}
            result[:] = np.column_stack(list(sensed(time, channels, body.active).values()))
    return out if read == tuple(names) else out[:, :, [read.index(name) for name in names]]


def _bodies(releases: Sequence[Release]) -> list[Body | None]:
    found: list[Body | None] = []
    last: Release | None = None
    for release in releases:
        if last is None or release.robot is not last.robot or release.effects is not last.effects:
            last = release
            try:
                body: Body | None = body_of(release.robot, release.effects)
            except InputError:  # a mast heavier than the robot
                body = None
        found.append(body)
    return found


@kernel
def run_many(p, e, floor, mast, low_pass, rest, which, away, moving, step, steps, stride, beyond, kept, out):
    """``run`` for every release.

    Parameters
    ----------
    p, e, mast, low_pass, rest : (m, ...) float
        Of each body, as ``run`` and ``let_go`` take them.
    which : (k, 2) int
        Place in ``out``, and body, of each release.
    away, moving : (k, 12) and (k, 8) float
    kept : (c,) int
        Outputs that are wanted.
    out : (l, n, c) float
        Filled; NaN where a state was no longer finite.
    """
    pulling, head, reference = np.zeros(PULLING), np.zeros(1), np.zeros((1, 2))
    whole = np.empty((out.shape[1], _OUTPUTS))
    for k in range(len(which)):
        place, b = which[k]
        start = np.zeros(_START)
        let_go(p[b], rest[b], away[k], moving[k], start)
        failed = run(
            p[b], e[b], floor, mast[b], pulling, head, 1.0, reference, 1.0, start, step, steps, stride,
            low_pass[b], whole, beyond,
        )  # fmt: skip
        for n in range(out.shape[1]):
            for c in range(len(kept)):
                out[place, n, c] = whole[n, kept[c]] if failed < 0 else np.nan
