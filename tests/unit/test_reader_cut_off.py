"""A signal that goes beyond its range again and again, told from coarse steps and from rest."""

from __future__ import annotations

import numpy as np
import pytest

from ssmr_ident.core.recording import Channel
from ssmr_ident.readers.health import cut_off, warnings_of

TIME = np.arange(2000) / 1000.0
SWING = np.sin(2 * np.pi * 20 * TIME) + 1e-4 * np.random.default_rng(3).standard_normal(2000)


@pytest.mark.parametrize("ends", [(-0.8, 0.8), (-2.0, 0.7)])
def test_cut_off(ends: tuple[float, float]) -> None:
    samples = np.clip(SWING, *ends)
    at = int((samples == ends[0]).sum() + (samples == ends[1]).sum())
    assert cut_off(samples).sum() == pytest.approx(at, abs=4)
    (note,) = warnings_of((Channel("acceleration", samples, "m/s^2", "acc"),))
    assert "is cut off" in note.text


@pytest.mark.parametrize("step", [0.0, 0.002, 0.02, 0.1])
def test_coarse_steps_are_no_ends(step: float) -> None:
    samples = np.round(SWING / step) * step if step else SWING
    assert not cut_off(samples).any()


def test_a_slow_clock_is_no_end() -> None:
    assert not cut_off(np.repeat(SWING[::5], 5)).any()
