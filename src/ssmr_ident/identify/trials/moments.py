"""Moments of a pull that its log tells whatever the parameters: when its cable tightens, and when all of it slides."""

from __future__ import annotations

import numpy as np

Array = np.ndarray

RISE = (0.06, 0.18)
"""Shares of a pull's largest force between which its beginning counts as a straight line."""

LARGEST, SLIDING = 0.98, 0.97
"""Quantile of a pull's force that counts as its largest, and the share of it at which the robot has let go: the last
wheels take up little of what the first ones gave way with."""


def tightening(force: Array, block: int) -> int:
    """Sample at which the cable tightens: the straight line through the first rise, back to where it began.

    From the log alone: a stiffness that is not yet known would misplace it, and with it what does not count.
    """
    count = len(force) // block
    smooth = force[: count * block].reshape(count, block).mean(axis=1)
    low, high = float(smooth[0]), float(smooth.max())
    if not high > low:
        return 0
    crossings = []
    for share in RISE:
        level = low + share * (high - low)
        after = max(int(np.argmax(smooth > level)), 1)
        below, above = smooth[after - 1], smooth[after]
        crossings.append(after - (above - level) / (above - below))
    onset = crossings[0] - (crossings[1] - crossings[0]) * RISE[0] / (RISE[1] - RISE[0])
    result: int = max(round(block * (onset + 0.5)), 0)
    return result


def lets_go(averages: Array) -> int:
    """The average, of (n, 1), at which a robot begins to slide as a whole."""
    low, high = float(averages[0, 0]), float(np.quantile(averages, LARGEST))
    return int(np.argmax(averages[:, 0] >= low + SLIDING * (high - low)))
