"""A recording of a network, or of a rig that a motor drives, beside its simulation: starts, zeros and gains refitted,
physics not."""

from __future__ import annotations

import numpy as np

from ssmr_ident.compare.outcome import Prediction
from ssmr_ident.core.errors import InputError
from ssmr_ident.core.parameter import ParameterSet, effect_and_element
from ssmr_ident.estimate.generic import MEMORY, STATIC
from ssmr_ident.estimate.network import followed, network_problem
from ssmr_ident.estimate.node import Member, Node
from ssmr_ident.estimate.problem import natural_hz, problem_of
from ssmr_ident.experiments.campaign import Measurement
from ssmr_ident.physics.effect import Site
from ssmr_ident.physics.effects import CATALOGUE
from ssmr_ident.physics.network import network_from_parameters
from ssmr_ident.physics.slots import effect_values
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


def laws_of(parameters: ParameterSet) -> tuple[Member, ...]:
    """The effects of the file of a network, or of a rig with a drive, as members that nothing fits.

    Raises
    ------
    InputError
        One that acts at no spring, or several springs with effects.
    """
    where = f"{parameters.file or parameters.name}: effects"
    found = []
    for key, values in effect_values(parameters).items():
        effect, element = effect_and_element(key)
        acts = CATALOGUE[effect].acts if CATALOGUE[effect].rig and not values.get("rider_share") else {}
        if not parameters.between and not {Site.ELEMENT, Site.DRIVE} & set(acts):
            raise InputError(f"{where}.{effect}", "is nothing of a drive's spring or gears", "Leave it out")
        if parameters.between and (not element or Site.ELEMENT not in acts):
            springs = ", ".join(parameters.between)
            raise InputError(f"{where}.{effect}", "acts at no spring of a network", f"element: one of {springs}")
        kind = MEMORY if Site.STATE in CATALOGUE[effect].acts else STATIC
        found.append(Member(effect, kind, "", (), law=values, element=element))
    places = sorted({member.element for member in found})
    if len(places) > 1:
        raise InputError(where, f"act at {' and '.join(places)}", "One spring may have effects; leave the others out")
    return tuple(found)


def predict(parameters: ParameterSet, measurement: Measurement) -> Prediction:
    """Simulate one recording."""
    problem = (network_problem if parameters.between else problem_of)([measurement], parameters)
    node = Node(problem.baseline, laws_of(parameters), problem.layout)
    fit = followed(problem, node, np.array([c.mean for c in problem.baseline]))
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
