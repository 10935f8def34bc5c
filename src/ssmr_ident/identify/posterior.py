"""Parameters from many small results: maximum a posteriori with the user's own knowledge as prior.

Each observation (the modes of a motion, the slope of a ramp) predicts itself from the parameters; Gauss-Newton
finds the most probable parameters, and its curvature their uncertainty. What the data do not inform keeps its
prior, and says so.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from scipy.stats import chi2

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

    def std(self, scaled: float, scaled_std: float) -> float:
        return scaled_std * self.spread * (self.value(scaled) if self.logarithmic else 1.0)


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
    unknowns: Sequence[Unknown], observations: Sequence[Observation], max_iterations: int = 300
) -> Posterior:
    """Maximum a posteriori by damped Gauss-Newton from the prior.

    Parameters
    ----------
    unknowns : sequence of Unknown
    observations : sequence of Observation
    max_iterations : int

    Returns
    -------
    Posterior
    """
    count = len(unknowns)
    whiteners = [np.linalg.inv(np.linalg.cholesky(observation.covariance)) for observation in observations]

    def residual(scaled: Array) -> Array:
        values = {u.name: u.value(s) for u, s in zip(unknowns, scaled, strict=True)}
        parts = [
            whitener @ (observation.values - observation.predict(values))
            for observation, whitener in zip(observations, whiteners, strict=True)
        ]
        return np.concatenate([*parts, -scaled])

    def jacobian(scaled: Array) -> Array:
        columns = []
        for index in range(count):
            move = np.zeros(count)
            move[index] = 1e-4
            columns.append((residual(scaled + move) - residual(scaled - move)) / 2e-4)
        return np.column_stack(columns)

    point = np.zeros(count)
    current = residual(point)
    damping, converged = 1e-3, False
    for _ in range(max_iterations):
        slope = jacobian(point)
        gradient, curvature = slope.T @ current, slope.T @ slope
        accepted = False
        while damping < 1e10:
            step = -np.linalg.solve(curvature + damping * np.diag(np.diag(curvature)), gradient)
            tried = residual(point + step)
            if np.all(np.isfinite(tried)) and tried @ tried <= current @ current:
                accepted = True
                break
            damping = max(damping, 1e-6) * 10
        if not accepted:
            break
        gain = float(current @ current - tried @ tried)
        point, current, damping = point + step, tried, damping / 10
        if gain < 1e-8 * max(1.0, float(current @ current)):
            converged = True
            break
    slope = jacobian(point)
    covariance = np.linalg.inv(slope.T @ slope)
    scaled_stds = np.sqrt(np.diag(covariance))
    data = slope[: len(current) - count]
    misfits, at = {}, 0
    values = {u.name: u.value(s) for u, s in zip(unknowns, point, strict=True)}
    for observation in observations:
        difference = observation.values - observation.predict(values)
        for label, miss, variance in zip(observation.labels, difference, np.diag(observation.covariance), strict=True):
            misfits[f"{observation.name}: {label}"] = float(miss / math.sqrt(variance))
        at += len(observation.values)
    share = 1.0 - np.clip(scaled_stds, 0, 1) ** 2
    chi_square = float(current[:at] @ current[:at])
    freedom = max(at - float(share.sum()), 1.0)
    wrong = at > 0 and chi2.sf(chi_square, freedom) < 1e-3
    excess = math.sqrt(chi_square / freedom) if wrong else 1.0
    if wrong:
        # Observations that contradict each other know less than they say; the prior stays what it was.
        weights = np.concatenate([np.full(at, 1.0 / excess), np.ones(count)])[:, None]
        covariance = np.linalg.inv((slope * weights).T @ (slope * weights))
        scaled_stds = np.sqrt(np.diag(covariance))
        share = 1.0 - np.clip(scaled_stds, 0, 1) ** 2
    return Posterior(
        unknowns=tuple(unknowns),
        values=np.array(list(values.values())),
        stds=np.array([u.std(s, d) for u, s, d in zip(unknowns, point, scaled_stds, strict=True)]),
        correlations=covariance / np.outer(scaled_stds, scaled_stds),
        information_share=share,
        pulls=point,
        misfits=misfits,
        flat=_flat_directions([u.name for u in unknowns], data),
        chi_square=chi_square,
        excess=excess,
        converged=converged,
    )


def _flat_directions(names: Sequence[str], data: Array) -> tuple[tuple[tuple[str, float], ...], ...]:
    """Combinations with less information in the data than a hundredth of the prior's; single parameters left out.

    Only combinations of parameters that the data do inform in some other combination are worth naming: a
    parameter that no observation depends on is simply not informed.
    """
    touched = [k for k in range(len(names)) if float(np.linalg.norm(data[:, k])) > 1.0]
    if len(touched) < 2:
        return ()
    values, vectors = np.linalg.eigh(data[:, touched].T @ data[:, touched])
    found = []
    for value, vector in zip(values, vectors.T, strict=True):
        if value > 0.01:
            break
        order = np.argsort(-np.abs(vector))
        parts = [(names[touched[k]], float(vector[k])) for k in order if abs(vector[k]) > 0.2]
        if len(parts) > 1:
            found.append(tuple(parts))
    return tuple(found)
