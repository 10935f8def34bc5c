"""A network's recording beside its simulation: starts, zeros and gains refitted, physics not."""

from __future__ import annotations

import numpy as np

from ssmr_ident.compare.outcome import Prediction
from ssmr_ident.core.parameter import ParameterSet
from ssmr_ident.estimate.network import followed, network_problem
from ssmr_ident.estimate.node import Node
from ssmr_ident.experiments.campaign import Measurement
from ssmr_ident.physics.network import network_from_parameters
from ssmr_ident.signals.metrics import LOW_PASS_HZ

NO_GROUND = "no spring leads to the ground: the network as a whole moves freely"


def band_of(parameters: ParameterSet) -> float:
    """Below which a network is judged [Hz]."""
    return float(max(LOW_PASS_HZ, *(4.0 * network_from_parameters(parameters).modes()[0])))


def predict(parameters: ParameterSet, measurement: Measurement) -> Prediction:
    """Simulate one recording of a network."""
    problem = network_problem([measurement], parameters)
    node = Node(problem.baseline, layout=problem.layout)
    fit = followed(problem, node, np.array([c.mean for c in problem.baseline]))
    rest = np.vstack(fit.residuals)
    measured = np.vstack([piece.y + piece.foot for piece in problem.pieces])
    first = problem.pieces[0]
    zero = {}
    if first.driven:
        zero = {f"drive_zero_{first.seen.into}": float(fit.nuisances[0][node.states])}
    return Prediction(
        np.concatenate([piece.time for piece in problem.pieces]), first.channels, first.units, measured,
        measured + rest, low_pass_hz=band_of(parameters), nuisances=zero,
    )  # fmt: skip
