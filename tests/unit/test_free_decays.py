"""Decays on their block grid."""

from __future__ import annotations

import numpy as np
import pytest

from ssmr_ident.identify.body.free_decays import BodyDecay, body_decay


@pytest.fixture(scope="module")
def decay() -> BodyDecay:
    """Seven samples to a block, after the accelerometer's transient."""
    time = np.arange(3000) / 1400.0
    ring = np.exp(-3.0 * time) * np.sin(2.0 * np.pi * 6.0 * time)
    noise = 0.01 * np.random.default_rng(1).standard_normal((2, len(time)))
    return body_decay("d", time, [(0, ring + noise[0]), (2, 0.5 * ring + noise[1])], 50.0, None)


def test_block_averages_are_means_of_what_was_logged(decay: BodyDecay) -> None:
    assert decay.block == 7
    np.testing.assert_array_equal(decay.averaged(decay.record.samples[None])[0], decay.samples)


def test_block_averages_of_some_signals_by_gains_of_their_own(decay: BodyDecay) -> None:
    random = np.random.default_rng(2)
    signals = random.standard_normal((3, *decay.record.samples.shape))
    rows, gains = np.array([2, 0, 2, 1]), 1.0 + 0.1 * random.standard_normal((4, 2))
    first = round((decay.first - 3.0 * decay.record.step) / decay.record.step)
    counted = (signals[rows] * gains[:, None, :])[:, first : first + 7 * len(decay.samples)]
    np.testing.assert_array_equal(
        decay.averaged(signals, rows, gains), counted.reshape(4, len(decay.samples), 7, 2).mean(axis=2)
    )
    # an open-ended signal is cut where the blocks end
    np.testing.assert_array_equal(decay.averaged(signals[:, : first + 7 * len(decay.samples)]), decay.averaged(signals))
    with pytest.raises(ValueError, match="blocks need"):
        decay.averaged(signals[:, : first + 7 * len(decay.samples) - 1])
