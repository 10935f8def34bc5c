"""Recordings in stretches: how far chaos is followed, what a search looks at, and a sensor that is late."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from ssmr_ident.estimate.coordinate import Coordinate
from ssmr_ident.estimate.exact import polish
from ssmr_ident.estimate.generic import delay
from ssmr_ident.estimate.node import Member, Node
from ssmr_ident.estimate.pieces import Piece
from ssmr_ident.estimate.regression import regressed
from ssmr_ident.estimate.shooting import shot
from ssmr_ident.estimate.smoother import smoothed
from ssmr_ident.estimate.stretches import GROWN, SEARCHED, in_stretches, predictable, sampled
from ssmr_ident.estimate.values import Fit, Problem, Start
from ssmr_ident.signals.noise import AutoregressiveNoise

pytestmark = pytest.mark.slow

MASS, DAMPING, STIFFNESS = 2.0, 1.0, 800.0
OMEGA = math.sqrt(STIFFNESS / MASS)
HZ = OMEGA / (2.0 * math.pi)


def problem(*pieces: Piece, size: float) -> Problem:
    rig = (
        Coordinate("mass_kg", MASS, True, 0.1, 40.0, 0.0, 0.01, "kg"),
        Coordinate("damping_N_s_m", MASS * OMEGA, False, 0.0, 1e4, 0.03, 3.0, "N s/m"),
        Coordinate("stiffness_N_m", STIFFNESS, True, 8.0, 8e4, 0.0, 1.0, "N/m"),
    )
    noises = tuple((AutoregressiveNoise(np.ones(1), float(p.white[0])),) for p in pieces)
    return Problem(tuple(pieces), rig, noises, HZ, size)


def forced(k3: float, seconds: float, seed: int, late: int = 0, rate: float = 100.0, noise: float = 0.05) -> Piece:
    """A rig's acceleration by Runge and Kutta in other hands, ``late`` samples late."""
    random = np.random.default_rng(seed)
    count = int(seconds * rate) + late
    tone, phase = random.uniform(0.5 * HZ, 2.0 * HZ, 12), random.uniform(0.0, 2.0 * math.pi, 12)

    def force(t):
        return 25.0 * np.sum(np.sin(2.0 * math.pi * tone * np.atleast_1d(t)[:, None] + phase), axis=1)

    def rates(t, s):
        return [s[1], (float(force(t)[0]) - DAMPING * s[1] - STIFFNESS * s[0] - k3 * s[0] ** 3) / MASS]

    time = np.arange(count) / rate
    x, v = solve_ivp(rates, (0.0, time[-1]), [0.0, 0.0], "DOP853", time, rtol=1e-9, atol=1e-12).y
    a = (force(time) - DAMPING * v - STIFFNESS * x - k3 * x**3) / MASS + noise * random.standard_normal(count)
    fine = force(np.arange((count - late) * 3 + 1) / (3.0 * rate) + late / rate)
    y = a[: count - late, None]
    return Piece("log.csv", seed, ("acceleration",), np.array([2]), time[: count - late], y, np.ones(y.shape, bool),
                 fine, False, True, 1.0 / (3.0 * rate), 3, np.array([noise]))  # fmt: skip


def test_what_grows_as_an_exponential_is_followed_so_far() -> None:
    """m x'' = 0.01 k x from x > 0: differences go by cosh and sinh of 0.1 w t."""
    time = np.arange(200) / 100.0
    y = np.ones((200, 1))
    p = problem(Piece("log.csv", 0, ("position",), np.array([0]), time, y, np.ones(y.shape, bool), np.zeros(2), False,
                      False, 0.0025, 4, np.array([1e-3])), size=0.01)  # fmt: skip
    law = Member("unlisted", "static_force", "|s|", (Coordinate("c_abs_s_N_m", STIFFNESS),), law={})
    node = Node(p.baseline, (law,))
    states = np.array([0.01, 0.001, *[0.0] * (node.states - 2)])
    point = np.array([0.0, 0.0, 0.0, -1.01])
    fit = Fit(node, point, (np.concatenate([states, np.zeros(2)]),), np.eye(4), (y,), 1.0, 0.0, 4.0)
    cosh, sinh = math.cosh(0.1 * OMEGA * 2.0), math.sinh(0.1 * OMEGA * 2.0)
    grown = np.linalg.norm([[cosh, 10.0 * sinh], [0.1 * sinh, cosh]], 2)
    assert predictable(p, fit) == pytest.approx(math.log(GROWN) / (math.log(grown) / (2.0 * HZ)), rel=0.01)
    rest = replace(fit, point=np.array([0.0, 0.05, 0.0, 0.0]))
    assert math.isinf(predictable(p, rest))


def test_chaos_is_fitted_in_stretches() -> None:
    k3 = 4e5
    whole = problem(forced(k3, 45.0, 1), size=0.06)
    law = Member("nonlinear_stiffness", "static_force", "cubic", (Coordinate("k3_N_m3", 2e5),), law={})
    node = Node(whole.baseline, (law,))

    def found(p: Problem) -> Fit:
        paths = tuple(smoothed(own, p.frequency, p.size) for own in p.pieces)
        return polish(p, node, shot(p, node, Start(regressed(p, paths, node), paths=paths)))

    search, begins, share = sampled(whole)
    assert sum(len(p.y) for p in search.pieces) * HZ / 100.0 == pytest.approx(SEARCHED, rel=0.1)
    assert [search.pieces[k].time[0] for k in begins] == [0.0]
    assert sum(len(p.y) for p in search.pieces) / len(whole.pieces[0].y) == pytest.approx(share, rel=0.05)
    short = found(search)
    horizon = predictable(search, short)
    assert horizon < 45.0 * HZ
    stretches = in_stretches(whole, horizon)
    assert stretches.horizon == horizon
    assert len(stretches.pieces) > len(whole.pieces)
    fit = found(stretches)
    assert fit.value("k3_N_m3") == pytest.approx(k3, rel=0.02)
    assert fit.value("stiffness_N_m") == pytest.approx(STIFFNESS, rel=0.05)


def test_a_late_sensor_is_late_from_the_begin_of_the_log() -> None:
    p = problem(forced(0.0, 10.0, 3, late=3), size=0.06)
    node = Node(p.baseline, (delay(0.01, p.begin),))
    begun = polish(p, Node(p.baseline), Start(np.zeros(3), (np.zeros(6),)), 10)
    fit = polish(p, node, Start(np.append(begun.point, 0.3), begun.nuisances))
    assert fit.value("delay_s") == pytest.approx(0.03, rel=0.005)
    assert fit.chi2 / p.samples == pytest.approx(1.0, abs=0.15)
    assert begun.chi2 > 20.0 * fit.chi2
