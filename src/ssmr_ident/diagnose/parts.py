"""Parts of recordings, a period long, and what a baseline's parameters would be in each.

That is one linearised step on the part's samples alone.

Nuisances are free in every part, so that a part does not inherit what went before it: a wrong stiffness shows in the
part itself, not as the phase that earlier parts left behind.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from ssmr_ident.diagnose.motion import main_channel, motion_of
from ssmr_ident.diagnose.residual_map import counting
from ssmr_ident.identify.fitting.joint import JointFit

Array = np.ndarray

MOST = 30
"""Windows of a recording."""

FEWEST = 12
"""Samples of a part."""

FEWEST_WINDOWS = 8
"""Of a recording in which nothing swings."""

FEW, LONG = 4, 2.0
"""A window is one period; where more nuisances than these are free in it, it takes more periods to leave something."""

TINY = 1e-6

MOVING = 0.03
"""Share of the largest amplitude below which a window says nothing of the physics."""


@dataclass(frozen=True, eq=False)
class Part:
    """Some samples of a recording, and what they say of the chosen parameters.

    Parameters
    ----------
    along : mapping of axis to float
        Where the part lies: amplitude, speed, time, travel, load; or the side of a sign.
    move, std : (p,) float
        Of the parameters' scaled coordinates.
    motion : tuple
        Parts of one motion share it: their amplitudes can be held against each other.
    """

    along: dict[str, float]
    move: Array
    std: Array
    motion: tuple[str, ...] = ()


def windows(fit: JointFit, columns: Sequence[int], halved: bool = False) -> list[Part]:
    """Stretches of about a period in every recording.

    Parameters
    ----------
    fit : JointFit
        With slopes.
    columns : sequence of int
        Coordinates that are refitted; all others stay.
    halved : bool
        Each stretch is parted once more: by the side of the middle, and by the direction of motion.
    """
    found = []
    for index, trial in enumerate(fit.trials):
        count = len(trial.times) - trial.lost
        since = trial.times[trial.lost :] - trial.times[0]
        state, period = _state(fit, index)
        motion = (trial.experiment.name, trial.kind)
        pieces = min(MOST, int(since[-1] / period), count // FEWEST)
        if pieces < 2:
            continue
        for rows in np.array_split(np.arange(count), pieces):
            inside = np.zeros(count, dtype=bool)
            inside[rows] = True
            along = {name: float(np.sqrt(2.0) * np.std(values[rows])) for name, values in state.items()}
            along["time"] = float(since[rows].mean())
            if trial.channels == ("force",):
                travel = float(trial.facts["travel_m"])
                along["travel"] = travel * along["time"] / float(since[-1])
                along["load"] = float(np.mean(np.abs(trial.target[trial.lost :][rows, 0])))
                along["pulling speed"] = travel / float(since[-1])
            if not halved:
                found.append(_part(fit, index, inside, columns, along, motion))
                continue
            for axis, name in (("amplitude", "side"), ("speed", "direction")):
                for sign in (-1.0, 1.0):
                    half = inside & (sign * state[axis] > 0.0)
                    if np.count_nonzero(half) >= FEWEST // 2:
                        found.append(_part(fit, index, half, columns, {**along, name: sign}, motion))
    largest = max((part.along.get("amplitude", 0.0) for part in found), default=0.0)
    return [part for part in found if part.along.get("amplitude", np.inf) >= MOVING * largest]


def _state(fit: JointFit, index: int) -> tuple[dict[str, Array], float]:
    """Displacement and velocity (nothing of a pull), and the length of a window [s]."""
    trial = fit.trials[index]
    if trial.channels == ("force",):
        return {}, float(trial.times[-1] - trial.times[0]) / FEWEST_WINDOWS
    channel = main_channel(trial)
    motion = motion_of(trial, trial.target[:, channel], channel)
    displacement = motion.displacement - np.mean(motion.displacement)
    state = {"amplitude": displacement[trial.lost :], "speed": motion.velocity[trial.lost :]}
    return state, (LONG if len(trial.nuisances) > FEW else 1.0) / motion.frequency


def _part(
    fit: JointFit,
    index: int,
    inside: Array,
    columns: Sequence[int],
    along: dict[str, float],
    motion: tuple[str, ...],
) -> Part:
    trial, slopes = fit.trials[index], fit.slopes[index]
    kept = np.concatenate([inside & counting(fit, index, c) for c in range(len(trial.channels))])
    a, b, r = slopes.shared[kept][:, columns], slopes.own[kept], fit.residuals[index][kept]
    own = b.T @ b + np.eye(b.shape[1])
    cross = b.T @ a
    solved = np.linalg.solve(own, np.column_stack([cross, b.T @ r]))
    information = a.T @ a - cross.T @ solved[:, :-1]
    right = a.T @ r - cross.T @ solved[:, -1]
    information[np.diag_indices_from(information)] += TINY  # what a part says nothing of stays open
    covariance = np.linalg.inv(information)
    return Part(along, covariance @ right, np.sqrt(np.diag(covariance)), motion)
