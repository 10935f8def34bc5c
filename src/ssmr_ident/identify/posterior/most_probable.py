"""Parameters from many small results: maximum a posteriori with the user's own knowledge as prior.

Each observation (the modes of a motion, the slope of a ramp) predicts itself from the parameters; Gauss-Newton
finds the most probable parameters, and its curvature their uncertainty. What the data do not inform keeps its
prior, and says so.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field

import numpy as np
from scipy.stats import chi2

from ssmr_ident.core.shown import Shown
from ssmr_ident.identify.body.output_error import System
from ssmr_ident.identify.posterior.identifiability import flat_directions
from ssmr_ident.identify.posterior.objective import Objective, Observation, Samples, Unknown

Array = np.ndarray

__all__ = ["Observation", "Posterior", "Samples", "Unknown", "most_probable"]


@dataclass(frozen=True)
class Posterior(Shown):
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
    objective = Objective(unknowns, observations, samples)
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


def _summary(objective: Objective, point: Array, converged: bool) -> Posterior:
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
