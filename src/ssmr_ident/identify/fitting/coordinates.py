"""What a fit may move: physical parameters with their priors, and parameters of effects within their bounds."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from functools import cached_property

import numpy as np

from ssmr_ident.core.parameter import Parameter
from ssmr_ident.core.recent import Recent
from ssmr_ident.identify.posterior.objective import Unknown
from ssmr_ident.physics.effects import CATALOGUE
from ssmr_ident.physics.rig import RIG_KEYS

Array = np.ndarray
Split = tuple[dict[str, float], dict[str, dict[str, float]]]


@dataclass(frozen=True)
class EffectCoordinate:
    """One free parameter of an effect.

    Parameters
    ----------
    effect : str
    parameter : Parameter
    unknown : Unknown
        Its coordinate: the logarithm for what is positive, so that half and double are equally far; else the value
        itself in units of a natural size.
    """

    effect: str
    parameter: Parameter
    unknown: Unknown

    def value(self, scaled: float) -> float:
        value = self.unknown.value(scaled)
        if not math.isfinite(value):
            return value
        return float(min(max(value, self.parameter.lower), min(self.parameter.upper, 1e300)))


@dataclass(frozen=True)
class Model:
    """A baseline with the effects that are active in it.

    Parameters
    ----------
    physics : tuple of Unknown
    free : tuple of EffectCoordinate
    held : mapping of effect id to mapping of parameter to value
        Parameters of active effects that are not fitted.
    """

    physics: tuple[Unknown, ...]
    free: tuple[EffectCoordinate, ...] = ()
    held: Mapping[str, Mapping[str, float]] = field(default_factory=dict)

    @property
    def unknowns(self) -> tuple[Unknown, ...]:
        return (*self.physics, *(coordinate.unknown for coordinate in self.free))

    @property
    def on_rig(self) -> bool:
        """Whether it is one mass on a spring, and no robot."""
        return not {keys[-1] for keys in RIG_KEYS.values()}.isdisjoint(unknown.name for unknown in self.unknowns)

    @property
    def ids(self) -> tuple[str, ...]:
        return tuple(self.held)

    def split(self, point: Array) -> Split:
        """Physical values and effects at a point of scaled coordinates, not to be changed: whoever asks again (two of
        three times) has the same objects, and what has been worked out of them."""
        return self._splits.of(point.tobytes(), lambda: self._split(point))

    @cached_property
    def _splits(self) -> Recent[Split]:
        return Recent()

    def _split(self, point: Array) -> Split:
        count = len(self.physics)
        scaled = point.tolist()  # Python's own floats, which are several times quicker one by one
        values = {u.name: u.value(s) for u, s in zip(self.physics, scaled[:count], strict=True)}
        effects = {name: dict(fixed) for name, fixed in self.held.items()}
        for coordinate, s in zip(self.free, scaled[count:], strict=True):
            effects[coordinate.effect][coordinate.parameter.name] = coordinate.value(s)
        return values, effects

    def as_known(self, point: Array) -> Array:
        """A point with the physics as the file says, and the effects as they are."""
        return np.concatenate([np.zeros(len(self.physics)), point[len(self.physics) :]])

    def with_one(self, at: Split, column: int, scaled: float) -> Split:
        """What ``split`` gives where one coordinate is another; the rest is shared."""
        values, effects = at
        if column < len(self.physics):
            unknown = self.physics[column]
            return {**values, unknown.name: unknown.value(scaled)}, effects
        free = self.free[column - len(self.physics)]
        return values, {**effects, free.effect: {**effects[free.effect], free.parameter.name: free.value(scaled)}}

    def steps(self) -> Array:
        """Steps of one-sided differences, in scaled coordinates."""
        return np.array([min(1e-2, 1e-3 / u.spread) if u.logarithmic else 1e-2 for u in self.unknowns])

    def with_effect(
        self,
        effect_id: str,
        at: Mapping[str, float],
        scales: Mapping[str, float],
        limits: Mapping[str, tuple[float, float]] | None = None,
    ) -> tuple[Model, Array]:
        """A model with one effect more, and where its new coordinates begin.

        Parameters
        ----------
        effect_id : str
        at : mapping of parameter to value
            Where the fit begins; parameters left out are not fitted: they stay at their nominal value, or off where
            others switch the effect on.
        scales : mapping of parameter to float
            Natural sizes of the parameters that may change sign.
        limits : mapping of parameter to (float, float), optional
            Narrower bounds than the parameter's own.
        """
        effect = CATALOGUE[effect_id]
        free, begin = [], []
        held = {name: value for name, value in effect.begun(at).items() if name not in at}
        for parameter in effect.parameters:
            if parameter.name not in at:
                continue
            value = float(at[parameter.name])
            signed = parameter.lower < 0.0
            size = scales.get(parameter.name) or abs(value) or 1.0
            name = f"{effect_id}.{parameter.name}"
            unknown = (
                Unknown(name, parameter.unit, 0.0, 3.0 * size, positive=False)
                if signed
                else Unknown(name, parameter.unit, value, None)
            )
            low, high = (limits or {}).get(parameter.name, (parameter.lower, parameter.upper))
            within = replace(parameter, lower=max(low, parameter.lower), upper=min(high, parameter.upper))
            free.append(EffectCoordinate(effect_id, within, unknown))
            begin.append(unknown.scaled(value))
        model = replace(self, free=(*self.free, *free), held={**self.held, effect_id: held})
        return model, np.array(begin)

    def without_effect(self, effect_id: str) -> tuple[Model, Array]:
        """The model without one of its effects, and which of the coordinates stay, (n,) bool."""
        keep = [True] * len(self.physics) + [c.effect != effect_id for c in self.free]
        held = {name: fixed for name, fixed in self.held.items() if name != effect_id}
        return replace(self, free=tuple(c for c in self.free if c.effect != effect_id), held=held), np.array(keep)
