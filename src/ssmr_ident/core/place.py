"""Where in a file or a call a value stands, so that an error can say so."""

from __future__ import annotations

import datetime
import reprlib
from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from typing import Any

from ssmr_ident.core.errors import InputError
from ssmr_ident.core.shown import Shown

Way = tuple[str | int, ...]

_LONGEST = 60


@dataclass(frozen=True)
class Place(Shown):
    """A key of a file, or an option; prints as ``session.yaml:7: recordings[0].speed_mm_s``.

    Parameters
    ----------
    file : str
        Name of the file or of the option.
    keys : tuple of str or int
        The way to the key.
    lines : mapping of such a way to int
        Line of the file in which each key stands.
    """

    file: str
    keys: Way = ()
    lines: Mapping[Way, int] = field(default_factory=dict)

    def at(self, *keys: str | int) -> Place:
        """A key below."""
        return replace(self, keys=self.keys + keys)

    def error(self, problem: str, mend: str = "") -> InputError:
        """An error of this place, to be raised."""
        return InputError(str(self), problem, mend)

    def __str__(self) -> str:
        ways = (self.keys[:depth] for depth in range(len(self.keys), -1, -1))
        line = next((self.lines[way] for way in ways if way in self.lines), None)
        name = "".join(f"[{key}]" if isinstance(key, int) else f".{short(key)}" for key in self.keys).lstrip(".")
        between = "" if self.file.startswith("--") else ": "  # an option and a number in its list are one word
        return self.file + (f":{line}" if line is not None else "") + (f"{between}{name}" if name else "")


class _OneLine(reprlib.Repr):
    """Values on one line, none longer than it."""

    def __init__(self) -> None:
        super().__init__()
        self.maxstring = self.maxother = _LONGEST
        self.maxlist = self.maxtuple = self.maxdict = 4
        self.maxlevel = 2

    def repr_int(self, x: int, level: int) -> str:
        if x.bit_length() > 1000:  # Python prints none above 4300 digits
            return f"a number of {int(x.bit_length() * 0.30103) + 1} digits"
        return super().repr_int(x, level)

    def repr_bool(self, x: bool, level: int) -> str:
        return "true" if x else "false"

    def repr_date(self, x: datetime.date, level: int) -> str:
        return x.isoformat()

    repr_datetime = repr_date


def shown(value: Any) -> str:
    """A value as an error shows it.

    >>> shown([2.5, None]), shown("a\\nb"), shown(10 ** 5000)
    ('[2.5, None]', "'a\\\\nb'", 'a number of 5001 digits')
    """
    return _SHOWN.repr(value)


_SHOWN = _OneLine()


def short(text: str, longest: int = _LONGEST) -> str:
    """The beginning of a text that is longer than a line has room for."""
    return text if len(text) <= longest else f"{text[: longest - 1]}…"
