"""How large states, nuisances and coordinates are: their priors."""

from __future__ import annotations

import math

import numpy as np

from ssmr_ident.estimate.node import BRANCH, LAG, LAG_1, RIDER, Node
from ssmr_ident.estimate.pieces import Piece
from ssmr_ident.estimate.values import Problem

Array = np.ndarray

GAIN = 0.02
"""Standard deviation of what a force cell's or a sensor's gain changes by from one recording to the next."""

DRIFT = 1.0
"""Standard deviation of what a channel's zero drifts by to either side of a recording, in that of its white noise: what
stays within a single sample's noise is nothing that a sheet would promise."""

ZERO_SHARE = 0.3
"""Standard deviation of a drive's zero, in the drive's own."""

SIGNAL_SHARE = 0.03
"""The same of what a motor is given, which is a number before it is a voltage or a goal: what an encoder's zero is off
by."""

NONE = 1e-12
"""Of what cannot be: an encoder counts, so that its gain and zero stay."""


def nuisance_scales(problem: Problem, node: Node, piece: Piece) -> Array:
    """Prior standard deviations of a piece's nuisances."""
    sizes = 10.0 * state_sizes(problem, node)
    # what holds a mass aside has loaded its friction, and so has what went before; a driven log begins at rest
    sizes[node.linear_states :] *= 1e-6 if piece.driven and piece.time[0] <= piece.begin else 0.1
    zero, offsets = zero_scales(piece)
    gain = np.full(len(zero), GAIN if piece.motor is None else NONE)
    usual = node.values(np.array([c.mean for c in node.coordinates]))[: len(node.layout.keys)]
    held = bool(np.any(usual[len(node.layout.bodies) + 1 :: 2] > 0.0))
    # the path of a mass that nothing holds may itself go on and on
    drifts = DRIFT * piece.white if held and piece.motor is None else np.full(len(offsets), NONE)
    return np.concatenate([sizes, zero, gain, offsets, drifts])


def nuisance_count(node: Node, piece: Piece) -> int:
    """How many a piece has: states, zero and gain of its drive, zeros and drifts of its channels."""
    return node.states + 2 * int(piece.driven) + 2 * piece.y.shape[1]


def zero_scales(piece: Piece) -> list[Array]:
    spread = ZERO_SHARE * piece.sizes[0] if piece.motor is None else SIGNAL_SHARE * piece.motor.spread
    return [np.full(int(piece.driven), max(spread, 1e-12)), piece.sizes[1:]]


def state_sizes(problem: Problem, node: Node) -> Array:
    """Sizes of linear and hidden states in SI."""
    x, turning = problem.size, 2.0 * math.pi * problem.frequency
    bodies = len(node.layout.bodies)
    sizes = [x] * bodies + [x * turning] * bodies
    for member in (m for m in node.members if m.linear):
        sizes += {
            LAG: [x * turning**2] * 2, LAG_1: [x * turning**2], BRANCH: [x], RIDER: [x, x * turning]
        }[member.linear]  # fmt: skip
    return np.array(sizes + [x] * node.hidden_states)


def priors(node: Node) -> tuple[Array, Array]:
    """Means and precisions of the coordinates."""
    coordinates = node.coordinates
    mean = np.array([c.mean for c in coordinates])
    return mean, np.array([1.0 / c.std**2 if math.isfinite(c.std) else 0.0 for c in coordinates])


def bounded(node: Node, point: Array) -> Array:
    return np.array([c.at(c.value(float(p))) for c, p in zip(node.coordinates, point, strict=True)])
