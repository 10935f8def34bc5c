"""How likely a further recording decides between explanations that are left.

Two explanations that predict whitened signals a distance d apart, once all that the rival may still move is taken out,
gain a log Bayes factor of mean d²/2 and variance d² from it where one of them is right. Source: Cox and Hinkley,
Theoretical Statistics (1974), section 4.2; as a measure of a design Box and Hill, Technometrics 9 (1967) 57; Chaloner
and Verdinelli, Statistical Science 10 (1995) 273.
"""

from __future__ import annotations

import numpy as np
from scipy.stats import norm

Array = np.ndarray

DECIDED = 5.0
"""Log evidence by which an explanation has to lead to be named alone: odds of 150 to one."""

LIKELY = 0.95
"""Chance of deciding from which a milder experiment is as good."""

UNLIKELY = 0.5
"""Chance of deciding below which it is said that no recording of this rig is likely to."""


NONE_LIKELY = "No recording"
"""With which advice begins where that is so."""


def chance_of_deciding(evidence: Array, apart: Array) -> float:
    """Probability that one of the explanations leads by ``DECIDED`` after the recording, if one of them is right.

    Parameters
    ----------
    evidence : (m,) float
        Log evidence so far.
    apart : (m, m) float
        Of the row's prediction from the nearest that the column's explanation can come to it, in standard deviations of
        noise; the diagonal is not looked at.

    >>> near, far = np.full((2, 2), 0.1), np.full((2, 2), 9.0)
    >>> round(chance_of_deciding(np.zeros(2), near), 3), round(chance_of_deciding(np.zeros(2), far), 3)
    (0.0, 1.0)
    """
    weights = np.exp(evidence - evidence.max())
    total = 0.0
    for i, weight in enumerate(weights / weights.sum()):
        others = [j for j in range(len(evidence)) if j != i]
        size = np.maximum(apart[i, others], 1e-9)
        lead = evidence[i] - evidence[others] + 0.5 * size**2 - DECIDED
        total += float(weight * norm.cdf(lead / size).min())
    return total


def best_of(chances: Array, changes: Array) -> int:
    """Number of the experiment to make: of those that are likely to decide the one that differs least from what was
    recorded, otherwise the likeliest.

    >>> best_of(np.array([0.2, 0.96, 0.99]), np.array([1.0, 2.0, 4.0])), best_of(np.array([0.2, 0.6]), np.ones(2))
    (1, 1)
    """
    good = np.flatnonzero(chances >= LIKELY)
    return int(good[np.argmin(changes[good])]) if len(good) else int(np.argmax(chances))


def advice(words: str, names: tuple[str, ...], chance: float) -> str:
    """What to record next, with the chance that it decides.

    >>> advice("Let it go from 2 mm, as in a.csv", ("dry friction", "hysteresis"), 0.934)
    'Let it go from 2 mm, as in a.csv: decides between dry friction and hysteresis with a probability of 93 %'
    """
    between = f"{', '.join(names[:-1])} and {names[-1]}"
    if chance < UNLIKELY:
        least = "less than 1" if chance < 0.01 else f"{100.0 * chance:.0f}"
        return (
            f"{NONE_LIKELY} within what was shown to be possible is likely to decide between {between}. The best, with "
            f"a probability of {least} %: {words[0].lower()}{words[1:]}"
        )
    most = "more than 99" if chance > 0.99 else f"{100.0 * chance:.0f}"
    return f"{words}: decides between {between} with a probability of {most} %"
