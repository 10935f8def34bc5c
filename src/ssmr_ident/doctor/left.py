"""Whether what a fit leaves follows the motion, as missing physics does and a sensor's own noise does not."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from scipy.signal import lfilter
from scipy.stats import spearmanr

from ssmr_ident.estimate.noise import LARGEST_ORDER
from ssmr_ident.estimate.values import Fit, Problem
from ssmr_ident.signals.noise import fit_noise, median_std

PERIODS = 2.0
"""Of the motion, that a window lasts."""

FEWEST = 10
"""Windows below which ranks say nothing."""


@dataclass(frozen=True)
class Left:
    """What a fit leaves, window by window.

    Parameters
    ----------
    follows : float
        Standard deviations by which its size goes with the size of the motion: Spearman's rank correlation by Fisher's
        transform, the largest of the channels.
    uneven : float
        How far the loudest window stands out, in the robust standard deviation of the logarithm of size.
    loudest : str
        The recording that window is in.
    """

    follows: float = 0.0
    uneven: float = 0.0
    loudest: str = ""


def left(problem: Problem, fit: Fit) -> Left:
    """Residuals of each channel whitened by one filter for all its recordings, in windows of ``PERIODS``."""
    found = [_of_channel(problem, fit, name) for name in problem.pieces[0].channels]
    uneven = max(found, key=lambda own: own.uneven)
    return Left(max(own.follows for own in found), uneven.uneven, uneven.loudest)


def _of_channel(problem: Problem, fit: Fit, name: str) -> Left:
    chosen = [(p, r, p.channels.index(name)) for p, r in zip(problem.pieces, fit.residuals, strict=True)]
    _, longest, at = max(chosen, key=lambda own: len(own[1]))
    whitening = fit_noise(longest[:, at] - longest[:, at].mean(), LARGEST_ORDER).filter
    windows: list[tuple[float, float, str]] = []
    for piece, rest, c in chosen:
        width = max(16, round(PERIODS * piece.rate / problem.frequency))
        white = lfilter(whitening, [1.0], np.where(piece.counts[:, c], rest[:, c] - rest[:, c].mean(), 0.0))
        model = rest[:, c] + piece.y[:, c]
        for first in range(len(whitening) - 1, len(rest) - width + 1, width):
            own = slice(first, first + width)
            windows.append((float(model[own].std()), float(white[own].std()), piece.name))
    if len(windows) < FEWEST:
        return Left()
    motion, sizes = np.array([w[0] for w in windows]), np.array([w[1] for w in windows])
    rank = float(spearmanr(motion, sizes).statistic)
    follows = math.atanh(min(rank, 1.0 - 1e-12)) * math.sqrt((len(windows) - 3) / 1.06)
    logs = np.log(np.maximum(sizes, 1e-300))
    logs -= np.median(logs)
    uneven = logs.max() / max(float(median_std(logs)), 1e-12)
    return Left(follows, float(uneven), windows[int(np.argmax(sizes))][2])
