"""Robots that shake in more ways than one: how far runs of one kind differ by chance, by the fitted baseline."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from ssmr_ident.doctor.swivels.anchor import Anchor
from ssmr_ident.doctor.swivels.conditions import Condition
from ssmr_ident.doctor.swivels.likelihood import log_variance

RUNS = 12
"""Pairs: a way of shaking that a quarter of all runs take is among them in 999 cases of 1000."""


def widened(anchor: Anchor, conditions: tuple[Condition, ...], covariance: np.ndarray) -> tuple[Condition, ...]:
    """The conditions, with the scatter of the baseline's own runs beyond that of a density added to their ``wander``.

    Stick-slip may settle in one of two ways from run to run, 15 dB apart, and one recording of each kind cannot show
    it: halves of a record agree. A model that does the same says so, over two floors with the same parameters, these
    being drawn from what the fit leaves open. What differs from one draw to another is no scatter: target and
    calibration are of one robot.
    """
    random = np.random.default_rng(0)
    spread = np.linalg.cholesky(covariance)
    drawn = [
        (anchor.at(anchor.z + spread @ random.standard_normal(len(anchor.z))), (2 * k + 1, 2 * k + 2))
        for k in range(RUNS)
    ]
    result = []
    for c in conditions:
        anchor.bench.prefetch((c, values, {}, seed) for values, pair in drawn for seed in pair)
        beyond = []
        for values, pair in drawn:
            first, second = (anchor.bench.run(c, values, {}, (seed,)) for seed in pair)
            if first is not None and second is not None:
                apart = anchor.log_density(first, c) - anchor.log_density(second, c)
                beyond.append(0.5 * float(np.mean(apart**2)) - log_variance(first.look.dof))
        result.append(replace(c, wander=max(c.wander, float(np.mean(beyond)))) if beyond else c)
    return tuple(result)
