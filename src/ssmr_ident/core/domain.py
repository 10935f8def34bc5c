"""What a value may be, declared once: asked where files and options are read, and told to editors as a JSON schema."""

from __future__ import annotations

import datetime
import math
from abc import ABC, abstractmethod
from collections.abc import Mapping
from dataclasses import dataclass, fields
from functools import cache
from typing import Any, get_type_hints

from ssmr_ident.core.errors import did_you_mean
from ssmr_ident.core.place import Place, shown

Schema = dict[str, Any]

FINITE = 1e300
"""Beyond it a square is no number any more."""


class Domain(ABC):
    """The values that a key may have."""

    @abstractmethod
    def check(self, place: Place, value: Any) -> Any:
        """The value as the program uses it.

        Raises
        ------
        InputError
            Names the place, what was got and what was expected.
        """

    @abstractmethod
    def schema(self) -> Schema:
        """The same as JSON schema."""


@dataclass(frozen=True)
class Number(Domain):
    """A number, finite unless ``infinite`` says otherwise.

    Parameters
    ----------
    unit : str
    least, most : float
        Bounds that belong to it.
    above : float
        Bound that does not.
    infinite : bool
        Whether ``.inf`` has a meaning, as of a cable that does not give; what is beyond ``FINITE`` is read as it.
    nonzero : bool
    """

    unit: str = ""
    least: float = -FINITE
    most: float = FINITE
    above: float = -math.inf
    infinite: bool = False
    nonzero: bool = False

    def check(self, place: Place, value: Any) -> float:
        number = _float(value)
        if number is not None and self.infinite and number > FINITE:
            number = math.inf
        if number is None or not self.contains(number):
            raise place.error(f"is {shown(value)}, expected {self.expected}")
        return number

    def contains(self, number: float) -> bool:
        """Whether a float lies within."""
        if math.isinf(number):
            return self.infinite and number > 0
        return self.least <= number <= self.most and number > self.above and not (self.nonzero and number == 0.0)

    @property
    def expected(self) -> str:
        """The domain in words."""
        low = f" more than {self.above:g}" if self.above > self.least else ""
        low = low or (f" ≥ {self.least:g}" if self.least > -FINITE else "")
        high = f" ≤ {self.most:g}" if self.most < FINITE else ""
        bounds = " and".join(part for part in (low, high) if part)
        text = f"a {'' if self.infinite else 'finite '}number{bounds}{' and not 0' if self.nonzero else ''}"
        return text + (f" (in {self.unit})" if self.unit not in ("", "1") else "")

    def schema(self) -> Schema:
        made: Schema = {"type": "number"}
        if self.above > self.least:
            made["exclusiveMinimum"] = self.above
        else:
            made["minimum"] = self.least
        if not self.infinite:
            made["maximum"] = self.most
        if self.nonzero:
            made["not"] = {"const": 0}
        return made


@dataclass(frozen=True)
class Whole(Domain):
    """A whole number, ``least`` to ``most``."""

    least: int = 0
    most: int = 2**31 - 1

    def check(self, place: Place, value: Any) -> int:
        whole = isinstance(value, int) and not isinstance(value, bool)
        whole = whole or (isinstance(value, float) and value.is_integer())
        if not whole or not self.least <= value <= self.most:
            raise place.error(f"is {shown(value)}, expected a whole number ≥ {self.least} and ≤ {self.most}")
        return int(value)

    def schema(self) -> Schema:
        return {"type": "integer", "minimum": self.least, "maximum": self.most}


@dataclass(frozen=True)
class Choice(Domain):
    """One of a few words or numbers."""

    known: tuple[str | int, ...]

    def check(self, place: Place, value: Any) -> Any:
        if isinstance(value, bool) or not isinstance(value, str | int | float) or value not in self.known:
            if len(self.known) == 1:
                raise place.error(f"is {shown(value)}, expected {self.known[0]!r}")
            raise place.error(f"is {shown(value)}", did_you_mean(str(value)[:60], map(str, self.known)))
        return value

    def schema(self) -> Schema:
        return {"enum": list(self.known)}


@dataclass(frozen=True)
class YesNo(Domain):
    """``true`` or ``false``."""

    def check(self, place: Place, value: Any) -> bool:
        if not isinstance(value, bool):
            raise place.error(f"is {shown(value)}, expected true or false")
        return value

    def schema(self) -> Schema:
        return {"type": "boolean"}


@dataclass(frozen=True)
class Text(Domain):
    """Words; a plain number or date counts as its own text.

    Parameters
    ----------
    longest : int
        Letters at most.
    one_line : bool
        Whether control characters, line ends among them, are refused.
    """

    longest: int = 4096
    one_line: bool = True

    def check(self, place: Place, value: Any) -> str:
        if isinstance(value, bool) or not isinstance(value, str | int | float | datetime.date):
            raise place.error(f"is {shown(value)}, expected text", "Write it in quotes")
        text = value if isinstance(value, str) else shown(value)
        if len(text) > self.longest:
            raise place.error(f"has {len(text)} letters, expected at most {self.longest}")
        if self.one_line and any(ord(letter) < 32 or ord(letter) == 127 for letter in text):
            raise place.error(f"is {shown(text)}, expected text without control characters")
        return text

    def schema(self) -> Schema:
        made: Schema = {"type": ["string", "number"], "maxLength": self.longest}
        return made | ({"pattern": "^[^\\u0000-\\u001f\\u007f]*$"} if self.one_line else {})


@dataclass(frozen=True)
class FileName(Domain):
    """Name of a file relative to the folder of the file that names it."""

    def check(self, place: Place, value: Any) -> str:
        if not isinstance(value, str) or not value:
            raise place.error(f"is {shown(value)}, expected a file name")
        if any(ord(letter) < 32 for letter in value) or max(len(p.encode()) for p in value.split("/")) > 255:
            raise place.error(f"is {shown(value)}, which no file can be called", "Check the name")
        return value

    def schema(self) -> Schema:
        return {
            "type": "string",
            "pattern": "^[^\\u0000-\\u001f/]{0,255}(/[^\\u0000-\\u001f/]{0,255})*$",
            "minLength": 1,
        }


@dataclass(frozen=True)
class Pointer(Domain):
    """A thing by its number, from ``least``, or by its name."""

    least: int = 0

    def check(self, place: Place, value: Any) -> int | str:
        if isinstance(value, int | float):
            return Whole(self.least).check(place, value)
        return Text().check(place, value)

    def schema(self) -> Schema:
        return {"anyOf": [Whole(self.least).schema(), Text().schema() | {"type": "string"}]}


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


def _float(value: Any) -> float | None:
    if isinstance(value, bool) or not isinstance(value, int | float):
        return None
    try:
        number = float(value)
    except OverflowError:
        return None
    return None if math.isnan(number) else number
