"""How well an explanation accounts for spectra: densities with known scatter, and a model that errs.

The logarithm of a Welch density with nu degrees of freedom scatters about that of the truth with the variance
trigamma(nu/2). A model whose spectra are off by more than that is not thereby wrong altogether: its own error, the
same for all frequencies, is a standard deviation tau that each explanation is given at its most favourable value
(0 where it needs none). An explanation that leaves structure behind pays for it by a large tau.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.special import polygamma

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


def score(blocks: list[Block]) -> Score:
    """Log likelihood of all conditions, tau at its best."""
    square = np.concatenate([block.residual**2 for block in blocks])
    variance = np.concatenate([np.full(len(block.residual), block.variance) for block in blocks])
    total = variance[None, :] + TAU_SQUARED[:, None]
    values = INDEPENDENT * np.sum(-0.5 * np.log(total) - 0.5 * square[None, :] / total, axis=1)
    best = int(np.argmax(values))
    levels = sum(float(_levels(block)) for block in blocks)
    return Score(
        float(values[best]) + levels,
        float(np.sqrt(TAU_SQUARED[best])) * NEPER_DB,
        float(np.sqrt(square.mean())) * NEPER_DB,
        float(np.sqrt(variance.mean())) * NEPER_DB,
        float(values[best] - values[0]),
    )


def _levels(block: Block) -> float:
    """Student's t with four degrees of freedom: a level that a model misses by far must not decide alone."""
    square = block.level**2 / block.level_variance
    return float(np.sum(-2.5 * np.log1p(square / 4.0)))
