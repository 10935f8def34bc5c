"""Starts taken back: a swing's state by its closed form."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest

from ssmr_ident.estimate.baseline import baseline_fit
from ssmr_ident.estimate.coarser import coarser
from ssmr_ident.estimate.coordinate import Coordinate
from ssmr_ident.estimate.earlier import earlier
from ssmr_ident.estimate.pieces import Piece
from ssmr_ident.estimate.values import Problem
from ssmr_ident.signals.noise import AutoregressiveNoise

MASS, HZ, RATIO, RATE = 2.0, 3.0, 0.02, 600.0


def swing(noise: float) -> Problem:
    """x = e^(-d t) cos w t, from its first sample."""
    turning = 2.0 * math.pi * HZ
    damped, rate = turning * math.sqrt(1.0 - RATIO**2), RATIO * turning
    time = np.arange(1200) / RATE
    x = np.exp(-rate * time) * np.cos(damped * time) + noise * np.random.default_rng(1).standard_normal(len(time))
    piece = Piece(
        "log.csv", 0, ("position",), np.zeros(1, int), time, x[:, None], np.ones((len(x), 1), bool), np.zeros(2),
        False, False, 1.0 / RATE, 1, np.array([noise]),
    )  # fmt: skip
    baseline = (
        Coordinate("mass_kg", MASS, True, 0.1, 40.0, 0.0, 1e-9, "kg"),
        Coordinate("damping_N_s_m", MASS * turning, False, 0.0, 1e4, 0.04, 3.0, "N s/m"),
        Coordinate("stiffness_N_m", MASS * turning**2, True, 1.0, 1e5, 0.0, 1.0, "N/m"),
    )
    return Problem((piece,), baseline, ((AutoregressiveNoise(np.ones(1), noise),),), HZ, 0.5)


def test_a_swing_goes_back_to_its_first_sample() -> None:
    whole = swing(1e-4)
    few = coarser(whole)
    late = few.pieces[0].time[0] - whole.pieces[0].time[0]
    assert late > 3.0 / RATE
    fit = baseline_fit(few)
    turning = 2.0 * math.pi * HZ
    assert abs(fit.nuisances[0][0] - 1.0) > 0.01
    start = earlier(few, fit, whole, (0,))
    assert start.nuisances is not None
    x, v = start.nuisances[0][:2]
    seen = np.sinc((2.0 * late * RATE + 1.0) * HZ / RATE)  # what means of so many samples leave of the motion
    assert x == pytest.approx(seen, abs=3e-4)
    assert v / turning == pytest.approx(-RATIO * seen, abs=3e-4)
    driven = replace(whole, pieces=(replace(whole.pieces[0], driven=True),))
    (as_it_was,) = earlier(few, fit, driven, (0,)).nuisances or ()
    assert np.array_equal(as_it_was, fit.nuisances[0])
