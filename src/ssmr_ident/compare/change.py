"""Two parameter sets side by side: what has changed, by how much, and whether that is more than their uncertainty."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field, replace
from typing import TYPE_CHECKING, Any

import numpy as np
from scipy.stats import norm

from ssmr_ident.core.errors import InputError
from ssmr_ident.core.frame import frame
from ssmr_ident.core.parameter import Estimate, ParameterSet
from ssmr_ident.core.shown import Shown

if TYPE_CHECKING:
    import pandas as pd

COLUMNS = ("parameter", "unit", "first", "first_std", "second", "second_std", "difference", "p_value", "changed")
CHANCE = 0.05
"""Probability that among all parameters that have not changed a single one is said to have."""


@dataclass(frozen=True)
class Change:
    """One number of two sets.

    Parameters
    ----------
    parameter, unit : str
        ``effects.ID.NAME`` for that of an effect.
    first, second : float or None
        None where a set lacks it.
    first_std, second_std : float or None
    p_value : float
        Probability of a difference as large without a change (two-sided normal, both sets taken as independent); NaN
        where no standard deviation is known.
    changed : bool
        Whether that is beyond chance among all the parameters compared (Holm 1979), or, of what is held fixed in both,
        whether the numbers differ.
    """

    parameter: str
    unit: str
    first: float | None
    second: float | None
    first_std: float | None
    second_std: float | None
    p_value: float
    changed: bool

    @property
    def difference(self) -> float:
        """Second less first, in ``unit``; NaN where one is missing."""
        return math.nan if self.first is None or self.second is None else self.second - self.first

    @property
    def std(self) -> float:
        """Of the difference; NaN where none is known."""
        known = [s for s in (self.first_std, self.second_std) if s is not None]
        return math.hypot(*known) if known else math.nan

    @property
    def relative(self) -> float:
        """Difference over the first value's size; NaN where that is 0."""
        return self.difference / abs(self.first) if self.first else math.nan


@dataclass(frozen=True)
class Side:
    """One of the two: its name, its parameters, and what a diagnosis said, where there is one.

    ``error`` is that on recordings never fitted: before, after, noise floor, in ``metric``; ``curves`` are those of
    the effects that have one, by their ids, as diagnosis.yaml has them.
    """

    name: str
    parameters: ParameterSet
    verdict: str = ""
    effects: tuple[str, ...] = ()
    metric: str = ""
    error: tuple[float, float, float] | None = None
    curves: Mapping[str, Mapping[str, Any]] = field(default_factory=dict)


@dataclass(frozen=True)
class Changes(Shown):
    """Two sides and their changes, those first that are more than chance, largest first."""

    first: Side
    second: Side
    changes: tuple[Change, ...]

    @property
    def changed(self) -> tuple[Change, ...]:
        return tuple(c for c in self.changes if c.changed)

    def to_frame(self) -> pd.DataFrame:
        """A row a parameter: ``first``, ``second``, their ``std``, ``difference``, ``p_value``, ``changed``."""
        columns = (
            "parameter",
            "unit",
            "first",
            "first_std",
            "second",
            "second_std",
            "difference",
            "p_value",
            "changed",
        )
        return frame([{**_plain(c)} for c in self.changes], columns, "parameter")

    def as_dict(self) -> dict[str, Any]:
        """For ``--json``."""
        return {"first": _side(self.first), "second": _side(self.second),
                "changes": [_plain(c) for c in self.changes]}  # fmt: skip

    def __str__(self) -> str:
        lines = [f"{self.first.name} against {self.second.name}"]
        for label, side in (("first", self.first), ("second", self.second)):
            if side.verdict:
                named = f": {', '.join(side.effects)}" if side.effects else ""
                lines.append(f"  {label}: {side.verdict.replace('_', ' ')}{named}")
        width = max((len(c.parameter) for c in self.changes), default=0)
        for c in self.changes:
            percent = "" if math.isnan(c.relative) else f"  {100 * c.relative:+.3g} %"
            mark = "changed" if c.changed else "same within its uncertainty" if c.p_value == c.p_value else ""
            if c.first is None or c.second is None:
                mark = "second only" if c.first is None else "first only"
            line = (
                f"  {c.parameter:<{width}}  {_text(c.first, c.first_std)} -> {_text(c.second, c.second_std)} {c.unit}"
            )
            lines.append(f"{line}{percent}  {mark}".rstrip())
        return "\n".join(lines)


def changes(first: Side, second: Side) -> Changes:
    """Compare two sides, number by number.

    Parameters
    ----------
    first, second : Side

    Raises
    ------
    InputError
        A parameter has another unit in the other set, or they share none.
    """
    one, other = dict(_numbers(first.parameters)), dict(_numbers(second.parameters))
    if not one.keys() & other.keys():
        raise InputError(f"{first.name}, {second.name}", "share no parameter", "Compare two of one robot or rig")
    found = []
    for name in dict.fromkeys((*one, *other)):
        a, b = one.get(name), other.get(name)
        if a and b and a.unit != b.unit:
            raise InputError(second.name, f"{name} is in {b.unit}, in {first.name} in {a.unit}", "Give both one unit")
        found.append(_change(name, a, b))
    told = _beyond_chance(found)
    ranked = sorted(told, key=lambda c: (not c.changed, c.p_value if c.p_value == c.p_value else 2.0))
    return Changes(first, second, tuple(ranked))


def _change(name: str, a: Estimate | None, b: Estimate | None) -> Change:
    some = a or b
    assert some is not None
    first, second = (None if e is None else float(e.value) for e in (a, b))
    first_std, second_std = (None if e is None or e.fixed else e.std for e in (a, b))
    made = Change(name, some.unit, first, second, first_std, second_std, math.nan, changed=False)
    if a and b and made.std > 0:
        return replace(made, p_value=float(2.0 * norm.sf(abs(made.difference) / made.std)))
    return replace(made, changed=bool(a and b and a.fixed and b.fixed and first != second))


def _beyond_chance(found: list[Change]) -> list[Change]:
    """Holm's step-down: the smallest p-value times the count of all, the next times one less, until one is large."""
    tested = sorted((c for c in found if c.p_value == c.p_value), key=lambda c: c.p_value)
    small: set[str] = set()
    for rank, c in enumerate(tested):
        if c.p_value * (len(tested) - rank) > CHANCE:
            break
        small.add(c.parameter)
    return [replace(c, changed=c.changed or c.parameter in small) for c in found]


def _numbers(parameters: ParameterSet) -> Iterator[tuple[str, Estimate]]:
    """Scalars, those of effects by ``effects.ID.NAME``, and parts of an array that has one standard deviation."""
    named = [*parameters.items()]
    named += [(f"effects.{id}.{key}", e) for id, block in parameters.effects.items() for key, e in block.items()]
    for name, estimate in named:
        value = np.asarray(estimate.value, float)
        for at in np.ndindex(value.shape):
            place = f"[{','.join(map(str, at))}]" if at else ""
            std = estimate.std if estimate.std is None or np.ndim(estimate.std) == 0 else None
            yield f"{name}{place}", Estimate(float(value[at]), std, estimate.unit, fixed=estimate.fixed)


def _text(value: float | None, std: float | None) -> str:
    if value is None:
        return "none"
    return f"{value:.5g}" + ("" if std is None else f" ± {std:.2g}")


def _plain(c: Change) -> dict[str, Any]:
    return {name: getattr(c, name) for name in COLUMNS}


def _side(side: Side) -> Mapping[str, Any]:
    error = dict(zip(("before", "after", "noise_floor"), side.error, strict=True)) if side.error else None
    return {"name": side.name, "verdict": side.verdict, "effects": list(side.effects), "error": error,
            "metric": side.metric}  # fmt: skip
