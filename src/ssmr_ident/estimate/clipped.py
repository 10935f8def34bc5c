"""Samples at which a sensor stood at the end of its range, and which tell nothing of the motion but that."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from ssmr_ident.estimate.pieces import Piece
from ssmr_ident.estimate.values import Problem
from ssmr_ident.experiments.campaign import Measurement
from ssmr_ident.readers.health import cut_off

Array = np.ndarray


def within_range(problem: Problem, measurements: Sequence[Measurement]) -> tuple[Problem, tuple[str, ...]]:
    """The problem with clipped samples uncounted, channel by channel, and what was left out in words.

    Parameters
    ----------
    problem : Problem
    measurements : sequence of Measurement
        That it was made of, in its order.
    """
    cut = [{name: cut_off(m.recording[name]) for name in m.recording.names} for m in measurements]
    pieces = tuple(_counted(p, measurements[p.recording].recording.time, cut[p.recording]) for p in problem.pieces)
    said = []
    for number, measurement in enumerate(measurements):
        compared = dict.fromkeys(name for p in pieces if p.recording == number for name in p.channels)
        for name in compared:
            if count := int(cut[number][name].sum()):
                said.append(f"{measurement.name}: {count} clipped samples of {name} are not compared")
    return replace(problem, pieces=pieces), tuple(said)


def _counted(piece: Piece, time: Array, cut: dict[str, Array]) -> Piece:
    """A sample, or a mean of several, counts where none of what it was made of was clipped."""
    if not any(cut[name].any() for name in piece.channels):
        return piece
    half = 0.5 / piece.rate
    low, high = np.searchsorted(time, piece.time - half - 1e-12), np.searchsorted(time, piece.time + half + 1e-12)
    counts = piece.counts.copy()
    for c, name in enumerate(piece.channels):
        sums = np.concatenate([[0], np.cumsum(cut[name])])
        counts[:, c] &= sums[high] == sums[low]
    return replace(piece, counts=counts)
