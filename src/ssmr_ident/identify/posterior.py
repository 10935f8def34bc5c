"""Parameters from many small results: maximum a posteriori with the user's own knowledge as prior.

Each observation (the modes of a motion, the slope of a ramp) predicts itself from the parameters; Gauss-Newton
finds the most probable parameters, and its curvature their uncertainty. What the data do not inform keeps its
prior, and says so.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Protocol

import numpy as np
from scipy.stats import chi2

from ssmr_ident.identify.flatness import flat_directions
from ssmr_ident.identify.output_error import System

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
    """

    name: str
    unit: str
    prior: float
    prior_std: float | None
    positive: bool = True

    @property
    def logarithmic(self) -> bool:
        return self.positive and self.prior > 0

    @property
    def spread(self) -> float:
        """Prior standard deviation of the fitted quantity."""
        if self.prior_std is None:
            return WIDE if self.logarithmic else max(abs(self.prior), 1.0) * 10
        return self.prior_std / self.prior if self.logarithmic else self.prior_std

    def value(self, scaled: float) -> float:
        """From the scaled coordinate (0 at the prior, 1 at one standard deviation)."""
        if self.logarithmic:
            return self.prior * math.exp(np.clip(scaled * self.spread, -12, 12))
        return self.prior + scaled * self.spread

    @property
    def prior_spread(self) -> float:
        """Prior standard deviation of the value itself."""
        return self.spread * (self.prior if self.logarithmic else 1.0)

    def slope(self, scaled: float) -> float:
        """Derivative of the value by the scaled coordinate."""
        return self.spread * (self.value(scaled) if self.logarithmic else 1.0)

    def scaled(self, value: float) -> float:
        """Back from a value to the scaled coordinate."""
        return (math.log(value / self.prior) if self.logarithmic else value - self.prior) / self.spread

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


@dataclass(frozen=True)
class Posterior:
    """Most probable parameters and what is known of them afterwards.

    Parameters
    ----------
    unknowns : tuple of Unknown
    values, stds : (n,) float
    correlations : (n, n) float
    information_share : (n,) float
        1 − (posterior/prior std)²: 0 where the data say nothing, 1 where they say everything.
    pulls : (n,) float
        (fitted − prior)/prior std.
    misfits : dict of str to float
        Per observed number: (measured − predicted)/std.
    flat : tuple of tuple of (str, float)
        Directions that the data leave as the prior had them, as shares of prior standard deviations.
    chi_square : float
        Of the observations.
    excess : float
        Factor by which the observations' standard deviations were widened, because they differ from what the
        best parameters predict by more than their own uncertainty (p below 1 in 1000); 1 where they do not.
    converged : bool
    systems : tuple of System
        Of the samples that were fitted directly, at the optimum.
    sandwich : (n,) float
        Factor by which residuals that are correlated in time widened each standard deviation; 1 where they are white.
    """

    unknowns: tuple[Unknown, ...]
    values: Array
    stds: Array
    correlations: Array
    information_share: Array
    pulls: Array
    misfits: dict[str, float]
    flat: tuple[tuple[tuple[str, float], ...], ...]
    chi_square: float
    excess: float
    converged: bool
    systems: tuple[System, ...] = ()
    sandwich: Array = field(default_factory=lambda: np.ones(0))

    def __getitem__(self, name: str) -> tuple[float, float]:
        """Value and standard deviation."""
        index = [unknown.name for unknown in self.unknowns].index(name)
        return float(self.values[index]), float(self.stds[index])

    def __str__(self) -> str:
        lines = ["[[Variables]]"]
        for index, unknown in enumerate(self.unknowns):
            source = "prior" if self.information_share[index] < 0.19 else "data"
            lines.append(
                f"    {unknown.name}: {self.values[index]:.6g} +/- {self.stds[index]:.2g} {unknown.unit} "
                f"(prior {unknown.prior:.6g}, {source})"
            )
        return "\n".join(lines)


class Samples(Protocol):
    """Recordings whose samples are fitted directly, their nuisances eliminated inside."""

    def cost(self, values: Mapping[str, float]) -> float: ...

    def system(self, values: Mapping[str, float], moves: Mapping[str, float], correlated: bool = False) -> System: ...


SMALL_MOVE = 1e-4
"""Step of central differences, in prior standard deviations."""


class _Objective:
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


def most_probable(
    unknowns: Sequence[Unknown],
    observations: Sequence[Observation],
    samples: Sequence[Samples] = (),
    start: Mapping[str, float] | None = None,
    max_iterations: int = 300,
) -> Posterior:
    """Maximum a posteriori by damped Gauss-Newton.

    Parameters
    ----------
    unknowns : sequence of Unknown
    observations : sequence of Observation
    samples : sequence of Samples
        Fitted beside the observations.
    start : mapping of str to float, optional
        Values to begin at; the prior for those left out.
    max_iterations : int

    Returns
    -------
    Posterior

    Notes
    -----
    A residual that is correlated in time although the noise was whitened belongs to a model that misses something.
    Standard deviations are then those of a sandwich where that is wider (White 1982, Newey and West 1987).
    """
    count = len(unknowns)
    objective = _Objective(unknowns, observations, samples)
    point = np.array([u.scaled(start[u.name]) if start and u.name in start else 0.0 for u in unknowns])
    current = objective.cost(point)
    damping, converged = 1e-3, False
    # A thousandth of a unit of chi-square moves no parameter by a twentieth of its standard deviation.
    enough = 1e-3 if samples else 1e-8 * max(1.0, current)
    for _ in range(max_iterations):
        residual, slope = objective.residual(point), objective.slopes(point)
        _, own_gradient, own_information, _ = objective.sampled(point)
        gradient = slope.T @ residual + point + own_gradient
        curvature = slope.T @ slope + np.eye(count) + own_information
        tried, step = np.inf, np.zeros(count)
        while damping < 1e10:
            step = -np.linalg.solve(curvature + damping * np.diag(np.diag(curvature)), gradient)
            tried = objective.cost(point + step)
            if np.isfinite(tried) and tried <= current:
                break
            damping = max(damping, 1e-6) * 10
        else:
            break
        gain = current - tried
        point, current, damping = point + step, tried, damping / 10
        if gain < enough:
            converged = True
            break
    return _summary(objective, point, converged)


def _summary(objective: _Objective, point: Array, converged: bool) -> Posterior:
    unknowns, observations = objective.unknowns, objective.observations
    count = len(unknowns)
    residual, slope = objective.residual(point), objective.slopes(point)
    systems, _, information, meat = objective.sampled(point)
    structure = bool(systems) and min(system.whiteness_p for system in systems) < 1e-3
    if structure:
        systems, _, information, meat = objective.sampled(point, correlated=True)
    values = objective.values(point)
    misfits = {}
    for observation in observations:
        difference = observation.values - observation.predict(values)
        for label, miss, variance in zip(observation.labels, difference, np.diag(observation.covariance), strict=True):
            misfits[f"{observation.name}: {label}"] = float(miss / math.sqrt(variance))
    covariance = np.linalg.inv(slope.T @ slope + np.eye(count) + information)
    share = 1.0 - np.clip(np.diag(covariance), 0, 1)
    chi_square = float(residual @ residual)
    # Samples use up parameters as well, but they are so many that the observations' own degrees of freedom count.
    freedom = max(len(residual) - float(share.sum()) * (not systems), 1.0)
    wrong = len(residual) > 0 and chi2.sf(chi_square, freedom) < 1e-3
    excess = math.sqrt(chi_square / freedom) if wrong else 1.0
    # Observations that contradict each other know less than they say; the prior stays what it was.
    weighted = slope.T @ slope / excess**2
    covariance = np.linalg.inv(weighted + np.eye(count) + information)
    sandwich = np.ones(count)
    if structure:
        wide = covariance @ (weighted + np.eye(count) + meat) @ covariance
        sandwich = np.sqrt(np.maximum(np.diag(wide) / np.diag(covariance), 1.0))
        covariance = covariance * np.outer(sandwich, sandwich)
    # Far from any optimum rounding can leave a variance below 0.
    scaled_stds = np.sqrt(np.maximum(np.diag(covariance), 1e-24))
    return Posterior(
        unknowns=tuple(unknowns),
        values=np.array(list(values.values())),
        stds=np.array([u.std(s, d) for u, s, d in zip(unknowns, point, scaled_stds, strict=True)]),
        correlations=covariance / np.outer(scaled_stds, scaled_stds),
        information_share=1.0 - np.clip(scaled_stds, 0, 1) ** 2,
        pulls=np.array([(v - u.prior) / u.prior_spread for u, v in zip(unknowns, values.values(), strict=True)]),
        misfits=misfits,
        flat=flat_directions([u.name for u in unknowns], slope.T @ slope + information),
        chi_square=chi_square,
        excess=excess,
        converged=converged,
        systems=tuple(systems),
        sandwich=sandwich,
    )
