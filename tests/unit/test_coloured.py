"""How many samples tell two explanations apart where noise is coloured."""

from __future__ import annotations

from types import SimpleNamespace

import numpy as np
import pytest
from scipy.signal import lfilter

from ssmr_ident.diagnose.coloured import told_by
from ssmr_ident.signals.noise import independent_samples

COUNT, STEP, POLE = 1000, 4e-3, 0.8


def _told(noise: np.ndarray, taken: np.ndarray) -> float:
    trial = SimpleNamespace(size=len(noise), by_channel=lambda residual: residual[:, None])
    after = SimpleNamespace(trials=(trial,), residuals=(noise,), counted=np.array([independent_samples(noise)]))
    before = SimpleNamespace(residuals=(noise + taken,))
    return float(told_by(after, before)[0])  # type: ignore[arg-type]


@pytest.mark.parametrize("hz", [3.0, 30.0, 100.0])
def test_it_is_the_variance_that_coloured_noise_gives_a_share_of_the_difference(hz: float) -> None:
    """By how the share of a decaying wave scatters over many draws of the noise."""
    random = np.random.default_rng(1)
    time = STEP * np.arange(COUNT)
    taken = np.exp(-1.5 * time) * np.sin(2.0 * np.pi * hz * time)
    noise = lfilter([np.sqrt(1.0 - POLE**2)], [1.0, -POLE], random.standard_normal((400, COUNT + 100)))[:, 100:]
    scatter = float(np.var(noise @ taken) / (taken @ taken))
    told = np.mean([_told(one, 0.1 * taken) for one in noise[:50]])
    expected = min(COUNT / scatter, np.mean([independent_samples(one) for one in noise[:50]]))
    assert told == pytest.approx(expected, rel=0.15)


def test_white_noise_tells_all_samples() -> None:
    noise = np.random.default_rng(2).standard_normal(COUNT)
    taken = np.sin(2.0 * np.pi * 10.0 * STEP * np.arange(COUNT))
    assert _told(noise, taken) > 0.7 * COUNT
    assert _told(noise, 0.0 * taken) == pytest.approx(independent_samples(noise))
