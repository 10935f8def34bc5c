"""Where a mass that rides on another begins: the two modes of the best linear model of a recording."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from ssmr_ident.estimate.generic import rider
from ssmr_ident.estimate.node import Member, Node
from ssmr_ident.estimate.pieces import Piece
from ssmr_ident.estimate.values import Fit, Problem, Start
from ssmr_ident.signals.common_response import TWO_MODES, fitted_response
from ssmr_ident.signals.noise.mains import MAINS_HZ

Array = np.ndarray

HIGHEST = 0.9
"""Of the half of a rate, up to which bins are used."""

APART = 4.0
"""Bins about a line of the mains that are passed over: it rings on undriven, and would be taken for a mode."""


@dataclass(frozen=True, eq=False)
class Riding:
    """A part of the mass on a spring of its own, as two modes have it.

    Parameters
    ----------
    member : Member
    share : float
        Of the mass.
    ratio : float
        Of damping, of both.
    held : float [rad^2/s^2]
        Stiffness over the mass that does not ride.
    """

    member: Member
    share: float
    ratio: float
    held: float

    def start(self, base: Fit, paths: Sequence[Array]) -> tuple[Node, Start]:
        """Beside the baseline, with its mass, along recorded paths."""
        mass, _, _, *further = base.node.values(base.point).tolist()
        node, body = base.node.with_member(self.member), (1.0 - self.share) * mass
        values = [mass, 2.0 * self.ratio * body * math.sqrt(self.held), self.held * body, *further]
        values += [self.share, self.member.coordinates[1].scale, self.ratio]
        point = [c.at(value) for c, value in zip(node.coordinates, values, strict=True)]
        return node, Start(np.array(point), paths=tuple(paths))


def riding(problem: Problem) -> list[Riding]:
    """What rides in the two modes that the recordings show: half of the most that could, with its own frequency above
    that of the rest and below; none where they show no two.

    Two masses with the modes w1 and w2 [rad/s] have a share of 1 - 4 (w1 w2)^2 / (w1^2 + w2^2)^2 in the one that rides
    at the most: where that is tuned to the other (sum and product of the roots of its characteristic equation).
    """
    modes = two_modes(problem)
    if modes is None:
        return []
    first, second, ratio = modes
    both, product = first**2 + second**2, (first * second) ** 2
    share = 0.5 * (1.0 - 4.0 * product / both**2)
    apart = math.sqrt(max(both**2 - 4.0 * product / (1.0 - share), 0.0))
    found = []
    for held in (0.5 * (both + apart), 0.5 * (both - apart)):
        member = rider(problem, math.sqrt(product / held) / (2.0 * math.pi))
        found.append(Riding(member, share, ratio, held))
    return found


def two_modes(problem: Problem) -> tuple[float, float, float] | None:
    """Two natural frequencies [rad/s], lower first, and the mean damping ratio, of the recording that a response of two
    modes explains best; None where none of them has two."""
    found = [own for piece in problem.pieces if (own := _of_piece(piece, problem.frequency)) is not None]
    return min(found, key=lambda own: own[0])[1:] if found else None


def _of_piece(piece: Piece, hz: float) -> tuple[float, float, float, float] | None:
    """What two modes leave of the first channel, and they.

    Bins count by what they are of the deflection: far above the motion, which goes at ``hz``, an acceleration holds a
    structure's own modes and the mains, whose deflections are next to nothing.
    """
    y = piece.y[:, 0] - piece.y[:, 0].mean()
    u = piece.drive[:: piece.every][: len(y)] if piece.driven else np.zeros(len(y))
    width = piece.rate / len(y)
    last = int(0.5 * HIGHEST * len(y))
    if last < TWO_MODES.size:
        return None
    bins = np.arange(1, last + 1)
    weight = (1.0 + (bins * width / hz) ** 2) ** (-0.5 * piece.orders[0])
    weight[np.abs(bins[:, None] * width - MAINS_HZ).min(axis=1) < APART * width] = 0.0
    output = np.fft.rfft(y)[bins]
    about = ((hz / (last * width)) ** 2 + (bins / last) ** 2) ** 2  # two modes at the motion's frequency
    response = fitted_response(1j * bins / last, np.fft.rfft(u)[bins], output, weight, TWO_MODES, first=about)
    poles = np.roots([1.0, *response.coefficients[TWO_MODES.order - 1 :: -1]])
    pairs = poles[poles.imag > 0.0]
    if len(pairs) < 2 or not np.isfinite(response.residual).all():
        return None
    turning = np.sort(np.abs(pairs)) * 2.0 * math.pi * last * width
    rest, power = (float(np.sum(np.abs(weight * x) ** 2)) for x in (response.residual, output))
    return (
        rest / max(power, 1e-300),
        float(turning[0]),
        float(turning[1]),
        float(np.mean(np.abs(pairs.real) / np.abs(pairs))),
    )
