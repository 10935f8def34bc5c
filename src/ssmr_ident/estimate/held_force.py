"""A force that is held from one value of the log to the next, as a controller's command is."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
from scipy.interpolate import CubicSpline

from ssmr_ident.estimate.pieces import Piece
from ssmr_ident.estimate.values import Fit, Problem

DELAY = "delay_s"
WITHIN = 0.5
"""Of the half sample by which a held force is later, how far a delay may be off and be that: as near as to none."""

SURE = 3.0
"""Standard deviations from which there is a delay."""


def held(problem: Problem) -> Problem:
    """The same recordings, their force held: straight lines half a sample of the log later."""
    return replace(problem, held=True, pieces=tuple(_later(piece) for piece in problem.pieces))


def is_held(problem: Problem, fit: Fit) -> bool:
    """Whether a fit has the delay of a held force, and not none."""
    half = max(p.late for p in problem.pieces)
    at = next((k for k, c in enumerate(fit.node.coordinates) if c.name == DELAY), None)
    if at is None or not half:
        return False
    delay = float(fit.node.values(fit.point)[at])
    std = abs(float(fit.node.slopes(fit.point)[at])) * math.sqrt(max(float(fit.covariance[at, at]), 0.0))
    return abs(delay - half) < WITHIN * half and delay > SURE * std


def _later(piece: Piece) -> Piece:
    if not piece.late:
        return piece
    grid = np.arange(len(piece.drive)) * piece.step
    return replace(piece, drive=CubicSpline(grid, piece.drive)(np.maximum(grid - piece.late, 0.0)))
