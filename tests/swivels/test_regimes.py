"""How far two runs of one robot differ: what its parameters leave open is no scatter."""

from __future__ import annotations

from dataclasses import dataclass
from types import SimpleNamespace

import numpy as np
import pytest

from ssmr_ident.doctor.swivels.likelihood import log_variance
from ssmr_ident.doctor.swivels.regimes import widened

DOF = 40.0


@dataclass(frozen=True)
class _Kept:
    wander: float = 0.01


def _anchor(by_floor: float, by_parameters: float) -> SimpleNamespace:
    def run(condition, values, effects, seeds):
        random = np.random.default_rng(seeds[0])
        chance = np.sqrt(log_variance(DOF)) * random.standard_normal(4000)
        other_way = by_floor * float(random.random() < 0.5)
        return SimpleNamespace(look=SimpleNamespace(dof=DOF), log=chance + other_way + by_parameters * values[0])

    return SimpleNamespace(
        z=np.zeros(1),
        at=lambda z: z,
        bench=SimpleNamespace(run=run, prefetch=lambda jobs: None),
        log_density=lambda found, condition: found.log,
    )


def test_parameters_that_are_open_widen_nothing() -> None:
    (kept,) = widened(_anchor(0.0, 3.0), (_Kept(),), np.eye(1))  # type: ignore[arg-type]
    assert kept.wander == pytest.approx(0.01, abs=0.005)


def test_two_ways_of_shaking_differ_by_half_their_distance_squared_in_half_of_the_pairs() -> None:
    (kept,) = widened(_anchor(2.0, 3.0), (_Kept(),), np.eye(1))  # type: ignore[arg-type]
    pairs = np.random.default_rng  # the floors of twelve pairs, as the anchor above draws them
    ways = np.array([[_way(pairs(2 * k + 1)), _way(pairs(2 * k + 2))] for k in range(12)])
    assert 0 < np.sum(ways[:, 0] != ways[:, 1]) < 12
    assert kept.wander == pytest.approx(0.5 * 2.0**2 * np.mean(ways[:, 0] != ways[:, 1]), rel=0.05)


def _way(random: np.random.Generator) -> bool:
    random.standard_normal(4000)
    return bool(random.random() < 0.5)
