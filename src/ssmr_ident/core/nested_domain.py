"""What lists and mappings may be, of the domains of what is in them."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, fields
from functools import cache
from typing import Any, get_type_hints

from ssmr_ident.core.domain import Domain, Schema
from ssmr_ident.core.errors import did_you_mean
from ssmr_ident.core.place import Place, shown


@dataclass(frozen=True)
class Listed(Domain):
    """A list, ``least`` to ``most`` long; ``distinct`` where nothing may stand twice."""

    of: Domain
    least: int = 0
    most: int = 100_000
    distinct: bool = False

    def check(self, place: Place, value: Any) -> tuple[Any, ...]:
        if not isinstance(value, list | tuple) or not self.least <= len(value) <= self.most:
            size = str(self.least) if self.least == self.most else f"{self.least} to {self.most}"
            raise place.error(f"is {shown(value)}, expected a list of {size}")
        items = tuple(self.of.check(place.at(index), item) for index, item in enumerate(value))
        if self.distinct and len(set(items)) != len(items):
            raise place.error(f"is {shown(value)}, in which something stands twice")
        return items

    def schema(self) -> Schema:
        made: Schema = {"type": "array", "items": self.of.schema(), "minItems": self.least, "maxItems": self.most}
        return made | ({"uniqueItems": True} if self.distinct else {})


@dataclass(frozen=True)
class Mapped(Domain):
    """A mapping of keys of one domain to values of another."""

    keys: Domain
    values: Domain

    def check(self, place: Place, value: Any) -> dict[str, Any]:
        if not isinstance(value, Mapping):
            raise place.error(f"is {shown(value)}, expected a mapping")
        return {
            str(self.keys.check(place.at(str(key)), key)): self.values.check(place.at(str(key)), inner)
            for key, inner in value.items()
        }

    def schema(self) -> Schema:
        names = self.keys.schema()
        names = names if "enum" in names else names | {"type": "string"}
        return {"type": "object", "propertyNames": names, "additionalProperties": self.values.schema()}


@dataclass(frozen=True)
class Keyed(Domain):
    """A mapping whose keys are known, each with its own domain.

    Parameters
    ----------
    keys : mapping of str to pair of Domain and str
        With what each means.
    needed : tuple of str
    one_of : tuple of str
        Of these exactly one is needed; none where it is empty.
    """

    keys: Mapping[str, tuple[Domain, str]]
    needed: tuple[str, ...] = ()
    one_of: tuple[str, ...] = ()

    def check(self, place: Place, value: Any) -> dict[str, Any]:
        if not isinstance(value, Mapping):
            raise place.error(f"is {shown(value)}, expected a mapping", did_you_mean("", self.keys))
        for key in value:
            if key not in self.keys:
                raise place.at(str(key)).error("is not a known key", did_you_mean(str(key)[:60], self.keys))
        for key in self.needed:
            if value.get(key) is None:
                raise place.at(key).error("is missing", f"Needed here: {', '.join(self.needed)}")
        given = [key for key in self.one_of if value.get(key) is not None]
        if self.one_of and len(given) != 1:
            problem = f"stands beside {given[1]}" if given else "is missing"
            raise place.at(self.one_of[0]).error(problem, f"Needed here: one of {', '.join(self.one_of)}")
        return {
            str(key): self.keys[key][0].check(place.at(key), inner) for key, inner in value.items() if inner is not None
        }

    def schema(self) -> Schema:
        properties = {
            key: ({"description": meaning} if meaning else {}) | optional(domain, key not in self.needed)
            for key, (domain, meaning) in self.keys.items()
        }
        made: Schema = {"type": "object", "properties": properties, "additionalProperties": False}
        made |= {"required": list(self.needed)} if self.needed else {}
        ways = [{"required": [key], "properties": {key: {"not": {"type": "null"}}}} for key in self.one_of]
        return made | ({"oneOf": ways} if ways else {})


@dataclass(frozen=True)
class Either(Domain):
    """A plain value or a mapping or list: the value's own form decides which domain speaks."""

    plain: Domain
    built: Domain

    def check(self, place: Place, value: Any) -> Any:
        chosen = self.built if isinstance(value, Mapping | list | tuple) else self.plain
        return chosen.check(place, value)

    def schema(self) -> Schema:
        return {"anyOf": [self.plain.schema(), self.built.schema()]}


def optional(domain: Domain, may_be_empty: bool = True) -> Schema:
    """The schema of a key behind which nothing may stand."""
    schema = domain.schema()
    return {"anyOf": [schema, {"type": "null"}]} if may_be_empty else schema


@cache
def declared(kind: type) -> dict[str, tuple[Domain, str]]:
    """Domain and meaning of each field of a dataclass that declares them: ``Annotated[float, Number(), "meaning"]``."""
    hints = get_type_hints(kind, include_extras=True)
    notes = {field.name: getattr(hints[field.name], "__metadata__", ()) for field in fields(kind)}
    return {name: (found[0], found[1] if len(found) > 1 else "") for name, found in notes.items() if found}
