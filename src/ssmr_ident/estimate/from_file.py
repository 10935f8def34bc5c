"""The effects of a parameter file as members that nothing fits, on a rig or a network."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping
from dataclasses import replace

import numpy as np

from ssmr_ident.core.errors import InputError
from ssmr_ident.core.parameter import ParameterSet, effect_and_element
from ssmr_ident.estimate.generic import MEMORY, RANGES, STATIC, clip, delay, lag, rider
from ssmr_ident.estimate.instrument import OF_THEIR_OWN, at_output
from ssmr_ident.estimate.node import Member, Node
from ssmr_ident.estimate.values import Problem
from ssmr_ident.physics.effect import Site
from ssmr_ident.physics.effects import CATALOGUE
from ssmr_ident.physics.slots import effect_values
from ssmr_ident.physics.voltage_drive import drive_from_parameters

Array = np.ndarray
Values = Mapping[str, float]

RIDES = ("rider_share", "rider_Hz", "rider_ratio")


def node_of(problem: Problem, parameters: ParameterSet) -> tuple[Node, Array]:
    """What a file describes, and its coordinates.

    Raises
    ------
    InputError
        An effect that acts nowhere on what the file describes, or several springs with effects.
    """
    members = list(laws_of(parameters))
    given: dict[int, float] = {}
    if not parameters.between and drive_from_parameters(parameters) is None:
        for effect, values in effect_values(parameters).items():
            for member, own in _not_laws(problem, effect, values):
                exactly = tuple(replace(c, lower=-math.inf, upper=math.inf) for c in member.coordinates)
                members.append(replace(member, coordinates=exactly))
                given |= {id(c): own[c.name] for c in exactly if c.name in own}
    node = Node(problem.baseline, tuple(members), problem.layout)
    return node, np.array([c.at(given[id(c)]) if id(c) in given else c.mean for c in node.coordinates])


def laws_of(parameters: ParameterSet) -> tuple[Member, ...]:
    """The laws of springs and gears in a file.

    Raises
    ------
    InputError
        One that acts at no spring, or several springs with effects.
    """
    where = f"{parameters.file or parameters.name}: effects"
    driven = drive_from_parameters(parameters) is not None
    found = []
    for key, values in effect_values(parameters).items():
        effect, element = effect_and_element(key)
        rides = bool(values.get("rider_share"))
        acts = set(CATALOGUE[effect].acts) if CATALOGUE[effect].rig else set()
        if not parameters.between and not (acts if not driven else {Site.ELEMENT, Site.DRIVE} & acts and not rides):
            raise InputError(
                f"{where}.{effect}", f"is nothing of {'the spring or gears of a drive' if driven else 'a rig'}",
                "Leave it out",
            )  # fmt: skip
        if parameters.between and (not element or Site.ELEMENT not in acts or rides):
            springs = ", ".join(parameters.between)
            raise InputError(f"{where}.{effect}", "acts at no spring of a network", f"element: one of {springs}")
        if not {Site.ELEMENT, Site.DRIVE} & acts:
            continue
        kind = MEMORY if Site.STATE in CATALOGUE[effect].acts else STATIC
        found.append(Member(effect, kind, "", (), law={**values, **dict.fromkeys(RIDES[:rides], 0.0)}, element=element))
    places = sorted({member.element for member in found})
    if len(places) > 1:
        raise InputError(where, f"act at {' and '.join(places)}", "One spring may have effects; leave the others out")
    return tuple(found)


def _not_laws(problem: Problem, effect: str, values: Values) -> Iterator[tuple[Member, Values]]:
    """Members of a rig's effect that are no law of its spring, with their parameters."""
    if values.get("rider_share"):
        yield rider(problem, values["rider_Hz"]), values
    if effect == "sensor_bandwidth" and values["bandwidth_hz"] < problem.bandwidth_hz:
        yield lag(values["bandwidth_hz"], problem.bandwidth_hz, values["order"]), values
    elif effect == "sensor_delay":
        yield delay(problem.pieces[0].step, abs(values["delay_s"])), values
    elif effect == "sensor_saturation":
        piece = problem.pieces[0]
        for name, unit in zip(piece.channels, piece.units, strict=True):
            if values.get(RANGES.get(unit, ""), math.inf) < math.inf:
                yield clip(name, values[RANGES[unit]], RANGES[unit], unit), values
    elif Site.OUTPUT in CATALOGUE[effect].acts and effect not in OF_THEIR_OWN:
        yield at_output(CATALOGUE[effect], values, {}), values
