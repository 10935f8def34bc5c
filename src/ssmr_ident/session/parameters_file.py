"""Parameter files read: robot.yaml as a user writes it, and the same schema as ``ident fit`` exports it."""

from __future__ import annotations

from collections.abc import Mapping
from importlib import resources
from pathlib import Path
from typing import Any

import numpy as np

from ssmr_ident.core.domain import Choice, Number, Text
from ssmr_ident.core.errors import did_you_mean
from ssmr_ident.core.nested_domain import Keyed
from ssmr_ident.core.parameter import Estimate, ParameterSet, at_element, turns
from ssmr_ident.core.place import Place, shown
from ssmr_ident.core.rotary import rotary, rotary_name
from ssmr_ident.session.effects_block import effect_keys
from ssmr_ident.session.estimate_file import Quantity
from ssmr_ident.session.network_block import BODIES, BODY_KEYS, SPRING_KEYS, SPRINGS, read_network
from ssmr_ident.session.parameters_text import SCHEMA
from ssmr_ident.session.schema import BLOCKS, CHOICES, KEYS
from ssmr_ident.session.yaml_file import expect_schema, load_with_lines

HEAD: dict[str, tuple[Any, str]] = {
    "schema": (Choice((SCHEMA,)), "what kind of file this is"),
    "name": (Text(one_line=False), "of the robot or rig"),
}
"""What stands beside the parameters; ``effects`` and ``provenance`` are read on their own."""

ELEMENT = "element"
"""Of an effect on a network: the spring at which it acts."""

_OF_A_RIG = (*BODY_KEYS, *(key for keys in SPRING_KEYS for key in keys))


def bundled_robots() -> tuple[str, ...]:
    """Names that ``robot:`` accepts without a file."""
    folder = resources.files("ssmr_ident.session") / "robots"
    return tuple(sorted(entry.name.removesuffix(".yaml") for entry in folder.iterdir() if entry.name.endswith(".yaml")))


def read_parameters(path: str | Path) -> ParameterSet:
    """Read a parameter file, or a bundled robot by its name.

    Raises
    ------
    InputError
        With file, line and key, for an unknown key or effect, a wrong unit, a value that is no number or cannot be.
    """
    if str(path) in bundled_robots():
        path = Path(str(resources.files("ssmr_ident.session") / "robots" / f"{path}.yaml"))
    path = Path(path)
    return parameters_of(*load_with_lines(path))


def parameters_of(place: Place, content: Mapping[str, Any]) -> ParameterSet:
    """The parameters that the content of a file holds; ``place`` knows its name and lines. Raises as the above."""
    expect_schema(place, content, SCHEMA)
    head = Keyed(HEAD).check(place, {key: content[key] for key in HEAD if key in content})
    estimates: dict[str, Estimate] = {}
    choices: dict[str, str] = {}
    between: dict[str, tuple[str, str]] = {}
    if BODIES in content or SPRINGS in content:
        estimates, between = read_network(place, content)
    for key, block in content.items():
        if key not in (*HEAD, BODIES, SPRINGS, "effects", "provenance"):
            _collect(place.at(str(key)), str(key), block, estimates, choices)
    if between:
        alone = next((key for key in estimates if key in _OF_A_RIG), None)
        if alone:
            raise place.at(alone).error(f"stands beside {BODIES}", f"Write it below {BODIES} or {SPRINGS}")
    effects = _effects(place.at("effects"), _given(content, "effects"), turns(estimates), tuple(between))
    provenance = _given(content, "provenance")
    if not isinstance(provenance, Mapping):
        raise place.at("provenance").error(f"is {shown(provenance)}, expected a mapping")
    name = head.get("name", Path(place.file).stem)
    return ParameterSet(name, estimates, effects, provenance, place.file, choices, between)


def _beside(key: str) -> set[str]:
    """The keys that are known where an unknown one stands."""
    block = key.rpartition(".")[0]
    begin = f"{block}." if block else ""
    known = {path[len(begin) :].partition(".")[0] for path in (*KEYS, *CHOICES) if path.startswith(begin)}
    return known if block else known | {*HEAD, BODIES, SPRINGS, "effects", "provenance"}


def _given(content: Mapping[str, Any], key: str) -> Any:
    found = content.get(key)
    return {} if found is None else found


def _collect(place: Place, key: str, block: Any, estimates: dict[str, Estimate], choices: dict[str, str]) -> None:
    if key in CHOICES:
        choices[key] = CHOICES[key][0].check(place, block)
        return
    if isinstance(block, Mapping) and "value" not in block and key in BLOCKS:
        for name, inner in block.items():
            _collect(place.at(str(name)), f"{key}.{name}", inner, estimates, choices)
        return
    if key not in KEYS:
        raise place.error("is not a known key", did_you_mean(key.rpartition(".")[2][:60], _beside(key)))
    declared = KEYS[key]
    estimate = Quantity(declared.domain, (declared.unit,)).check(place, block)
    if declared.zero_is_none and not np.any(estimate.value) and not estimate.fixed:
        raise place.error("is 0, expected more than 0", "Add fixed: true where there is no spring")
    estimates[key] = estimate


def _effects(place: Place, block: Any, turning: bool, springs: tuple[str, ...]) -> dict[str, dict[str, Estimate]]:
    if not isinstance(block, Mapping):
        raise place.error(f"is {shown(block)}, expected a mapping of effect ids")
    known = effect_keys() if block else {}
    found: dict[str, dict[str, Estimate]] = {}
    for effect, parameters in block.items():
        here = place.at(str(effect))
        if effect not in known:
            raise here.error(
                "is no known effect", f"{did_you_mean(str(effect)[:60], known)} One of your own: --effects FILE"
            )
        several = springs and isinstance(parameters, list | tuple)
        for at, own in ((here.at(k), one) for k, one in enumerate(parameters)) if several else ((here, parameters),):
            if not isinstance(own, Mapping):
                raise at.error(f"is {shown(own)}, expected a mapping of its parameters")
            name = at_element(effect, _element(at, own, springs))
            if name in found:
                raise at.at(ELEMENT).error("stands twice with this effect", "Write one of them for each spring")
            found[name] = _one_effect(at, own, known[effect], turning)
    return found


def _element(place: Place, block: Mapping[str, Any], springs: tuple[str, ...]) -> str:
    """Spring at which an effect acts; empty on what is no network."""
    if ELEMENT not in block:
        return ""
    element = block[ELEMENT]
    if not springs:
        raise place.at(ELEMENT).error("is a spring of a network, and this file has none", "Take it out")
    if element not in springs:
        raise place.at(ELEMENT).error(f"is {shown(element)}, which is no spring", did_you_mean(str(element), springs))
    return str(element)


def _one_effect(
    place: Place, block: Mapping[str, Any], known: Mapping[str, tuple[Number, str]], turning: bool
) -> dict[str, Estimate]:
    found: dict[str, Estimate] = {}
    turned = {rotary_name(name, domain.unit): name for name, (domain, _) in known.items()} if turning else {}
    for key, entry in block.items():
        if key == ELEMENT:
            continue
        own = turned.get(str(key), key)
        if own not in known:
            raise place.at(str(key)).error(
                "is no parameter of this effect", did_you_mean(str(key)[:60], turned or known)
            )
        domain, _ = known[own]
        units = (domain.unit, rotary(domain.unit)) if turning else (domain.unit,)
        name = rotary_name(own, domain.unit) if turning else own
        if name in found:
            raise place.at(str(key)).error(f"stands twice: {name} is the same", "Leave one out")
        found[name] = Quantity(domain, units).check(place.at(key), entry)
    return found
