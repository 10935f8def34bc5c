"""What a value may be, declared once: asked where files and options are read, and told to editors as a JSON schema."""

from __future__ import annotations

import datetime
import math
from abc import ABC, abstractmethod
from dataclasses import dataclass
from typing import Any

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
            told = value[:60] if isinstance(value, str) else shown(value)
            raise place.error(f"is {shown(value)}", did_you_mean(told, map(str, self.known)))
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


def _float(value: Any) -> float | None:
    if isinstance(value, bool) or not isinstance(value, int | float):
        return None
    try:
        number = float(value)
    except OverflowError:
        return None
    return None if math.isnan(number) else number
