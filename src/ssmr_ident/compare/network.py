"""A recording of a rig or a network beside its simulation: starts, zeros and gains refitted, physics not."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np

from ssmr_ident.compare.outcome import Prediction, left_the_numbers
from ssmr_ident.core.parameter import ParameterSet
from ssmr_ident.estimate.finer import finer
from ssmr_ident.estimate.from_file import node_of
from ssmr_ident.estimate.network import followed, network_problem
from ssmr_ident.estimate.problem import natural_hz, problem_of
from ssmr_ident.estimate.stretches import in_stretches, predictable
from ssmr_ident.experiments.campaign import Measurement
from ssmr_ident.physics.network import network_from_parameters
from ssmr_ident.signals.band import Band
from ssmr_ident.signals.metrics import LOW_PASS_HZ

NO_GROUND = "no spring leads to the ground: the network as a whole moves freely"


def band_of(parameters: ParameterSet, given: Band | None = None) -> Band:
    """In which a recording of a rig or a network is judged [Hz]: as its entry says, or up to four times the highest
    natural frequency."""
    if given is not None:
        return given
    if not parameters.between:  # a rig that nothing holds, or that creeps back, has no mode
        return 0.0, max(LOW_PASS_HZ, 4.0 * natural_hz(parameters))
    return 0.0, float(max(LOW_PASS_HZ, *(4.0 * network_from_parameters(parameters).modes()[0])))


def predict(parameters: ParameterSet, measurement: Measurement) -> Prediction:
    """Simulate one recording."""
    problem = (network_problem if parameters.between else problem_of)([measurement], parameters)
    node, point = node_of(problem, parameters)
    if any(member.after == "clip" for member in node.members):  # single samples are clipped, not means over several
        as_logged = replace(problem, fastest=measurement.recording.sample_rate)
        problem = problem_of([measurement], parameters, as_logged)
        node, point = node_of(problem, parameters)
    problem = finer(problem) if node.beside else problem
    fit = followed(problem, node, point)
    if node.beside and (horizon := predictable(problem, fit)) < math.inf:  # chaotic: a start tells no more than this
        problem = in_stretches(problem, horizon)
        fit = followed(problem, node, point)
    if not math.isfinite(fit.cost):
        raise left_the_numbers(measurement.name, parameters.effects)
    rest = np.vstack(fit.residuals)
    measured = np.vstack([piece.y + piece.foot for piece in problem.pieces])
    first = problem.pieces[0]
    zero = {}
    if first.driven:
        zero = {f"drive_zero_{first.seen.into}": float(fit.nuisances[0][node.states])}
    low, high = band_of(parameters, first.band)
    return Prediction(
        np.concatenate([piece.time for piece in problem.pieces]), first.channels, first.units, measured,
        measured + rest, low_pass_hz=high, nuisances=zero, high_pass_hz=low,
    )  # fmt: skip
