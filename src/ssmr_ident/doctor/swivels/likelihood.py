"""How well an explanation accounts for spectra: densities with known scatter, and a model that errs.

The logarithm of a Welch density with nu degrees of freedom scatters about that of the truth with the variance
trigamma(nu/2). A model whose spectra are off by more than that is not thereby wrong altogether: its own error, the
same for all frequencies, is a standard deviation tau that each explanation is given at its most favourable value
(0 where it needs none). An explanation that leaves structure behind pays for it by a large tau.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.special import logsumexp, polygamma

NEPER_DB = 10.0 / np.log(10.0)
TAU_SQUARED = np.concatenate([[0.0], (np.geomspace(0.1, 12.0, 25) / NEPER_DB) ** 2])
"""Variances of a model's own error tried: 0, and 0.1 … 12 dB."""
INDEPENDENT = 1.0 / 6.0
"""Independent values among the densities of three channels and their six sums: 3 of 9, and every second of the
half-overlapping 1 Hz bins."""


def log_variance(dof: float) -> float:
    """Variance of the natural logarithm of a density."""
    return float(polygamma(1, 0.5 * dof))


def weight_of(tau_db: float) -> float:
    """Of a squared residual in a least-squares step, where the model's own error is ``tau_db``."""
    return INDEPENDENT / (0.05 + (tau_db / NEPER_DB) ** 2)


@dataclass(frozen=True, eq=False)
class Block:
    """What one condition asks of an explanation.

    Parameters
    ----------
    residual : (n,) float
        Logarithms of densities, measured less predicted.
    variance : float
        Of each by chance alone.
    level : (s,) float
        Means, extremes and yaw rate, measured less predicted.
    level_variance : (s,) float
    """

    residual: np.ndarray
    variance: float
    level: np.ndarray
    level_variance: np.ndarray


@dataclass(frozen=True)
class Score:
    """Log likelihood, the model's own error tau [dB], the rms residual and what of it is chance [dB].

    ``left`` is by how much tau raises the log likelihood: what chance alone cannot account for.
    """

    log_likelihood: float
    tau_db: float
    rms_db: float
    chance_db: float = 0.0
    left: float = 0.0


def score(conditions: list[list[Block]]) -> Score:
    """Log likelihood of all conditions, tau at its best.

    Parameters
    ----------
    conditions : list of lists of Block
        Of each condition, equally likely alternatives: over one floor a robot may shake in another way than over the
        next, and which of them was recorded is not known beforehand.
    """
    values = np.zeros(len(TAU_SQUARED))
    likely = []
    for alternatives in conditions:
        each = np.array([_log_likelihoods(block) for block in alternatives])  # (alternatives, tau)
        values += logsumexp(each, axis=0) - np.log(len(alternatives))
        likely.append(each)
    best = int(np.argmax(values))
    told = [part[int(np.argmax(each[:, best]))] for part, each in zip(conditions, likely, strict=True)]
    square = np.concatenate([block.residual**2 for block in told])
    variance = np.concatenate([np.full(len(block.residual), block.variance) for block in told])
    return Score(
        float(values[best]),
        float(np.sqrt(TAU_SQUARED[best])) * NEPER_DB,
        float(np.sqrt(square.mean())) * NEPER_DB,
        float(np.sqrt(variance.mean())) * NEPER_DB,
        float(values[best] - values[0]),
    )


def _log_likelihoods(block: Block) -> np.ndarray:
    """Of one condition over all values of tau, (t,) float."""
    total = block.variance + TAU_SQUARED
    size, squares = len(block.residual), float(np.sum(block.residual**2))
    return INDEPENDENT * (-0.5 * size * np.log(total) - 0.5 * squares / total) + _levels(block)


def _levels(block: Block) -> float:
    """Student's t with four degrees of freedom: a level that a model misses by far must not decide alone."""
    square = block.level**2 / block.level_variance
    return float(np.sum(-2.5 * np.log1p(square / 4.0)))
