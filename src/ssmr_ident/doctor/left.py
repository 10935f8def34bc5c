"""Whether what a fit leaves follows the motion, as missing physics does and a sensor's own noise does not."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from scipy.signal import lfilter
from scipy.stats import spearmanr

from ssmr_ident.estimate.noise import LARGEST_ORDER
from ssmr_ident.estimate.values import Fit, Problem
from ssmr_ident.signals.noise import fit_noise

PERIODS = 2.0
"""Of the motion, that a window lasts."""

FEWEST = 10
"""Windows below which ranks say nothing, and what is left is taken to follow the motion."""


@dataclass(frozen=True)
class Left:
    """What a fit leaves, window by window.

    Parameters
    ----------
    follows : float
        Standard deviations by which its size goes with the size of the motion: Spearman's rank correlation by Fisher's
        transform, the largest of the channels.
    uneven : float
        How far the loudest window stands out of the mean one, in the standard deviation that the logarithm of its size
        has in Gaussian noise.
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
    overall = float(np.sqrt(np.mean([np.mean(r[:, c] ** 2) for _, r, c in chosen])))
    windows: list[tuple[float, float, str]] = []
    width = 16
    for piece, rest, c in chosen:
        width = max(16, round(PERIODS * piece.rate / problem.frequency))
        white = lfilter(whitening, [1.0], np.where(piece.counts[:, c], rest[:, c] - rest[:, c].mean(), 0.0))
        model = rest[:, c] + piece.y[:, c]
        for first in range(len(whitening) - 1, len(rest) - width + 1, width):
            own = slice(first, first + width)
            windows.append((float(model[own].std()), float(np.sqrt(np.mean(white[own] ** 2))), piece.name))
    # where nothing moves, a converter's steps show no noise either
    moving = np.array([w[:2] for w in windows if w[0] > overall])
    if len(moving) < FEWEST:
        return Left(math.inf)
    rank = float(spearmanr(moving[:, 0], moving[:, 1]).statistic)
    follows = math.atanh(min(rank, 1.0 - 1e-12)) * math.sqrt((len(moving) - 3) / 1.06)
    sizes = np.array([w[1] for w in windows])
    over = float(sizes.max()) / max(float(np.sqrt(np.mean(sizes**2))), 1e-300)
    return Left(follows, math.log(over) * math.sqrt(2.0 * width), windows[int(np.argmax(sizes))][2])


MOST, LEAST = 0.9, 0.01
"""Of what is left the part that lies below a frequency, and the part of the motion below it at the most, where what is
left is slower than whatever moves."""


def wandering(problem: Problem, fit: Fit) -> list[tuple[str, float]]:
    """Channels of which most of what is left is slower than what moves, and the frequency [Hz] that it lies below: a
    zero that wanders, for no force makes a rig follow it so slowly and nothing else."""
    found = []
    for name in problem.pieces[0].channels:
        spectra = []
        for piece, rest in zip(problem.pieces, fit.residuals, strict=True):
            own = rest[:, piece.channels.index(name)]
            model = own + piece.y[:, piece.channels.index(name)]
            power = [np.abs(np.fft.rfft(x - x.mean())) ** 2 for x in (own, model)]
            spectra.append(np.column_stack([np.fft.rfftfreq(len(own), 1.0 / piece.rate), *power]))
        hz, left_over, moves = np.vstack(spectra)[np.argsort(np.concatenate([s[:, 0] for s in spectra]))].T
        at = int(np.searchsorted(np.cumsum(left_over), MOST * left_over.sum()))
        if np.sum(moves[: at + 1]) < LEAST * moves.sum():
            found.append((name, float(hz[at])))
    return found
