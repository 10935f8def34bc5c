"""The posterior as a sum of squares: unknowns with priors, small results, and recordings fitted by their samples."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Protocol

import numpy as np

from ssmr_ident.identify.body.output_error import System

Array = np.ndarray

WIDE = 1.5
"""Standard deviation of the logarithm where a file gives no std: a factor of 4.5 either way."""


@dataclass(frozen=True)
class Unknown:
    """A parameter to be fitted.

    Parameters
    ----------
    name : str
        Key of the parameter file, or of a part of one (``height_m``).
    unit : str
    prior : float
    prior_std : float or None
        None: unknown, taken as ``WIDE`` in the logarithm.
    positive : bool
        Fitted as its logarithm, so that half and double are equally far and nothing ends at 0.
    reach : float
        Prior standard deviations beyond which the value does not go, however far its coordinate does: what is further
        off is no matter of an uncertain number, but has a name of its own.
    """

    name: str
    unit: str
    prior: float
    prior_std: float | None
    positive: bool = True
    reach: float = math.inf

    @cached_property
    def logarithmic(self) -> bool:
        return self.positive and self.prior > 0

    @cached_property
    def spread(self) -> float:
        """Prior standard deviation of the fitted quantity."""
        if self.prior_std is None:
            return WIDE if self.logarithmic else max(abs(self.prior), 1.0) * 10
        return self.prior_std / self.prior if self.logarithmic else self.prior_std

    def value(self, scaled: float) -> float:
        """From the scaled coordinate (0 at the prior, 1 at one standard deviation)."""
        within = scaled * self._bent(scaled)
        if self.logarithmic:
            return self.prior * math.exp(min(max(within * self.spread, -12.0), 12.0))
        return self.prior + within * self.spread

    def _bent(self, scaled: float) -> float:
        """Share of a coordinate that is gone: 1 about the prior, less towards the end of its reach."""
        return 1.0 if self.reach == math.inf else (1.0 + (scaled / self.reach) ** 4) ** -0.25

    @property
    def prior_spread(self) -> float:
        """Prior standard deviation of the value itself."""
        return self.spread * (self.prior if self.logarithmic else 1.0)

    def slope(self, scaled: float) -> float:
        """Derivative of the value by the scaled coordinate."""
        return self.spread * (self.value(scaled) if self.logarithmic else 1.0) * self._bent(scaled) ** 5

    def scaled(self, value: float) -> float:
        """Back from a value to the scaled coordinate."""
        within = (math.log(value / self.prior) if self.logarithmic else value - self.prior) / self.spread
        result: float = within / max(1.0 - (within / self.reach) ** 4, 1e-8) ** 0.25
        return result

    def std(self, scaled: float, scaled_std: float) -> float:
        return scaled_std * self.slope(scaled)


@dataclass(frozen=True)
class Observation:
    """A small result that the parameters must explain.

    Parameters
    ----------
    name : str
    labels : tuple of str
        One per number.
    values : (k,) float
    covariance : (k, k) float
    predict : callable
        From a mapping of parameter names to values, the (k,) numbers it should have been.
    """

    name: str
    labels: tuple[str, ...]
    values: Array
    covariance: Array
    predict: Callable[[Mapping[str, float]], Array]


class Samples(Protocol):
    """Recordings whose samples are fitted directly, their nuisances eliminated inside."""

    def cost(self, values: Mapping[str, float]) -> float: ...

    def system(self, values: Mapping[str, float], moves: Mapping[str, float], correlated: bool = False) -> System: ...


SMALL_MOVE = 1e-4
"""Step of central differences, in prior standard deviations."""


class Objective:
    """Twice the negative logarithm of the posterior over scaled coordinates (0 at the prior, 1 one std away)."""

    def __init__(
        self, unknowns: Sequence[Unknown], observations: Sequence[Observation], samples: Sequence[Samples]
    ) -> None:
        self.unknowns, self.observations, self.samples = unknowns, observations, samples
        self.whiteners = [np.linalg.inv(np.linalg.cholesky(o.covariance)) for o in observations]

    def values(self, scaled: Array) -> dict[str, float]:
        return {u.name: u.value(s) for u, s in zip(self.unknowns, scaled, strict=True)}

    def residual(self, scaled: Array) -> Array:
        """Of the observations."""
        values = self.values(scaled)
        parts = [w @ (o.values - o.predict(values)) for o, w in zip(self.observations, self.whiteners, strict=True)]
        return np.concatenate(parts) if parts else np.zeros(0)

    def cost(self, scaled: Array) -> float:
        residual = self.residual(scaled)
        values = self.values(scaled)
        return float(residual @ residual + scaled @ scaled) + sum(s.cost(values) for s in self.samples)

    def slopes(self, scaled: Array) -> Array:
        """Derivatives of the observations' residual, (k, n)."""
        columns = []
        for index in range(len(scaled)):
            move = np.zeros(len(scaled))
            move[index] = SMALL_MOVE
            columns.append((self.residual(scaled + move) - self.residual(scaled - move)) / (2 * SMALL_MOVE))
        return np.column_stack(columns)

    def sampled(self, scaled: Array, correlated: bool = False) -> tuple[list[System], Array, Array, Array]:
        """Systems of the samples; gradient, information and meat in scaled coordinates."""
        chain = np.array([u.slope(s) for u, s in zip(self.unknowns, scaled, strict=True)])
        moves = {u.name: SMALL_MOVE * abs(c) for u, c in zip(self.unknowns, chain, strict=True)}
        systems = [s.system(self.values(scaled), moves, correlated) for s in self.samples]
        size = len(scaled)
        gradient, information, meat = np.zeros(size), np.zeros((size, size)), np.zeros((size, size))
        for system in systems:
            gradient += chain * system.gradient
            information += np.outer(chain, chain) * system.information
            meat += np.outer(chain, chain) * system.meat
        return systems, gradient, information, meat
