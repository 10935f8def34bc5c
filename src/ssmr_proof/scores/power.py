"""Power: the chance that hidden physics is named, over how much of it a refit of the baseline leaves to be seen."""

from __future__ import annotations

import itertools
import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from scipy.optimize import minimize

from ssmr_proof.scores.intervals import NAN
from ssmr_proof.scores.score import MISSED, NAMED
from ssmr_proof.scores.table import Row

BINS = (0.0, 0.1, 0.2, 0.4, 0.8, 1.6, 3.2, math.inf)


@dataclass(frozen=True, eq=False)
class Power:
    """Cases with hidden physics, sorted by what the baseline leaves.

    Parameters
    ----------
    excess : (n,) float
        √(before² − floor²)/floor on the held-out recordings.
    named, seen : (n,) bool
        Named right or in a tie; said to be missing at all.
    half : float
        Excess at which half are named, from a logistic curve over its logarithm; NaN where the cases do not say.
    """

    excess: np.ndarray
    named: np.ndarray
    seen: np.ndarray
    half: float

    def rows(self) -> list[tuple[str, int, int, int]]:
        """Range of excess, cases, seen, named."""
        found = []
        for low, high in itertools.pairwise(BINS):
            inside = (self.excess >= low) & (self.excess < high)
            label = f"{low:g} … {high:g}" if high < math.inf else f"above {low:g}"
            found.append((label, int(inside.sum()), int(self.seen[inside].sum()), int(self.named[inside].sum())))
        return found


def power(rows: Sequence[Row]) -> Power:
    """Measure it on the cases with hidden physics."""
    used = sorted((row for row in rows if row.missing and row.heldout.before), key=lambda row: row.heldout.excess)
    excess = np.array([row.heldout.excess for row in used])
    named = np.array([row.mark.outcome in NAMED for row in used], dtype=bool)
    seen = np.array([row.mark.outcome != MISSED for row in used], dtype=bool)
    return Power(excess, named, seen, _half(excess, named))


def _half(excess: np.ndarray, named: np.ndarray) -> float:
    """Where a logistic curve over log excess crosses one half; a weak prior keeps its slope finite."""
    if len(named) < 6 or named.all() or not named.any():
        return NAN
    x = np.log(np.maximum(excess, 1e-2))

    def cost(p: np.ndarray) -> float:
        score = np.exp(p[1]) * (x - p[0])
        return float(np.sum(np.logaddexp(0.0, np.where(named, -score, score))) + 0.5 * (p[1] - 0.7) ** 2)

    found = minimize(cost, [float(np.median(x)), 0.7], method="Nelder-Mead")
    half = float(np.exp(found.x[0]))
    return half if excess.min() < half < excess.max() else NAN
