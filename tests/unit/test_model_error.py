"""Deviations where a model leaves more than white noise, against the scatter of fits of many draws."""

from __future__ import annotations

import math

import numpy as np
import pytest
from scipy.signal import lfilter

from ssmr_ident.estimate.coordinate import Coordinate
from ssmr_ident.estimate.exact import polish
from ssmr_ident.estimate.model_error import under_model_error
from ssmr_ident.estimate.node import Node
from ssmr_ident.estimate.pieces import Piece
from ssmr_ident.estimate.values import Fit, Problem, Start
from ssmr_ident.signals.noise import AutoregressiveNoise

pytestmark = pytest.mark.slow

OMEGA, XI, RATE, NOISE, DRAWS = 20.0, 0.03, 100.0, 0.05, 60
BASELINE = (
    Coordinate("mass_kg", 1.0, True, 0.1, 40.0, 0.0, 1e-9, "kg"),
    Coordinate("damping_N_s_m", OMEGA, False, 0.0, 1e4, 0.06, 3.0, "N s/m"),
    Coordinate("stiffness_N_m", OMEGA**2, True, 4.0, 4e4, 0.0, 1.0, "N/m"),
)


def decay(colour: float, seed: int) -> tuple[Problem, Fit]:
    """A free response in closed form under an autoregressive disturbance of first order, fitted as if it was white."""
    time = np.arange(600) / RATE
    y = np.exp(-XI * OMEGA * time) * np.cos(OMEGA * math.sqrt(1.0 - XI**2) * time)
    white = np.random.default_rng(seed).standard_normal(len(time)) * NOISE
    y = y + lfilter([1.0], [1.0, -colour], white)
    piece = Piece("log.csv", 0, ("position",), np.array([0]), time, y[:, None], np.ones((len(y), 1), bool), np.zeros(2),
                  False, False, 1.0 / RATE, 1, np.array([NOISE]))  # fmt: skip
    noises = ((AutoregressiveNoise(np.ones(1), NOISE),),)
    problem = Problem((piece,), BASELINE, noises, OMEGA / (2.0 * math.pi), float(y.std()))
    begun = np.array([y[0], -XI * OMEGA, *np.zeros(2)])
    return problem, polish(problem, Node(BASELINE), Start(np.array([0.0, 2.0 * XI, 0.0]), (begun,)), 10)


@pytest.mark.parametrize(("colour", "least", "most"), [(0.0, 0.8, 1.4), (0.9, 0.75, 1.5)])
def test_deviations_are_the_scatter_of_fits(colour: float, least: float, most: float) -> None:
    points, stds, by_noise = [], [], []
    for seed in range(DRAWS):
        problem, fit = decay(colour, seed)
        points.append(fit.point[1:])
        by_noise.append(np.sqrt(np.diag(fit.covariance))[1:])
        stds.append(np.sqrt(np.diag(under_model_error(problem, fit).covariance))[1:])
    scatter = np.std(points, axis=0)
    ratio = np.mean(stds, axis=0) / scatter
    assert ratio == pytest.approx(0.5 * (least + most), abs=0.5 * (most - least))
    if colour:
        assert (np.mean(by_noise, axis=0) < 0.6 * scatter).all()
