"""What is kept back, and how a fit is held against it."""

from __future__ import annotations

import itertools
import math
from dataclasses import replace

import numpy as np

from ssmr_ident.estimate.exact import polish
from ssmr_ident.estimate.generic import BY_RECORDING
from ssmr_ident.estimate.pieces import Piece, cut
from ssmr_ident.estimate.regression import starts_of
from ssmr_ident.estimate.smoother import smoothed
from ssmr_ident.estimate.values import Fit, Problem, Start

STRETCHES, EVERY_THIRD = 6, 3
"""A lone recording is cut into as many; every third is kept back."""

PERIODS = 2.0
"""That a stretch holds at least."""

ABOVE_NOISE = 3.0
"""Size over white noise that a stretch has to have to be kept back."""


def interleaved(problem: Problem) -> tuple[Problem, Problem | None]:
    """Stretches of a lone recording where it moves: some to fit, some kept back; None where there is too little."""
    fitted: list[Piece] = []
    kept: list[Piece] = []
    for piece in problem.pieces:
        moving = _moving(piece)
        shortest = int(PERIODS * piece.rate / problem.frequency)
        count = min(STRETCHES, moving // max(shortest, 8))
        if count < EVERY_THIRD:
            fitted.append(piece)
            continue
        edges = np.linspace(0, moving, count + 1).astype(int)
        parts = [cut(piece, a, b) for a, b in itertools.pairwise(edges)]
        if moving < len(piece.y) - shortest:
            parts.append(cut(piece, moving, len(piece.y)))
        for k, part in enumerate(parts):
            held = k % EVERY_THIRD == EVERY_THIRD - 1 and k < count
            (kept if held else fitted).append(part)
    if not kept:
        return problem, None
    return _of(problem, fitted), _of(problem, kept)


def _moving(piece: Piece) -> int:
    """Samples up to which the recording is well above its noise."""
    width = max(8, len(piece.y) // 40)
    level = np.array([piece.y[k : k + width].std(axis=0) for k in range(0, len(piece.y) - width + 1, width)])
    loud = np.flatnonzero((level > ABOVE_NOISE * piece.white).any(axis=1))
    return int((loud[-1] + 1) * width) if len(loud) else 0


def _of(problem: Problem, pieces: list[Piece]) -> Problem:
    noise = dict(zip((id(p.white) for p in problem.pieces), problem.noises, strict=True))
    return replace(problem, pieces=tuple(pieces), noises=tuple(noise[id(p.white)] for p in pieces))


def held_fit(kept: Problem, fit: Fit) -> Fit | None:
    """A fit's model on other recordings, their starts and zeros alone refitted.

    None for a law by recording, and for one that leaves the finite numbers.
    """
    if any(BY_RECORDING in m.form for m in fit.node.members):
        return None
    paths = tuple(smoothed(p, kept.frequency, kept.size) for p in kept.pieces)
    start = Start(fit.point, tuple(starts_of(kept, fit.node, Start(fit.point, paths=paths))))
    found = polish(kept, fit.node, start, 12, freeze=range(len(fit.point)))
    return found if math.isfinite(found.cost) else None
