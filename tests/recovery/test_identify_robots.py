"""Random robots from the priors: reported intervals hold (a small version of benchmarks/bench_recovery.py)."""

from __future__ import annotations

import importlib.util
import sys
from pathlib import Path
from types import ModuleType

import numpy as np
import pytest
from scipy.stats import binom

pytestmark = pytest.mark.slow


@pytest.fixture(scope="module")
def bench(root: Path) -> ModuleType:
    spec = importlib.util.spec_from_file_location("bench_recovery", root / "benchmarks" / "bench_recovery.py")
    assert spec is not None
    assert spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    # dataclasses look their module up by name
    sys.modules[spec.name] = module
    spec.loader.exec_module(module)
    return module


def test_intervals_hold_over_random_robots(bench: ModuleType) -> None:
    rows = [bench.recover(number) for number in range(6)]
    scores = np.array([row.scores for row in rows])
    inside = int(np.sum(np.abs(scores) < 1.959964))
    # Parameters of one robot go together; a robot counts as about five independent numbers.
    assert inside / scores.size > binom.ppf(1e-3, 30, 0.95) / 30
    assert 0.5 < float(np.sqrt(np.mean(scores**2))) < 1.7
    assert {row.flat for row in rows} == {1}
    assert all(row.fit.settled for row in rows)
    shares = np.median([row.stds / row.prior_stds for row in rows], axis=0)
    told = dict(zip(rows[0].names, shares, strict=True))
    assert told["tire.damping_z_N_s_m"] < 0.2
    assert told["contact_shift_x_m"] < 0.5
