"""Parameters: declared once (Parameter), known with an uncertainty (Estimate), kept together (ParameterSet)."""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass, field, replace
from typing import TYPE_CHECKING, Any

import numpy as np

from ssmr_ident.core.frame import frame
from ssmr_ident.core.shown import Shown, html_table

if TYPE_CHECKING:
    import pandas as pd

Value = float | np.ndarray

FITTED = "fit of the recordings"
"""Source of what recordings tell."""

GROUND = "ground"
"""What a spring of a network may join a body to: it does not move."""


@dataclass(frozen=True)
class Parameter:
    """Declaration of a scalar parameter: its key, unit, usual value and physical bounds.

    ``off`` is the value at which an effect of this parameter vanishes; None for what cannot be switched off.
    """

    name: str
    unit: str
    nominal: float
    lower: float = -math.inf
    upper: float = math.inf
    meaning: str = ""
    off: float | None = None


@dataclass(frozen=True)
class Estimate(Shown):
    """What is known of a parameter.

    Parameters
    ----------
    value : float or ndarray
        In ``unit``.
    std : float or None
        Standard deviation, in ``unit``; None means unknown (a wide prior).
    unit : str
    source : str
        Who says so: a test, a data sheet, a fit.
    fixed : bool
        True: a fit leaves it alone.
    at_bound : bool
        True when a fit ended on a bound, so that ``std`` says little.
    """

    value: Value
    std: float | None = None
    unit: str = "1"
    source: str = ""
    fixed: bool = False
    at_bound: bool = False

    def __str__(self) -> str:
        spread = "" if self.std is None else f" ± {self.std:.2g}"
        value = f"{self.value:.6g}" if isinstance(self.value, float) else np.array2string(np.asarray(self.value))
        return f"{value}{spread} {self.unit}".rstrip()


@dataclass(frozen=True)
class ParameterSet(Shown, Mapping[str, Estimate]):
    """Estimates by dotted path (``tire.stiffness_y_N_m``), as robot.yaml and exported parameters hold them.

    ``choices`` are the keys whose value is a word (``tire.contact``). ``effects`` maps an effect's id, on a network by
    ``at_element``, to its parameters; ``provenance`` is free text and numbers about the origin. Of a network
    ``between`` has the two that each spring joins, bodies or ``GROUND``, by its name.
    """

    name: str
    estimates: Mapping[str, Estimate]
    effects: Mapping[str, Mapping[str, Estimate]] = field(default_factory=dict)
    provenance: Mapping[str, Any] = field(default_factory=dict)
    file: str = ""
    choices: Mapping[str, str] = field(default_factory=dict)
    between: Mapping[str, tuple[str, str]] = field(default_factory=dict)

    def __getitem__(self, path: str) -> Estimate:
        return self.estimates[path]

    def __iter__(self) -> Iterator[str]:
        return iter(self.estimates)

    def __len__(self) -> int:
        return len(self.estimates)

    def number(self, path: str, default: float | None = None) -> float:
        """Value of a scalar; ``default`` where the file has none."""
        if path in self.estimates:
            return float(self.estimates[path].value)
        if default is None:
            raise KeyError(path)
        return default

    @property
    def rotary(self) -> bool:
        """Whether it is of a rotary rig, or of a network of inertias."""
        return turns(self.estimates)

    def updated(self, changes: Mapping[str, Estimate], **fields: Any) -> ParameterSet:
        """A copy with some estimates replaced or added."""
        return replace(self, estimates={**self.estimates, **changes}, **fields)

    def to_frame(self) -> pd.DataFrame:
        """A row a number, by its path: ``value``, ``std`` (or NaN), ``unit``, ``source``, ``fixed``, ``at_bound``.

        Parts of an array are ``path[0]``, ``path[0,1]``; parameters of effects are ``effects.ID.NAME``.
        """
        named = [*self.estimates.items()]
        named += [(f"effects.{id}.{key}", e) for id, block in self.effects.items() for key, e in block.items()]
        rows = [
            {"parameter": path + place, "value": value, "std": math.nan if e.std is None else e.std, "unit": e.unit,
             "source": e.source, "fixed": e.fixed, "at_bound": e.at_bound}
            for path, e in named
            for place, value in _parts(e.value)
        ]  # fmt: skip
        columns = ("parameter", "value", "std", "unit", "source", "fixed", "at_bound")
        return frame(rows, columns, "parameter", name=self.name)

    def _repr_html_(self) -> str:
        rows = [(path, str(e), e.source + (", fixed" if e.fixed else "")) for path, e in self.estimates.items()]
        rows += [(path, word, "") for path, word in self.choices.items()]
        rows += [(f"{id}: {key}", str(e), e.source) for id, block in self.effects.items() for key, e in block.items()]
        return html_table(("parameter", "value", "source"), rows, f"parameters of {self.name}")

    def __str__(self) -> str:
        width = max((len(path) for path in self.estimates), default=0)
        lines = [f"parameters of {self.name}"]
        lines += [f"  {path:<{width}}  {estimate}" for path, estimate in self.estimates.items()]
        lines += [f"  {path:<{width}}  {word}" for path, word in self.choices.items()]
        for effect, parameters in self.effects.items():
            lines += [f"  {effect}: {key} = {estimate}" for key, estimate in parameters.items()]
        return "\n".join(lines)


def turns(paths: Iterable[str]) -> bool:
    """Whether parameters are those of something that turns about one axis."""
    return any(path.endswith("inertia_kg_m2") for path in paths)


def at_element(effect: str, element: str) -> str:
    """The key of an effect that acts at one spring of a network, among those of a parameter set.

    >>> at_element("dry_friction", "blade"), at_element("dry_friction", "")
    ('dry_friction@blade', 'dry_friction')
    """
    return f"{effect}@{element}" if element else effect


def effect_and_element(key: str) -> tuple[str, str]:
    """The effect and the spring of such a key; the latter is empty where there is but one."""
    effect, _, element = key.partition("@")
    return effect, element


def _parts(value: Value) -> list[tuple[str, float]]:
    """Numbers of a value with their place in it, empty for one that is a number."""
    array = np.asarray(value, dtype=float)
    return [(f"[{','.join(map(str, at))}]" if at else "", float(array[at])) for at in np.ndindex(array.shape)]
