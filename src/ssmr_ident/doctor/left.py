"""Whether what a fit leaves follows the motion, as missing physics does and a sensor's own noise does not."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from scipy.stats import spearmanr

from ssmr_ident.core.shown import Shown
from ssmr_ident.estimate.node import matrices
from ssmr_ident.estimate.pieces import Piece
from ssmr_ident.estimate.values import Fit, Problem
from ssmr_ident.signals.band import Band

Array = np.ndarray

PERIODS = 2.0
"""Of the motion, that a window lasts; a mass that no spring holds has none: there, a share of all."""

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
    """Residuals of each channel, whitened as its noise is, in windows of ``PERIODS``."""
    found = [_of_channel(problem, fit, name) for name in problem.pieces[0].channels]
    uneven = max(found, key=lambda own: own.uneven)
    return Left(max(own.follows for own in found), uneven.uneven, uneven.loudest)


def _of_channel(problem: Problem, fit: Fit, name: str) -> Left:
    chosen = [(p, *_counted(p, r, name)) for p, r in zip(problem.pieces, fit.residuals, strict=True)]
    noises = [own[p.channels.index(name)] for p, own in zip(problem.pieces, problem.noises, strict=True)]
    windows: list[tuple[float, float, str]] = []
    width, total = 16, sum(len(rest) for _, rest, _ in chosen)
    for (piece, rest, model), noise in zip(chosen, noises, strict=True):
        period = round(PERIODS * piece.counted_rate / problem.frequency)
        width = max(16, total // (2 * FEWEST) if problem.drifts else period)
        white = noise.filtered(rest)
        for first in range(problem.passed_over(piece) + noise.order, len(rest) - width + 1, width):
            own = slice(first, first + width)
            over = float(model[own].std() / piece.white[piece.channels.index(name)])
            windows.append((over, float(np.sqrt(np.mean(white[own] ** 2))), piece.name))
    # where nothing moves, a converter's steps show no noise either
    moving = np.array([w[:2] for w in windows if w[0] > 1.0])
    if len(moving) < FEWEST:
        return Left(math.inf)
    rank = float(spearmanr(moving[:, 0], moving[:, 1]).statistic)
    follows = math.atanh(min(rank, 1.0 - 1e-12)) * math.sqrt((len(moving) - 3) / 1.06)
    sizes = np.array([w[1] for w in windows])
    out = float(sizes.max()) / max(float(np.sqrt(np.mean(sizes**2))), 1e-300)
    return Left(follows, math.log(out) * math.sqrt(2.0 * width), windows[int(np.argmax(sizes))][2])


def _counted(piece: Piece, rest: Array, name: str) -> tuple[Array, Array]:
    """What counts of what is left in a channel, and of what the model says there."""
    at = piece.channels.index(name)
    both = piece.counted(np.stack([rest, rest + piece.y], axis=2))
    return both[:, at, 0], both[:, at, 1]


BEYOND = 2.0
"""Factor over a model's highest natural frequency from which a mode is none of its own."""

NARROW = 0.1
"""Share of the frequencies beyond in which half of what is left there lies, where modes leave it."""


@dataclass(frozen=True)
class Beyond(Shown):
    """Modes beyond a model's own that rule what it leaves: about where they lie, its highest one, and a band without
    them [Hz]."""

    found: float
    highest: float
    band_hz: Band

    def __str__(self) -> str:
        low, high = self.band_hz
        return (
            f"most of what is left lies near {self.found:.3g} Hz, beyond the highest mode of the model at "
            f"{self.highest:.3g} Hz: with band_hz: [{low:g}, {high:g}] in session.yaml it is fitted and judged where "
            "it has modes"
        )


def beyond(problem: Problem, fit: Fit) -> Beyond | None:
    """Whether half of what a fit leaves over white noise lies in few lines beyond ``BEYOND`` its highest mode."""
    node = fit.node
    a = matrices(node, node.values(fit.point)[: node.linear_count], problem.pieces[0].seen)[0]
    highest = float(np.abs(np.linalg.eigvals(a).imag).max()) / (2.0 * math.pi)
    grids, powers = [], []
    for piece, rest in zip(problem.pieces, fit.residuals, strict=True):
        own = piece.counted(rest - rest.mean(axis=0)) / piece.white
        powers.append((np.abs(np.fft.rfft(own, axis=0)) ** 2 / len(own) - 1.0).sum(axis=1))
        grids.append(piece.counted_from + np.fft.rfftfreq(len(own), 1.0 / piece.counted_rate))
    hz, power = np.concatenate(grids), np.concatenate(powers)
    order = np.argsort(hz)
    hz, power = hz[order], power[order]
    far = hz > BEYOND * highest
    if highest <= 0.0 or power.sum() <= 0.0 or power[far].sum() < 0.5 * power.sum():
        return None
    hz, power = hz[far], np.maximum(power[far], 0.0)
    loudest = np.cumsum(np.sort(power)[::-1])
    if np.searchsorted(loudest, 0.5 * loudest[-1]) > NARROW * len(power):
        return None
    first, middle = np.interp([0.1, 0.5], np.cumsum(power) / power.sum(), hz)
    return Beyond(float(middle), highest, (0.0, float(f"{math.sqrt(highest * first):.2g}")))


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
            parts = _counted(piece, rest, name)
            power = [np.abs(np.fft.rfft(x - x.mean())) ** 2 for x in parts]
            grid = piece.counted_from + np.fft.rfftfreq(len(parts[0]), 1.0 / piece.counted_rate)
            spectra.append(np.column_stack([grid, *power]))
        hz, left_over, moves = np.vstack(spectra)[np.argsort(np.concatenate([s[:, 0] for s in spectra]))].T
        at = int(np.searchsorted(np.cumsum(left_over), MOST * left_over.sum()))
        if np.sum(moves[: at + 1]) < LEAST * moves.sum():
            found.append((name, float(hz[at])))
    return found
