"""Robots that shake in more ways than one: how far runs of one kind differ by chance, by the fitted baseline."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from ssmr_ident.diagnose.turning.anchor import Anchor
from ssmr_ident.diagnose.turning.conditions import Condition
from ssmr_ident.diagnose.turning.likelihood import log_variance, weight_of

RUNS = 12
"""A way of shaking that a quarter of all runs take is among them in 97 cases of 100."""


def widened(anchor: Anchor, conditions: tuple[Condition, ...]) -> tuple[Condition, ...]:
    """The conditions, with the scatter of the baseline's own runs beyond that of a density added to their ``wander``.

    Stick-slip may settle in one of two ways from run to run, 15 dB apart, and one recording of each kind cannot show
    it: halves of a record agree. A model that does the same says so; every run has its own floor, and parameters
    within what the fit leaves open.
    """
    random = np.random.default_rng(0)
    precision = np.eye(len(anchor.z))
    if anchor.slopes is not None:
        precision = precision + anchor.slopes.T @ anchor.slopes * weight_of(anchor.fit.tau_db)
    spread = np.linalg.cholesky(np.linalg.inv(precision))
    drawn = [anchor.at(anchor.z + spread @ random.standard_normal(len(anchor.z))) for _ in range(RUNS)]
    result = []
    for c in conditions:
        anchor.bench.prefetch((c, values, {}, seed) for seed, values in enumerate(drawn, 1))
        runs = [anchor.bench.run(c, values, {}, (seed,)) for seed, values in enumerate(drawn, 1)]
        kept = [run for run in runs if run is not None]
        if len(kept) < 2:
            result.append(c)
            continue
        scatter = np.array([anchor.log_density(run, c) for run in kept]).var(axis=0, ddof=1).mean()
        beyond = float(scatter) - log_variance(kept[0].look.dof)
        result.append(replace(c, wander=max(c.wander, beyond)))
    return tuple(result)
