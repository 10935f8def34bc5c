"""A rig's recordings as an inverse problem, where a fit begins, and what it comes to."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from enum import Enum

import numpy as np

from ssmr_ident.estimate.coordinate import Coordinate
from ssmr_ident.estimate.node import Node
from ssmr_ident.estimate.pieces import Piece
from ssmr_ident.physics.network import ONE, Layout
from ssmr_ident.signals.noise import AutoregressiveNoise

Array = np.ndarray


class Stop(Enum):
    CONVERGED = "no step lowers the cost by as much as a decision looks at"
    STEPS = "more steps would lower the cost further: begin nearer, or allow more"
    LOST = "the simulation left the finite numbers"


@dataclass(frozen=True, eq=False)
class Problem:
    """Recordings as one inverse problem.

    Parameters
    ----------
    pieces : tuple of Piece
    baseline : tuple of Coordinate
        Mass, damping, stiffness; of a network in the order of its layout's keys.
    noises : tuple of tuple of AutoregressiveNoise
        Per piece and channel.
    frequency : float [Hz]
        Of the motion.
    size : float [m]
        RMS deflection.
    bandwidth_hz : float
        Of the accelerometer, as known; its low-pass is undone in the pieces.
    fastest : float [Hz]
        Highest frequency at which the rig is expected to move; ``frequency`` where it is less.
    horizon : float
        Periods after which a start no longer tells where the motion is; ``inf`` unless it is chaotic.
    layout : Layout
        Bodies and springs.
    held : bool
        Whether the force is taken to be held from one value of the log to the next; else it goes in straight lines.
    """

    pieces: tuple[Piece, ...]
    baseline: tuple[Coordinate, ...]
    noises: tuple[tuple[AutoregressiveNoise, ...], ...]
    frequency: float
    size: float
    bandwidth_hz: float = math.inf
    fastest: float = 0.0
    horizon: float = math.inf
    layout: Layout = ONE
    held: bool = False

    @property
    def speed(self) -> float:
        return 2.0 * math.pi * self.frequency * self.size

    @property
    def drifts(self) -> bool:
        """Whether no spring holds the mass: what its force was not measured with then adds up, and no model comes near
        the recordings under the noise of the sensor alone."""
        if self.layout != ONE or not any(p.driven and not p.based for p in self.pieces):
            return False
        stiffness = self.baseline[2]
        return stiffness.value(stiffness.mean) == 0.0

    @property
    def begin(self) -> float:
        """Time at the begin of driven stretches that is compared with nothing [s]: half a period, for a sensor that is
        late shows there what drove the rig before."""
        return 0.5 / max(self.frequency, self.fastest)

    def passed_over(self, piece: Piece) -> int:
        """Samples of that time."""
        return min(math.ceil(self.begin * piece.rate), len(piece.y) // 4) if piece.driven else 0

    @property
    def samples(self) -> int:
        return sum(p.samples(self.passed_over(p)) for p in self.pieces)


@dataclass(frozen=True, eq=False)
class Fit:
    """A node at its best.

    Parameters
    ----------
    node : Node
    point : (p,) float
        Coordinates.
    nuisances : tuple of (k,) float
        Per piece: states at its begin (linear, hidden), where it is driven the drive's
        zero and what the gain is off by, zeros of the channels, and what these drift by to either side.
    covariance : (p, p) float
        Of the coordinates.
    residuals : tuple of (n, c) float
        Model less measured, SI; of a sample within a force's jump divided by how many times larger its noise counts.
    chi2 : float
        Of the whitened residuals, with the logarithm that the likelihood has of such a sample's larger noise.
    prior : float
        What the priors of the physics add to it.
    dof : float
        Parameters that the data decide, of those with a prior in part.
    stop : Stop
    promised : float
        What the cost may fall by yet: what a straight line promises, or the last step gained where that is more and the
        steps were used up.
    ahead : Start or None
        Where that straight line leads, without damping.
    left : float
        ``chi2`` without that logarithm.
    """

    node: Node
    point: Array
    nuisances: tuple[Array, ...]
    covariance: Array
    residuals: tuple[Array, ...]
    chi2: float
    prior: float
    dof: float
    stop: Stop = Stop.CONVERGED
    promised: float = 0.0
    ahead: Start | None = None
    left: float = math.inf

    @property
    def cost(self) -> float:
        return self.chi2 + self.prior

    def value(self, name: str) -> float:
        names = [c.name for c in self.node.coordinates]
        return float(self.node.values(self.point)[names.index(name)])


@dataclass(frozen=True, eq=False)
class Start:
    """Where a fit begins: a point, and nuisances or a path per piece."""

    point: Array
    nuisances: tuple[Array, ...] | None = None
    paths: tuple[Array, ...] | None = None


def with_noises(problem: Problem, noises: Sequence[tuple[AutoregressiveNoise, ...]]) -> Problem:
    return replace(problem, noises=tuple(noises))
