"""A parameter as a fit moves it."""

from __future__ import annotations

import math
from dataclasses import dataclass


@dataclass(frozen=True)
class Coordinate:
    """A parameter as the fit moves it.

    Parameters
    ----------
    name : str
    scale : float
        What one unit of the coordinate is; of a logarithm, the value at 0.
    log : bool
    lower, upper : float
        Of the value.
    mean, std : float
        Prior in coordinates.
    unit : str
    """

    name: str
    scale: float
    log: bool = False
    lower: float = -math.inf
    upper: float = math.inf
    mean: float = 0.0
    std: float = math.inf
    unit: str = ""

    def value(self, at: float) -> float:
        value = self.scale * (math.exp(min(at, 200.0)) if self.log else at)
        return min(max(value, self.lower), self.upper)

    def at(self, value: float) -> float:
        value = min(max(value, self.lower), self.upper)
        return math.log(value / self.scale) if self.log else value / self.scale

    def slope(self, at: float) -> float:
        """d value / d coordinate."""
        return self.scale * (math.exp(min(at, 200.0)) if self.log else 1.0)
