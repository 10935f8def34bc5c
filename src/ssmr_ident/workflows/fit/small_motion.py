"""Damping and stiffness of a small motion, where a decay's frequency depends on its amplitude."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from ssmr_ident.core.parameter import FITTED, Estimate, ParameterSet
from ssmr_ident.physics.rig import RIG_KEYS
from ssmr_ident.workflows.fit.rig_recordings import Seen

Array = np.ndarray

SOURCE = f"{FITTED}: their small motion"


def at_small_motion(found: ParameterSet, seen: Sequence[Seen]) -> dict[str, Estimate]:
    """Damping and stiffness where the amplitude goes to nought, as the mass is; what is fixed stays.

    Parameters
    ----------
    found : ParameterSet
        What a linear rig over the whole of the recordings has.
    seen : sequence of Seen
        Decays, of which some drift.
    """
    omega, omega_std = _mean([_frequency(one) for one in seen])
    xi, xi_std = _mean([_damping(one) for one in seen])
    keys = RIG_KEYS["inertia_kg_m2" in found]
    mass, damping, stiffness = (found[key] for key in keys)
    m = float(mass.value)
    share = 0.0 if mass.fixed or mass.std is None else mass.std / m
    k, d = m * omega**2, 2.0 * m * omega * xi
    k_std = k * math.hypot(share, 2.0 * omega_std / omega)
    d_std = math.hypot(d * share, d * omega_std / omega, 2.0 * m * omega * xi_std)
    new = {
        keys[1]: replace(damping, value=d, std=d_std, source=SOURCE),
        keys[2]: replace(stiffness, value=k, std=k_std, source=SOURCE),
    }
    return {key: estimate for key, estimate in new.items() if not estimate.fixed}


def _frequency(one: Seen) -> tuple[float, float]:
    assert one.own is not None
    if one.drifts and one.trend is not None:
        return one.trend.small_omega_n, one.trend.small_omega_n_std
    return one.own.omega_n, one.own.omega_n_std


def _damping(one: Seen) -> tuple[float, float]:
    assert one.own is not None
    if one.drifts and one.trend is not None:
        mean, std = one.trend.mean_xi
        return mean, math.hypot(std, float(np.std(one.trend.xi)) / math.sqrt(len(one.trend.xi)))
    return one.own.xi, one.own.xi_std


def _mean(values: Sequence[tuple[float, float]]) -> tuple[float, float]:
    """Weighted mean and its standard deviation, wider where the values scatter by more than theirs."""
    value, std = np.array(values).T
    weight = std**-2.0
    mean = float(weight @ value / weight.sum())
    excess = float(weight @ (value - mean) ** 2) / max(len(values) - 1, 1)
    return mean, math.sqrt(max(1.0, excess) / float(weight.sum()))
