"""How many samples two explanations are told apart by, where noise is louder at some frequencies than at others.

What one explanation takes from another sits at some frequencies: about a robot's own, for most. Where noise is loud
there, as a zero that wanders is and amplifiers are, it makes as much of what is taken by chance.
"""

from __future__ import annotations

import numpy as np

from ssmr_ident.identify.fitting.joint import JointFit
from ssmr_ident.signals.noise import loudness_where_taken

Array = np.ndarray


def told_by(after: JointFit, before: JointFit) -> Array:
    """Independent samples of each recording for what one fit takes from another, (t,) float.

    Parameters
    ----------
    after, before : JointFit
        Of the same trials; the noise is what ``after`` leaves.

    Returns
    -------
    (t,) float
        No more than ``after.counted``.
    """
    found = []
    for trial, left, other, counted in zip(after.trials, after.residuals, before.residuals, after.counted, strict=True):
        louder = loudness_where_taken(trial.by_channel(left), trial.by_channel(other - left))
        found.append(min(float(counted), trial.size / max(louder, 1.0)))
    return np.array(found)
