"""Maps of the residual: noise stays below the threshold, a burst is found where it was put."""

from __future__ import annotations

import numpy as np
import pytest
from small_rigs import RATE, Run, campaign, fitted, prepared

from ssmr_ident.diagnose.residual_map import cells, residual_maps


@pytest.mark.slow
@pytest.mark.parametrize("count", [200, 700])
def test_noise_exceeds_the_threshold_once_in_a_hundred_maps(count: int) -> None:
    rng = np.random.default_rng(11)
    everything = np.ones(count, dtype=bool)
    maps = [cells(rng.standard_normal(count), everything) for _ in range(1500)]
    exceeded = sum(np.nanmax(found.power) > found.threshold for found in maps)
    # 15 at most are expected, and not far fewer: outside once in 500
    assert 3 <= exceeded <= 27
    everywhere = np.mean([found.power[2:-2] for found in maps])
    assert everywhere == pytest.approx(1.0, abs=0.02)


def test_samples_that_do_not_count_leave_the_level_as_it_is() -> None:
    rng = np.random.default_rng(12)
    counts = np.arange(800) % 400 < 300
    powers = [cells(rng.standard_normal(800) * counts, counts).power for _ in range(60)]
    assert np.nanmean(powers) == pytest.approx(1.0, abs=0.06)


def test_the_map_of_a_rig_shows_before_above_and_after_below_the_threshold() -> None:
    effects = {"nonlinear_stiffness": {"k3_N_m3": 6e8}}
    setup = prepared(campaign(effects, [Run(0.004), Run(0.001)], seed=1))
    (first, *_rest) = residual_maps(fitted(setup), fitted(setup, effects), most=3)
    assert first.recording == "run-0.csv"
    assert first.before.shape == first.after.shape == (len(first.frequency), len(first.time))
    assert np.nanmax(first.before) > first.threshold_db + 10.0
    assert np.nanmax(first.after) < first.threshold_db + 1.0
    row, column = np.unravel_index(np.nanargmax(first.before), first.before.shape)
    assert first.time[column] < 0.8  # large motions come first
    assert 4.0 < first.frequency[row] < 13.0  # about the rig's own 8 Hz
    assert first.frequency[-1] == pytest.approx(0.5 * RATE)
