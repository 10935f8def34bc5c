"""One parameter as a file has it: a bare value, or value, standard deviation, unit and source."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np

from ssmr_ident.core.domain import Domain, Number, Schema, Text, YesNo
from ssmr_ident.core.nested_domain import Keyed, optional
from ssmr_ident.core.parameter import Estimate
from ssmr_ident.core.place import Place, shown
from ssmr_ident.session.schema import canonical_unit

SIDE: dict[str, tuple[Domain, str]] = {
    "std": (Number(least=0.0, infinite=True), "standard deviation, in unit; left out or .inf: unknown"),
    "unit": (Text(), "of value and std"),
    "source": (Text(one_line=False), "who says so: a test, a data sheet, a fit"),
    "fixed": (YesNo(), "true: a fit leaves it alone"),
    "at_bound": (YesNo(), "true: a fit ended on a bound"),
}


@dataclass(frozen=True)
class Quantity(Domain):
    """A value with what is known of it.

    Parameters
    ----------
    value : Domain
    units : tuple of str
        Spellings of its unit; the first counts where the file has none.
    """

    value: Domain
    units: tuple[str, ...]

    def check(self, place: Place, value: Any) -> Estimate:
        if value is None or (isinstance(value, Mapping) and value.get("value") is None):
            name = str(place.keys[-1]) if place.keys else "value"
            raise place.error("has no value", f"Write {name}: {{value: …, unit: {self.units[0]}}}")
        if isinstance(value, Mapping):
            entry = Keyed({"value": (self.value, ""), **SIDE}).check(place, value)
        else:
            entry = {"value": self.value.check(place, value)}
        unit = canonical_unit(entry.get("unit", self.units[0]))
        if unit not in self.units:
            raise place.error(
                f"unit is {shown(unit)}, expected {self.units[0]!r}",
                f"Convert the value and write unit: {self.units[0]}",
            )
        std, fixed = entry.get("std"), entry.get("fixed", False)
        if std == 0.0 and not fixed:
            raise place.at("std").error("is 0, expected more than 0", "Write fixed: true for what is known exactly")
        number = np.asarray(entry["value"], dtype=float)
        return Estimate(
            float(number) if number.shape == () else number,
            None if std is None or math.isinf(std) else std,
            unit,
            entry.get("source", ""),
            fixed,
            entry.get("at_bound", False),
        )

    def schema(self) -> Schema:
        value = self.value.schema()
        built = {
            "type": "object",
            "properties": {"value": value} | {name: {"$ref": f"#/$defs/{name}"} for name in SIDE},
            "required": ["value"],
            "additionalProperties": False,
            "$ref": "#/$defs/known_exactly",
        }
        return {"anyOf": [value, built]}


def definitions() -> Schema:
    """What the schemas of all quantities refer to."""
    side = {name: optional(domain) | {"description": meaning} for name, (domain, meaning) in SIDE.items()}
    exact = {"properties": {"std": {"const": 0}}, "required": ["std"]}
    said = {"properties": {"fixed": {"const": True}}, "required": ["fixed"]}
    return side | {"known_exactly": {"if": exact, "then": said}}
