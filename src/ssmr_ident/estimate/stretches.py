"""Recordings in stretches with starts of their own: a search looks at some, and chaos is followed only so far."""

from __future__ import annotations

import itertools
import math
from dataclasses import replace

import numpy as np

from ssmr_ident.estimate.pieces import Piece, cut
from ssmr_ident.estimate.scales import state_sizes
from ssmr_ident.estimate.simulated import Compiled, batches, simulate_whole
from ssmr_ident.estimate.values import Fit, Problem

SEARCHED = 60.0
"""Periods of motion, of all recordings together, that a search looks at."""

STRETCH = 10.0
"""Periods of one of its stretches."""

ABOVE_NOISE = 3.0
"""Size over white noise from which a recording counts as moving."""

GROWN = 30.0
"""How many times larger a difference at the begin of a stretch may be at its end: a start that is known to a hundredth
of the motion is then still followed."""


SHORTEST = 3.0
"""Periods of the shortest of such stretches: what grows faster is a model that is none."""


def moving(piece: Piece) -> int:
    """Samples up to which a recording is well above its noise."""
    width = max(8, len(piece.y) // 40)
    level = np.array([piece.y[k : k + width].std(axis=0) for k in range(0, len(piece.y) - width + 1, width)])
    loud = np.flatnonzero((level > ABOVE_NOISE * piece.white).any(axis=1))
    return int((loud[-1] + 1) * width) if len(loud) else 0


def sampled(problem: Problem) -> tuple[Problem, tuple[int, ...], float]:
    """Stretches spread evenly over where the recordings move, the number of each recording's first one, and what share
    of the motion they are.

    The problem itself where its motion is short enough.
    """
    fastest = max(problem.frequency, problem.fastest)
    spans = [moving(p) if not p.driven else len(p.y) for p in problem.pieces]
    periods = [span * fastest / p.rate for span, p in zip(spans, problem.pieces, strict=True)]
    share = SEARCHED / max(sum(periods), 1.0)
    if share >= 1.0:
        return problem, tuple(range(len(problem.pieces))), 1.0
    pieces: list[Piece] = []
    noises, first = [], []
    for piece, noise, span, own in zip(problem.pieces, problem.noises, spans, periods, strict=True):
        count = max(1, round(share * own / STRETCH))
        length = max(16, min(round(share * span / count), span))
        first.append(len(pieces))
        for begin in np.linspace(0, max(span - length, 0), count).astype(int):
            pieces.append(cut(piece, begin, min(begin + length, len(piece.y))))
            noises.append(noise)
    return replace(problem, pieces=tuple(pieces), noises=tuple(noises)), tuple(first), share


def in_stretches(problem: Problem, horizon: float) -> Problem:
    """Every recording in equal stretches of so many periods at the most; the problem itself where none is longer."""
    counts = [math.ceil(len(p.y) * problem.frequency / p.rate / horizon) for p in problem.pieces]
    if max(counts) <= 1:
        return problem
    pieces: list[Piece] = []
    noises = []
    for piece, noise, count in zip(problem.pieces, problem.noises, counts, strict=True):
        for begin, end in itertools.pairwise(np.linspace(0, len(piece.y), count + 1).astype(int)):
            pieces.append(cut(piece, begin, end))
            noises.append(noise)
    return replace(problem, pieces=tuple(pieces), noises=tuple(noises), horizon=horizon)


def predictable(problem: Problem, fit: Fit) -> float:
    """Periods over which a difference at the begin grows to ``GROWN`` times itself; ``inf`` where it dies out.

    By the mean growth rate over the problem's stretches: the largest Lyapunov exponent, from the slopes that the
    simulation has of its end over its begin.
    """
    model = Compiled.of(problem, fit.node, fit.point, problem.pieces)
    sizes, k = state_sizes(problem, fit.node), fit.node.motion_states
    grown, periods = 0.0, 0.0
    ends = np.concatenate([simulate_whole(model, batch, fit.nuisances).dends for batch in batches(model.pieces)])
    for piece, own in zip(problem.pieces, ends, strict=True):
        slopes = own[:k, :k] * sizes[None, :k] / sizes[:k, None]
        if not np.isfinite(slopes).all():
            return math.inf
        grown += math.log(max(float(np.linalg.norm(slopes, 2)), 1e-300))
        periods += len(piece.y) * problem.frequency / piece.rate
    rate = grown / max(periods, 1e-300)
    return max(math.log(GROWN) / rate, SHORTEST) if rate > 0.0 else math.inf
