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
from ssmr_ident.simulate.body import Body, body_of, pack_robot
from ssmr_ident.simulate.pulling import PULLING
from ssmr_ident.simulate.robot_kernel import run
from ssmr_ident.simulate.scenarios import Scenario
from ssmr_ident.simulate.sensed import sensed
from ssmr_ident.simulate.simulation import grid

_OUTPUTS = len(layout.OUTPUTS)


@dataclass(frozen=True, eq=False)
class Release:
    """A robot with effects, and how it is let go: a free response on wheels that stand.

    Parameters
    ----------
    robot : Robot
    effects : mapping of effect id to mapping of parameter to value
    scenario : Scenario
    """

    robot: Robot
    effects: Effects
    scenario: Scenario


def simulate_many(releases: Sequence[Release], sample_rate: float, step: float, names: Sequence[str]) -> np.ndarray:
    """Integrate releases of one duration; to the last bit what ``simulate`` gives of each.

    Parameters
    ----------
    releases : sequence of Release
        Those that follow each other with the very same robot and effects share what is worked out of these.
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
    step, stride, samples = grid(releases[0].scenario, sample_rate, step)
    out = np.empty((len(releases), samples, len(names)))
    kept = np.array([layout.OUTPUTS.index(name) for name in names])
    bodies = _bodies(releases)
    groups: dict[tuple[int, bool], list[int]] = {}
    for index, body in enumerate(bodies):
        if body is None:
            out[index] = np.nan
        else:
            groups.setdefault((id(body.floor), body.beyond), []).append(index)
    for members in groups.values():
        own = list(dict.fromkeys(body for body in (bodies[index] for index in members) if body is not None))
        place = {body: index for index, body in enumerate(own)}
        chosen = [(index, body) for index in members if (body := bodies[index]) is not None]
        some = out if len(members) == len(releases) else np.empty((len(members), samples, len(names)))
        run_many(
            np.array([pack_robot(body.robot, releases[members[0]].scenario) for body in own]),
            np.array([body.e for body in own]),
            own[0].floor,
            np.array([body.mast for body in own]),
            np.array([low_pass_coefficients(body.robot.accelerometer.bandwidth_hz, step) for body in own]),
            np.array([place[body] for _, body in chosen]),
            np.array([body.start(releases[index].scenario) for index, body in chosen]),
            step,
            (samples - 1) * stride,
            stride,
            True if own[0].beyond else None,
            kept,
            some,
        )
        if some is not out:
            out[members] = some
    time = np.arange(samples) / sample_rate
    for result, body in zip(out, bodies, strict=True):
        if body is not None and body.read_otherwise:
            channels = {name: result[:, index] for index, name in enumerate(names)}
            result[:] = np.column_stack(list(sensed(time, channels, body.active).values()))
    return out


def _bodies(releases: Sequence[Release]) -> list[Body | None]:
    found: list[Body | None] = []
    last: Release | None = None
    for release in releases:
        if last is not None and release.robot is last.robot and release.effects is last.effects:
            found.append(found[-1])
            continue
        last = release
        try:
            found.append(body_of(release.robot, release.effects))
        except InputError:  # a mast heavier than the robot
            found.append(None)
    return found


@kernel
def run_many(p, e, floor, mast, low_pass, which, starts, step, steps, stride, beyond, kept, out):
    """``run`` for every start.

    Parameters
    ----------
    p, e, mast, low_pass : (m, ...) float
        Of each body, as ``run`` takes them.
    which : (k,) int
        Body of each start.
    starts : (k, START) float
    kept : (c,) int
        Outputs that are wanted.
    out : (k, n, c) float
        Filled; NaN where a state was no longer finite.
    """
    pulling, head, reference = np.zeros(PULLING), np.zeros(1), np.zeros((1, 2))
    whole = np.empty((out.shape[1], _OUTPUTS))
    for k in range(len(which)):
        b = which[k]
        failed = run(
            p[b], e[b], floor, mast[b], pulling, head, 1.0, reference, 1.0, starts[k], step, steps, stride,
            low_pass[b], whole, beyond,
        )  # fmt: skip
        for n in range(out.shape[1]):
            for c in range(len(kept)):
                out[k, n, c] = whole[n, kept[c]] if failed < 0 else np.nan
