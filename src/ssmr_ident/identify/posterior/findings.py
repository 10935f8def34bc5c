"""Findings in words: what a fit should tell its user beyond numbers."""

from __future__ import annotations

import math
from collections.abc import Collection, Mapping, Sequence
from typing import Any

import numpy as np

from ssmr_ident.identify.posterior.most_probable import Posterior, Unknown

CONFLICT_SIGMAS = 3.0
TRADE_OFF = 0.95

TREND = 1e-3
"""Chance of a trend with amplitude below which it is told."""


def posterior_findings(
    posterior: Posterior, hidden: Collection[str] = (), known: Sequence[Unknown] | None = None
) -> list[str]:
    """Sentences on conflicts with the prior, what is not explained, bounds, trade-offs and flat directions.

    Parameters
    ----------
    posterior : Posterior
    hidden : collection of str
        Unknowns of the method alone: no trade-off or flat direction is told for them.
    known : sequence of Unknown, optional
        What was known beforehand, where the fit set some of it aside.
    """
    found = []
    for conflict in conflicts(posterior, known):
        found.append(
            f"{conflict['parameter']} is in conflict with what was known of it: {conflict['prior']:.4g} ± "
            f"{conflict['prior_std']:.2g} before, {conflict['fitted']:.4g} {conflict['unit']} fitted, "
            f"{conflict['sigmas']:.1f} sigma away"
        )
    for unknown, value in zip(posterior.unknowns, posterior.values, strict=True):
        if "damping" in unknown.name and value < 0:
            found.append(f"{unknown.name} = {value:.3g} {unknown.unit} is negative: no passive tire or damper has that")
        if at_bound(unknown, value):
            found.append(f"{unknown.name} ended on its bound; its standard deviation says little")
    for name, miss in posterior.misfits.items():
        if abs(miss) > CONFLICT_SIGMAS:
            side = "above" if miss > 0 else "below"
            found.append(f"{name} is not explained: measured {side} the model by {abs(miss):.1f} sigma")
    if posterior.excess > 1:
        found.append(
            "no parameters explain all recordings within their uncertainty: the model misses something; each "
            f"recording was trusted {posterior.excess:.1f} times less when standard deviations were made"
        )
    if not posterior.converged:
        found.append("the fit did not converge: take its standard deviations with caution")
    found += _trade_offs(posterior, hidden)
    told = [direction for direction in posterior.flat if not {name for name, _ in direction} & set(hidden)]
    for direction in told[:2]:
        parts = ", ".join(f"{share:+.2f} {name}" for name, share in direction[:4])
        found.append(f"flat direction, known from the prior only (in prior standard deviations): {parts}")
    return found


def _trade_offs(posterior: Posterior, hidden: Collection[str]) -> list[str]:
    names = [unknown.name for unknown in posterior.unknowns]
    told = [k for k, name in enumerate(names) if name not in hidden]
    return trade_offs([names[k] for k in told], posterior.correlations[np.ix_(told, told)])


def trade_offs(names: Sequence[str], correlations: np.ndarray) -> list[str]:
    """Sentences on the two strongest correlations, and how many more there are.

    Parameters
    ----------
    names : sequence of str
    correlations : (n, n) float
    """
    pairs = [
        (float(correlations[i, j]), names[j], names[i])
        for i in range(len(names))
        for j in range(i)
        if abs(correlations[i, j]) > TRADE_OFF
    ]
    pairs.sort(key=lambda pair: -abs(pair[0]))
    found = []
    for size, first, second in pairs[:2]:
        how = "rise together" if size > 0 else "trade off"
        found.append(f"{first} and {second} {how} (correlation {size:+.3f}): only one is told by the data")
    if len(pairs) > 2:
        found[-1] += f"; so do {len(pairs) - 2} further pairs"
    return found


def at_bound(unknown: Unknown, value: float) -> bool:
    """True where a logarithm ended at its limit, e^±12 times the prior."""
    return unknown.logarithmic and abs(math.log(value / unknown.prior)) > 11.99


def conflicts(posterior: Posterior, known: Sequence[Unknown] | None = None) -> list[dict[str, Any]]:
    """Parameters in conflict as diagnosis.yaml lists them, the worst first.

    Parameters
    ----------
    posterior : Posterior
    known : sequence of Unknown, optional
        Priors to hold the values against, where the fit set some of them aside.
    """
    before = {u.name: u for u in (posterior.unknowns if known is None else known)}
    rows = []
    for unknown, value in zip(posterior.unknowns, posterior.values, strict=True):
        prior = before.get(unknown.name, unknown)
        if prior.prior_std is None:
            continue
        sigmas = abs(float(value) - prior.prior) / prior.prior_spread
        if sigmas > CONFLICT_SIGMAS:
            rows.append(
                {
                    "parameter": unknown.name,
                    "prior": prior.prior,
                    "prior_std": prior.prior_std,
                    "fitted": float(value),
                    "unit": unknown.unit,
                    "sigmas": sigmas,
                }
            )
    return sorted(rows, key=lambda row: -float(row["sigmas"]))


def amplitude_findings(name: str, trends: Mapping[str, float], falls: bool, small: str) -> list[str]:
    """Sentences about a mode that drifts with amplitude.

    Parameters
    ----------
    name : str
        Of the recording.
    trends : mapping
        ``omega`` and ``xi`` to the p-value of a trend with amplitude.
    falls : bool
        True where the frequency falls as amplitude grows.
    small : str
        Frequency at small amplitude, as text.
    """
    found = []
    if trends["omega"] < TREND:
        kind = "softening" if falls else "hardening"
        found.append(f"{name}: the frequency depends on amplitude ({kind}); at small amplitudes it is {small}")
    if trends["xi"] < TREND:
        found.append(f"{name}: the damping depends on amplitude, so it is not viscous alone")
    return found


def table_5_2(trials: Mapping[str, list[tuple[float, float]]]) -> str:
    """Damped frequencies [Hz] and decay rates [1/s] by motion and trial, with mean, std, and (5.9).

    Parameters
    ----------
    trials : mapping of motion to a list of (f, λ)
    """
    lines = [
        f"{'motion':<7} {'f mean':>8} {'std':>8} {'lambda':>8} {'std':>8} {'omega_n':>9} {'xi':>8}   f by trial [Hz]"
    ]
    for motion, rows in trials.items():
        table = np.array(rows)
        mean = table.mean(axis=0)
        std = table.std(axis=0, ddof=1) if len(table) > 1 else np.full(2, np.nan)
        omega = float(np.hypot(2 * np.pi * mean[0], mean[1]))
        each = " ".join(f"{value:.4f}" for value in table[:, 0])
        lines.append(
            f"{motion:<7} {mean[0]:8.4f} {std[0]:8.4f} {mean[1]:8.4f} {std[1]:8.4f} {omega:9.4f} "
            f"{mean[1] / omega:8.4f}   {each}"
        )
    return "\n".join(lines)
