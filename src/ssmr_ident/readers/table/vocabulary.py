"""What columns are called: the words of vocabulary.yaml, and those of a file beside the log."""

from __future__ import annotations

import re
import unicodedata
from dataclasses import dataclass, field
from functools import cache
from pathlib import Path
from typing import Any

import yaml

from ssmr_ident.core.domain import Number, Text, YesNo
from ssmr_ident.core.errors import InputError, did_you_mean
from ssmr_ident.core.nested_domain import Keyed, Listed, Mapped
from ssmr_ident.core.place import Place
from ssmr_ident.core.units import QUANTITY_OF_UNIT, Conversion, find_unit
from ssmr_ident.core.whole_file import read_whole

SHIPPED = Path(__file__).with_name("vocabulary.yaml")
BESIDE = "vocabulary.yaml"
_MOST_BYTES = 2**20
LONGEST = 120  # characters of a header that are looked at; no name is longer
_SECTIONS = ("modifiers", "others", "lengths", "counters", "ignored", "rates", "steps", "units_said", "series", "runs")
_WORDS = Listed(Text(longest=200))
_FORM = Keyed(
    {
        "quantities": (
            Mapped(
                Text(),
                Keyed(
                    {
                        "words": (Mapped(Text(), _WORDS), "by language"),
                        "endings": (_WORDS, "of compounds"),
                        "optional": (YesNo(), "whether it is not asked about"),
                        "unit": (Text(), "of an optional one"),
                    }
                ),
            ),
            "",
        ),
        "symbols": (Mapped(Text(), _WORDS), ""),
        "conventions": (
            Listed(Keyed(dict.fromkeys(("name", "unit", "source"), (Text(), "")), ("name", "unit", "source"))),
            "",
        ),
        "units": (
            Mapped(
                Text(),
                Keyed(
                    {
                        "unit": (Text(), "SI"),
                        "factor": (Number(nonzero=True), "SI of one of it"),
                        "offset": (Number(), "SI of none of it"),
                    },
                    ("unit", "factor"),
                ),
            ),
            "",
        ),
        **dict.fromkeys(_SECTIONS, (_WORDS, "")),
    }
)
_TOKEN = re.compile(r"[^\W\d_]+|\d+|[°%µ#]")
_HUMP = re.compile(r"(?<=[a-zà-öø-ÿ])(?=[A-ZÀ-ÖØ-Þ])|(?<=[A-Z])(?=[A-Z][a-z])")


def words_of(text: str) -> tuple[str, ...]:
    """Words of a header in lower case; camelCase, ``_``, ``.`` and digits separate.

    >>> words_of("FreeAcc_X"), words_of("Station 1 Force")
    (('free', 'acc', 'x'), ('station', '1', 'force'))
    """
    spaced = _HUMP.sub(" ", unicodedata.normalize("NFC", text[:LONGEST]))
    return tuple(token.lower() for token in _TOKEN.findall(spaced))


@dataclass(frozen=True)
class Convention:
    """Names whose unit a published definition fixes."""

    pattern: re.Pattern[str]
    unit: str
    source: str


@dataclass(frozen=True)
class Vocabulary:
    """Words by what they mean.

    Parameters
    ----------
    phrases : dict of tuple of str to str
        Quantity by its words.
    endings : dict of str to str
        Quantity by the end of a compound (``Prüfkraft``).
    optional : dict of str to str
        Quantities that are not asked about, with their SI unit.
    symbols : dict of str to tuple of str
    words : dict of str to frozenset of tuple of str
        By section: modifiers, others, lengths, counters, ignored, rates, steps, units_said, series, runs.
    conventions : tuple of Convention
    units : dict of str to Conversion
        Beyond those of ``core.units``.
    languages : dict of str to dict of str to list of str
        As written, for the page on formats.
    """

    phrases: dict[tuple[str, ...], str]
    endings: dict[str, str]
    optional: dict[str, str]
    symbols: dict[str, tuple[str, ...]]
    words: dict[str, frozenset[tuple[str, ...]]]
    conventions: tuple[Convention, ...]
    units: dict[str, Conversion]
    languages: dict[str, dict[str, list[str]]] = field(default_factory=dict)

    def unit(self, text: str) -> Conversion | None:
        """The way to SI of a unit as written."""
        return self.units.get(text.strip()) or find_unit(text)

    def has(self, section: str, words: tuple[str, ...]) -> bool:
        return words in self.words[section]


def vocabulary_for(folder: Path) -> Vocabulary:
    """The shipped words, and those of ``vocabulary.yaml`` in a log's folder.

    Raises
    ------
    InputError
        The file beside the log is no vocabulary.
    """
    beside = folder / BESIDE
    try:
        stamp = beside.stat().st_mtime_ns
    except (OSError, ValueError):  # ValueError: a NUL in the name
        return shipped()
    return _with(beside, stamp)


@cache
def shipped() -> Vocabulary:
    """The vocabulary of this package."""
    return _made(_content(SHIPPED))


@cache
def _with(beside: Path, stamp: int) -> Vocabulary:
    return _made(_content(SHIPPED), _content(beside))


def _content(path: Path) -> dict[str, Any]:
    try:
        content = yaml.safe_load(read_whole(path, _MOST_BYTES, "Mend it.").decode())
    except (OSError, ValueError, RecursionError, yaml.YAMLError) as error:
        raise InputError(str(path), f"is no vocabulary ({' '.join(str(error).split())[:120]})", "Mend it.") from error
    return _FORM.check(Place(str(path)), content)


def _made(*contents: dict[str, Any]) -> Vocabulary:
    phrases: dict[tuple[str, ...], str] = {}
    endings: dict[str, str] = {}
    optional: dict[str, str] = {}
    languages: dict[str, dict[str, list[str]]] = {}
    symbols: dict[str, tuple[str, ...]] = {}
    sections: dict[str, set[tuple[str, ...]]] = {section: set() for section in _SECTIONS}
    conventions: list[Convention] = []
    units: dict[str, Conversion] = {}
    known = {*QUANTITY_OF_UNIT.values(), "date", "base_acceleration", "base_position", "position_reference"}
    for content in contents:
        entries: dict[str, dict[str, Any]] = dict(content.get("quantities") or {})
        for quantity, entry in entries.items():
            if entry.get("optional") and "unit" in entry:
                optional[quantity] = str(entry["unit"])
            elif quantity not in known:
                raise InputError(
                    "vocabulary.yaml", f"quantity {quantity!r} is not known", did_you_mean(quantity, known)
                )
            for language, names in dict(entry.get("words") or {}).items():
                languages.setdefault(quantity, {}).setdefault(language, []).extend(map(str, names))
                for name in names:
                    phrases[words_of(str(name))] = quantity
            endings |= dict.fromkeys(map(str, entry.get("endings") or ()), str(quantity))
        symbols |= {str(k): tuple(v) for k, v in dict(content.get("symbols") or {}).items()}
        for section in _SECTIONS:
            sections[section] |= {words_of(str(name)) or (str(name),) for name in content.get(section) or ()}
        for entry in content.get("conventions") or ():
            name = re.escape(entry["name"]).replace(r"\{axis\}", "[xyz]").replace(r"\.", "[./]")
            conventions.append(Convention(re.compile(rf"(?:.*[./])?{name}\Z"), entry["unit"], entry["source"]))
        units |= {
            str(k): Conversion(str(v["unit"]), float(v["factor"]), float(v.get("offset", 0.0)))
            for k, v in dict(content.get("units") or {}).items()
        }
    frozen = {section: frozenset(names) for section, names in sections.items()}
    return Vocabulary(phrases, endings, optional, symbols, frozen, tuple(conventions), units, languages)
