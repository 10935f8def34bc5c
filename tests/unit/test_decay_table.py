"""Table 5.2 for a session's own decays: lines that numpy's own FFT finds, and envelopes that touch the swings."""

from __future__ import annotations

import numpy as np
import pytest

from ssmr_ident.identify.decays.fit import fit_decay
from ssmr_ident.report.figures_fit import NamedDecay, envelope_figure
from ssmr_ident.workflows.fit.decay_table import decay_table, named_decay

TIME = np.arange(4096) / 1000.0


def made(hertz: float, seed: int) -> NamedDecay:
    """A decay of 2 1/s with noise, a fast line that the low-pass takes, and an offset."""
    noise = 0.002 * np.random.default_rng(seed).standard_normal(len(TIME))
    samples = 0.5 * np.exp(-2.0 * TIME) * np.sin(2 * np.pi * hertz * TIME + 0.4) + noise + 0.1
    fit = fit_decay(TIME, samples, max_modes=1, unit="m/s^2")
    found = named_decay(f"roll-{seed}.xlsx", "roll", TIME, samples, "m/s^2", fit, fit.modes[0])
    assert found is not None
    return found


def test_the_table_of_own_logs() -> None:
    decays = [made(6.0, 1), made(6.3, 2)]
    bins = [6.0 // (1000 / 2048) * 1000 / 2048, 13 * 1000 / 2048]  # the nearest bins: 5.859 and 6.348 Hz
    assert [d.peak_hz for d in decays] == pytest.approx(bins)
    for decay in decays:
        assert decay.rate == pytest.approx(2.0, rel=0.02)
        assert decay.amplitude == pytest.approx(0.5, rel=0.02)
        inside = 0.5 * np.exp(-decay.rate * (decay.time - decay.start)) + 0.01
        assert np.all(np.abs(decay.samples) < inside)
    line = decay_table(decays).splitlines()[-1].split()
    assert [float(cell) for cell in line[-2:]] == pytest.approx([np.mean(bins), np.std(bins, ddof=1)], abs=1e-4)
    assert len(envelope_figure(decays).axes) == 2


def test_a_log_too_slow_for_20_hz_has_no_row() -> None:
    time = np.arange(200) / 25.0
    samples = np.exp(-0.5 * time) * np.sin(2 * np.pi * 2.0 * time)
    fit = fit_decay(time, samples, max_modes=1, unit="m/s^2")
    assert named_decay("slow.csv", "roll", time, samples, "m/s^2", fit, fit.modes[0]) is None
