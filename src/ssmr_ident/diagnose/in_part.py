"""Answers that are only part of one."""

from __future__ import annotations

import numpy as np

from ssmr_ident.diagnose.weigh import Explanation
from ssmr_ident.diagnose.worth import BY_CHANCE, grows_with_motion, predictions
from ssmr_ident.identify.fitting.descent import chatters

FORMULA = 0.1
"""Share of the baseline's error below which what one effect leaves is put down to its own formula: a friction that is
rounded otherwise than the catalogue's leaves a hundredth, which some second effect always mends a little. Of a pair the
first one leaves more."""


def in_part(chosen: Explanation, baseline: Explanation) -> bool:
    """Whether an effect leaves more than its formula may, and more of it where more moves, as no noise is."""
    named = [name for name in chosen.fit.model.ids if name not in baseline.fit.model.ids]
    if len(named) != 1 or "unlisted" in named or chatters(chosen.fit):
        return False
    if left_over(chosen, baseline) < FORMULA:
        return False
    return grows_with_motion(predictions(chosen.fit) + predictions(chosen.kept)) < BY_CHANCE


def left_over(chosen: Explanation, baseline: Explanation) -> float:
    """Size of what an explanation leaves over what the baseline left, mean over all recordings."""
    return float(np.exp(0.5 * _above_noise(chosen, baseline).mean()))


def _above_noise(one: Explanation, other: Explanation) -> np.ndarray:
    """The same of what is more than noise, as that was taken from what the baseline left.

    Where a slow sensor is missing, that is too much: what it leaves is fast. An explanation then leaves a hundredth of
    the noise, and the share that another leaves of that may, or may not, say something.
    """
    changes = []
    for a, b in ((one.fit, other.fit), (one.kept, other.kept)):
        noise = np.array([t.size for t in a.trials])
        changes.append(np.log(np.maximum(a.parts, noise) / np.maximum(b.parts, noise)))
    return np.concatenate(changes)
