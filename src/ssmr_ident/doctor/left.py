"""Whether what a fit leaves follows the motion, as missing physics does and a sensor's own noise does not."""

from __future__ import annotations

import math

import numpy as np
from scipy.signal import lfilter
from scipy.stats import spearmanr

from ssmr_ident.estimate.noise import LARGEST_ORDER
from ssmr_ident.estimate.values import Fit, Problem
from ssmr_ident.signals.noise import fit_noise

PERIODS = 2.0
"""Of the motion, that a window lasts."""

FEWEST = 10
"""Windows below which ranks say nothing."""


def follows_motion(problem: Problem, fit: Fit) -> float:
    """Standard deviations by which the size of what is left goes with the size of the motion, window by window.

    Spearman's rank correlation by Fisher's transform, for each channel over the windows of all recordings, of residuals
    whitened by one filter a channel; the largest of the channels.
    """
    largest = 0.0
    for name in problem.pieces[0].channels:
        sizes: list[tuple[float, float]] = []
        chosen = [(p, r, p.channels.index(name)) for p, r in zip(problem.pieces, fit.residuals, strict=True)]
        longest = max(chosen, key=lambda own: len(own[1]))
        whitening = fit_noise(longest[1][:, longest[2]] - longest[1][:, longest[2]].mean(), LARGEST_ORDER).filter
        for piece, rest, c in chosen:
            width = max(16, round(PERIODS * piece.rate / problem.frequency))
            white = lfilter(whitening, [1.0], np.where(piece.counts[:, c], rest[:, c] - rest[:, c].mean(), 0.0))
            model = rest[:, c] + piece.y[:, c]
            for first in range(len(whitening) - 1, len(rest) - width + 1, width):
                own = slice(first, first + width)
                sizes.append((float(model[own].std()), float(white[own].std())))
        if len(sizes) >= FEWEST:
            rank = float(spearmanr(*zip(*sizes, strict=True)).statistic)
            largest = max(largest, math.atanh(min(rank, 1.0 - 1e-12)) * math.sqrt((len(sizes) - 3) / 1.06))
    return largest
