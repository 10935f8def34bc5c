"""The JSON schemas of session.yaml and of parameter files, made from what the readers ask; editors check by them.

``python -m ssmr_ident.session.json_schema`` writes the shipped files anew.
"""

from __future__ import annotations

import json
from importlib import resources
from pathlib import Path

from ssmr_ident.core.atomic import write_text
from ssmr_ident.core.domain import Schema
from ssmr_ident.core.nested_domain import optional
from ssmr_ident.core.rotary import both_names, rotary
from ssmr_ident.session.effects_block import effect_keys
from ssmr_ident.session.estimate_file import Quantity, definitions
from ssmr_ident.session.network_block import Name, network_schemas
from ssmr_ident.session.parameters_file import HEAD
from ssmr_ident.session.schema import CHOICES, KEYS
from ssmr_ident.session.session_file import FILE

DIALECT = "https://json-schema.org/draft/2020-12/schema"


def session_schema() -> Schema:
    """Of session.yaml."""
    title = "A session: which logs, made how, with which role (session.yaml)"
    return {"$schema": DIALECT, "title": title} | FILE.schema()


def parameters_schema() -> Schema:
    """Of robot.yaml, of a rig's file, and of what ``ident fit`` exports."""
    title = "Parameters of a robot or rig, with what is known of each (robot.yaml, rig.yaml)"
    made: Schema = {"$schema": DIALECT, "title": title, "type": "object", "additionalProperties": False}
    properties: Schema = {
        name: optional(domain, name != "schema") | {"description": meaning} for name, (domain, meaning) in HEAD.items()
    }
    for path, key in KEYS.items():
        *blocks, last = path.split(".")
        inside = properties
        for block in blocks:
            # a rotary rig's inertia is a number where a robot's is a block of them
            inside = inside.setdefault(block, {"anyOf": []})
            built = next(
                (one for one in inside["anyOf"] if "properties" in one and "value" not in one["properties"]), None
            )
            if built is None:
                built = {"type": "object", "properties": {}, "additionalProperties": False}
                inside["anyOf"].append(built)
            inside = built["properties"]
        quantity = Quantity(key.domain, (key.unit,)).schema() | {"description": f"{key.meaning} [{key.unit}]"}
        if key.zero_is_none:
            quantity |= {"$ref": "#/$defs/none_is_fixed"}
        if last in inside:
            inside[last]["anyOf"].append(quantity)
        else:
            inside[last] = quantity
    for path, (choice, meaning) in CHOICES.items():
        block, last = path.split(".")
        properties[block]["anyOf"][0]["properties"][last] = choice.schema() | {"description": meaning}
    properties |= network_schemas()
    properties["effects"], effects = _effects()
    properties["provenance"] = {"type": ["object", "null"], "description": "where the numbers come from"}
    absent = {"anyOf": [{"const": 0}, {"type": "object", "properties": {"value": {"const": 0}}, "required": ["value"]}]}
    said = {"type": "object", "properties": {"fixed": {"const": True}}, "required": ["fixed"]}
    shared = definitions() | effects | {"none_is_fixed": {"if": absent, "then": said}}
    return made | {"properties": properties, "required": ["schema"], "$defs": shared}


def _effects() -> tuple[Schema, Schema]:
    """The block, and what it refers to."""
    element = {"element": Name().schema() | {"description": "of a network: the spring at which it acts"}}
    blocks: Schema = {
        effect: {
            "type": "object",
            "additionalProperties": False,
            "properties": element
            | {
                named: Quantity(domain, (domain.unit, rotary(domain.unit))).schema()
                | {"description": f"{meaning} [{unit}]".strip()}
                for name, (domain, meaning) in keys.items()
                for named, unit in both_names(name, domain.unit).items()
            },
        }
        for effect, keys in effect_keys().items()
    }
    references = {effect: {"$ref": f"#/$defs/effect_{effect}"} for effect in blocks}
    one_or_several = {
        effect: {"anyOf": [one, {"type": "array", "minItems": 1, "items": one}]} for effect, one in references.items()
    }
    meaning = "physics beyond the baseline; ident effects lists what there is"
    made = {
        "type": ["object", "null"],
        "description": meaning,
        "additionalProperties": False,
        "properties": one_or_several,
    }
    return made, {f"effect_{effect}": block for effect, block in blocks.items()}


MADE = {"session": session_schema, "parameters": parameters_schema}


def schema_file(name: str) -> Path:
    """The shipped schema, ``session`` or ``parameters``, for an editor's settings."""
    return Path(str(resources.files("ssmr_ident.session") / "schemas" / f"{name}.schema.json"))


if __name__ == "__main__":
    for name, make in MADE.items():
        print(write_text(schema_file(name), json.dumps(make(), ensure_ascii=False, indent=1) + "\n"))
