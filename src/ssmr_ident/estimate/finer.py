"""A problem in smaller steps, by which the parameters that are told err less than their deviations."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from scipy.interpolate import CubicSpline

from ssmr_ident.estimate.pieces import Piece
from ssmr_ident.estimate.values import Problem

PARTS = 3
"""Of a step: what corners of a force leave in a run falls with its square."""


def finer(problem: Problem) -> Problem:
    """The same recordings in steps of a third; ``problem`` where a motor is switched from one step to the next."""
    if any(piece.motor is not None for piece in problem.pieces):
        return problem
    return replace(problem, pieces=tuple(_finer(piece) for piece in problem.pieces))


def _finer(piece: Piece) -> Piece:
    drive = piece.drive
    if piece.driven:
        grid = np.arange(len(drive))
        drive = CubicSpline(grid, drive)(np.arange(PARTS * (len(drive) - 1) + 1) / PARTS)
    return replace(piece, drive=drive, step=piece.step / PARTS, every=PARTS * piece.every)
