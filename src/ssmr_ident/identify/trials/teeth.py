"""Saw-teeth of a pull, compared by how large they are and not by when they come.

When a stick lets go depends on everything before it: two simulations that differ by a thousandth, or two runs of one
robot, soon have their teeth at different times. What repeats is how the forces are distributed. In windows of a few
teeth forces are therefore put in order of size, measured and simulated ones alike: their difference is then that of
the two distributions' quantiles (its square the Wasserstein distance of order two), in newtons.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from ssmr_ident.identify.forces.sawtooth import machine_moves, take_apart
from ssmr_ident.signals.noise import white_std

Array = np.ndarray

TEETH, WINDOWS = 5, 6
"""Teeth that a window holds at least, and windows at most: fewer teeth say little of a distribution, and a pull whose
level drifts wants more than one window."""

FIRST_RISE = 0.7
"""Share of the force at the first letting go up to which a slack is looked for: a simulation may let go earlier."""


@dataclass(frozen=True, eq=False)
class Teeth:
    """Where a recording's teeth are, on its grid of averages.

    Parameters
    ----------
    rise : int
        Sample of the log before which nothing slides, whatever the friction: there a slack shows.
    edges : tuple of int
        Windows in which averages are put in order; what comes before the first is compared as it is.
    weight : (n,) float
        By which differences count, so that chance, which has a window's quantiles vary by the teeth's standard
        deviation over the root of their number, is as large as the noise.
    noise : float [N]
        Of an average.
    count : int
    """

    rise: int
    edges: tuple[int, ...]
    weight: Array
    noise: float
    count: int

    def ordered(self, averages: Array) -> Array:
        """Averages (n, 1), in order of size window by window, and weighted."""
        result = averages.copy()
        for begin, end in zip(self.edges[:-1], self.edges[1:], strict=True):
            result[begin:end] = np.sort(averages[begin:end], axis=0)
        returned: Array = result * self.weight[:, None]
        return returned


def find_teeth(force: Array, travel: Array, block: int) -> Teeth | None:
    """The teeth of a log, where ``identify.sawtooth`` finds stick-slip.

    Parameters
    ----------
    force : (m,) float [N]
    travel : (m,) float [m]
    block : int
        Samples in an average.
    """
    try:
        pull = take_apart(travel, force)
    except ValueError:
        return None
    if not pull.stick_slip:
        return None
    count = len(force) // block
    moving = np.flatnonzero(machine_moves(travel))
    first = int(moving[min(pull.teeth[0].sample, pull.slides_from)])
    begin = first // block
    if count - begin < 2 * len(pull.teeth):  # averages that hide the teeth
        return None
    windows = min(max(1, len(pull.teeth) // TEETH), WINDOWS)
    edges = tuple(int(e) for e in np.linspace(begin, count, windows + 1))
    noise = white_std(force) / math.sqrt(block)
    sliding = force[begin * block : count * block].reshape(-1, block).mean(axis=1)
    chance = float(np.std(sliding)) / math.sqrt(len(pull.teeth) / windows)
    weight = np.ones(count)
    weight[begin:] = min(1.0, noise / max(chance, 1e-300))
    low, high = float(force[: 2 * block].mean()), float(force[max(first - block, 0) : first + 1].mean())
    rise = int(np.argmax(force > low + FIRST_RISE * (high - low)))
    return Teeth(max(rise, 2 * block), edges, weight, noise, len(pull.teeth))
