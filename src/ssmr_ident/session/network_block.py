"""The ``bodies:`` and ``springs:`` of a parameter file: a network of bodies with one coordinate each."""

from __future__ import annotations

import re
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np

from ssmr_ident.core.domain import Domain, Schema
from ssmr_ident.core.errors import did_you_mean
from ssmr_ident.core.nested_domain import Keyed, Listed
from ssmr_ident.core.parameter import GROUND, Estimate
from ssmr_ident.core.place import Place, shown
from ssmr_ident.session.estimate_file import Quantity
from ssmr_ident.session.schema import KEYS

BODIES, SPRINGS, BETWEEN = "bodies", "springs", "between"

WORD = "^[A-Za-z][A-Za-z0-9_-]*$"
BODY_KEYS = ("mass_kg", "inertia_kg_m2")
SPRING_KEYS = (("stiffness_N_m", "damping_N_s_m"), ("stiffness_N_m_rad", "damping_N_m_s_rad"))
"""Of straight networks, and of rotary ones; each key has the domain that it has on a rig."""


@dataclass(frozen=True)
class Name(Domain):
    """What a body or a spring is called."""

    reserved: tuple[str, ...] = ()

    def check(self, place: Place, value: Any) -> str:
        if not isinstance(value, str) or not re.match(WORD, value) or len(value) > 60:
            raise place.error(f"is {shown(value)}, expected a name of letters, digits, _ and -, begun by a letter")
        if value in self.reserved:
            raise place.error(f"is {value!r}, which is what the bodies stand on", "Give the body another name")
        return value

    def schema(self) -> Schema:
        return {"type": "string", "pattern": WORD, "maxLength": 60}


def _quantities(keys: tuple[str, ...]) -> dict[str, tuple[Domain, str]]:
    return {key: (Quantity(KEYS[key].domain, (KEYS[key].unit,)), KEYS[key].unit) for key in keys}


BODY = Keyed(_quantities(BODY_KEYS), one_of=BODY_KEYS)
SPRING = Keyed(
    {BETWEEN: (Listed(Name(), 2, 2, distinct=True), f"the two that it joins, bodies or {GROUND}")}
    | _quantities(tuple(key for keys in SPRING_KEYS for key in keys)),
    (BETWEEN,),
)


def network_schemas() -> Schema:
    """Properties of the two blocks."""
    names = Name().schema()

    def block(each: Keyed, meaning: str) -> Schema:
        made = {"type": "object", "minProperties": 1, "propertyNames": names, "additionalProperties": each.schema()}
        return made | {"description": meaning}

    return {
        BODIES: block(BODY, "baseline: network: bodies with one coordinate each, by name"),
        SPRINGS: block(SPRING, "baseline: network: springs with their dampers, by name"),
    }


def read_network(place: Place, content: Mapping[str, Any]) -> tuple[dict[str, Estimate], dict[str, tuple[str, str]]]:
    """Estimates by dotted path, and what each spring joins; ``place`` is that of the file.

    Raises
    ------
    InputError
        With file, line and key: an unknown body, a body that no spring holds to the others, straight and rotary keys
        together.
    """
    bodies = {name: BODY.check(at, own) for name, at, own in _named(place.at(BODIES), content.get(BODIES), (GROUND,))}
    springs = {name: SPRING.check(at, own) for name, at, own in _named(place.at(SPRINGS), content.get(SPRINGS))}
    turns = [next(iter(own)) == BODY_KEYS[1] for own in bodies.values()]
    if len(set(turns)) > 1:
        name = next(n for n, turning in zip(bodies, turns, strict=True) if turning is not turns[0])
        raise place.at(BODIES, name).error(f"mixes {' and '.join(BODY_KEYS)}", "A network moves along lines, or turns")
    wanted, other = SPRING_KEYS if not turns[0] else SPRING_KEYS[::-1]
    estimates = {f"{BODIES}.{name}.{key}": e for name, own in bodies.items() for key, e in own.items()}
    between: dict[str, tuple[str, str]] = {}
    for name, own in springs.items():
        here = place.at(SPRINGS, name)
        for end in own[BETWEEN]:
            if end not in (*bodies, GROUND):
                raise here.at(BETWEEN).error(f"names {end!r}, which is no body", did_you_mean(end, (*bodies, GROUND)))
        between[name] = own[BETWEEN]
        for key in other:
            if key in own:
                mend = f"Bodies with {BODY_KEYS[turns[0]]} have springs with {' and '.join(wanted)}"
                raise here.at(key).error("is of the other kind of network", mend)
        for key in wanted:
            if key not in own:
                raise here.at(key).error("is missing", f"Write {key}: {{value: …, std: …}}")
            estimate = own[key]
            if KEYS[key].zero_is_none and not np.any(estimate.value) and not estimate.fixed:
                raise here.at(key).error("is 0, expected more than 0", "Add fixed: true where there is only a damper")
            estimates[f"{SPRINGS}.{name}.{key}"] = estimate
    _joined(place, tuple(bodies), between)
    return estimates, between


def _named(place: Place, block: Any, reserved: tuple[str, ...] = ()) -> list[tuple[str, Place, Any]]:
    if block is None:
        other = SPRINGS if place.keys[-1] == BODIES else BODIES
        raise place.error("is missing", f"A network has {BODIES} and {SPRINGS}; this file has {other}")
    if not isinstance(block, Mapping) or not block:
        raise place.error(f"is {shown(block)}, expected a mapping of names")
    return [(Name(reserved).check(place.at(str(name)), name), place.at(str(name)), own) for name, own in block.items()]


def _joined(place: Place, bodies: tuple[str, ...], between: Mapping[str, tuple[str, str]]) -> None:
    """Refuse a body that moves apart from all others."""
    reached = {GROUND if any(GROUND in ends for ends in between.values()) else bodies[0]}
    while True:
        new = {end for ends in between.values() if reached & set(ends) for end in ends} - reached
        if not new:
            break
        reached |= new
    for name in bodies:
        if name not in reached:
            mend = f"Add a spring between {name} and another body or {GROUND}, or make a session of its own of it"
            raise place.at(BODIES, name).error("is held to nothing else by any spring", mend)
