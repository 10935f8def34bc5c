"""How many samples two explanations are told apart by, where noise is louder at some frequencies than at others.

What one explanation takes from another sits at some frequencies: about a robot's own, for most. Where noise is loud
there, as a zero that wanders is and amplifiers are, it makes as much of what is taken by chance. By the noise's power
spectrum S, mean 1, and that of the difference, D, the variance of their product is that in white noise times
Σ D S / Σ D (Kay, Fundamentals of Statistical Signal Processing: Detection Theory, 1998, section 4.4).
"""

from __future__ import annotations

import numpy as np

from ssmr_ident.identify.fitting.joint import JointFit

Array = np.ndarray

SMOOTHED = 15
"""Bins of a periodogram over which its mean is taken: S is known to a quarter then. A decay is three to five wide."""


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
        power = [_smoothed(_power(column)) for column in trial.by_channel(left).T]
        taken = [_power(column) for column in trial.by_channel(other - left).T]
        total, mean = float(np.sum(taken)), float(np.mean(power))
        louder = float(np.sum(np.multiply(taken, power))) / (total * mean) if total * mean > 0.0 else 1.0
        found.append(min(float(counted), trial.size / max(louder, 1.0)))
    return np.array(found)


def _power(column: Array) -> Array:
    return np.abs(np.fft.rfft(column)) ** 2


def _smoothed(power: Array) -> Array:
    width = min(SMOOTHED, len(power))
    kernel = np.ones(width)
    return np.convolve(power, kernel, "same") / np.convolve(np.ones(len(power)), kernel, "same")
