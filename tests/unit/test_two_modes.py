"""Where a mass that rides begins: two masses by scipy's eigenvalues, a recording by its state space."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest
from scipy.linalg import eigh
from scipy.signal import StateSpace, lsim

from ssmr_ident.estimate.coordinate import Coordinate
from ssmr_ident.estimate.node import Node
from ssmr_ident.estimate.pieces import Piece
from ssmr_ident.estimate.two_modes import riding, two_modes
from ssmr_ident.estimate.values import Fit, Problem, Stop
from ssmr_ident.signals.noise import AutoregressiveNoise

MASS, STIFFNESS, DAMPING, RATE = 3.0, 20_000.0, 4.0, 400.0


def recorded(share: float, hz: float, driven: bool, seed: int) -> tuple[Problem, np.ndarray]:
    """Acceleration of a mass that carries a share of itself on a spring of its own, and the two natural frequencies."""
    body, rides = (1.0 - share) * MASS, share * MASS
    own = rides * (2.0 * math.pi * hz) ** 2
    m, k = np.diag([body, rides]), np.array([[STIFFNESS + own, -own], [-own, own]])
    c = np.diag([DAMPING, 0.0]) + 0.02 * rides * 2.0 * math.pi * hz * np.array([[1.0, -1.0], [-1.0, 1.0]])
    a = np.block([[np.zeros((2, 2)), np.eye(2)], [-np.linalg.solve(m, k), -np.linalg.solve(m, c)]])
    b = np.concatenate([[0.0, 0.0], np.linalg.solve(m, [1.0, 0.0])])[:, None]
    random, time = np.random.default_rng(seed), np.arange(2400) / RATE
    force = np.interp(time, time[::4], 30.0 * random.standard_normal(600)) if driven else np.zeros(2400)
    start = [0.0] * 4 if driven else [2e-3, 1e-3, 0.0, 0.0]
    _, y, _ = lsim(StateSpace(a, b, a[2:3], b[2:3]), force, time, start)
    y = y + 1e-3 * y.std() * random.standard_normal(len(y))
    piece = Piece("log.csv", 0, ("acceleration",), np.array([2]), time, y[:, None], np.ones((2400, 1), bool),
                  np.append(force, 0.0), False, driven, 1.0 / RATE, 1, np.array([1e-3]))  # fmt: skip
    baseline = tuple(
        Coordinate(name, value, True, 0.0, math.inf, 0.0, 1.0)
        for name, value in (("mass_kg", MASS), ("damping_N_s_m", DAMPING), ("stiffness_N_m", STIFFNESS))
    )
    noise = ((AutoregressiveNoise(np.ones(1), 1e-3),),)
    return Problem((piece,), baseline, noise, 12.0, 1e-3), np.sqrt(eigh(k, m, eigvals_only=True))


@pytest.mark.parametrize("driven", [True, False])
@pytest.mark.parametrize(("share", "hz"), [(0.03, 12.5), (0.3, 9.0)])
def test_two_modes_are_read_off_one_recording(share: float, hz: float, driven: bool) -> None:
    problem, exact = recorded(share, hz, driven, seed=4)
    found = two_modes(problem)
    assert found is not None
    assert found[:2] == pytest.approx(exact, rel=5e-3)


def test_what_a_structure_rings_with_far_above_is_none_of_the_two() -> None:
    """A third of the acceleration, and a thousandth of the deflection."""
    problem, exact = recorded(0.3, 9.0, True, seed=4)
    piece = problem.pieces[0]
    random = np.random.default_rng(5)
    turning = 2.0 * np.pi * 150.0
    plate = StateSpace(
        [[0.0, 1.0], [-(turning**2), -0.02 * turning]], [[0.0], [1.0]], [[-(turning**2), -0.02 * turning]], [[1.0]]
    )
    _, ringing, _ = lsim(plate, random.standard_normal(len(piece.time)), piece.time)
    ringing *= 0.3 * piece.y.std() / ringing.std()
    found = two_modes(replace(problem, pieces=(replace(piece, y=piece.y + ringing[:, None]),)))
    assert found is not None
    assert found[:2] == pytest.approx(exact, rel=1e-2)


def test_the_mains_are_no_mode() -> None:
    """Far above the noise; nothing drives them."""
    problem, exact = recorded(0.3, 9.0, True, seed=4)
    piece = problem.pieces[0]
    hum = 0.02 * piece.y.std() * np.sin(2.0 * np.pi * 50.02 * piece.time)[:, None]
    found = two_modes(replace(problem, pieces=(replace(piece, y=piece.y + hum),)))
    assert found is not None
    assert found[:2] == pytest.approx(exact, rel=0.01)


def test_starts_have_the_modes_that_were_found() -> None:
    """Sum and product of the roots say frequency and share; eigenvalues of the two masses say whether."""
    problem, _ = recorded(0.3, 9.0, False, seed=4)
    first, second, _ = two_modes(problem) or (0.0, 0.0, 0.0)
    base = Fit(Node(problem.baseline), np.zeros(3), (), np.eye(3), (), 0.0, 0.0, 3.0, Stop.CONVERGED)
    sides = riding(problem)
    assert len(sides) == 2
    for own in sides:
        node, start = own.start(base, [np.zeros((2400, 3))])
        values = dict(zip((c.name for c in node.coordinates), node.values(start.point), strict=True))
        rides = values["rider_share"] * values["mass_kg"]
        spring = rides * (2.0 * math.pi * values["rider_Hz"]) ** 2
        m = np.diag([values["mass_kg"] - rides, rides])
        k = np.array([[values["stiffness_N_m"] + spring, -spring], [-spring, spring]])
        assert np.sqrt(eigh(k, m, eigvals_only=True)) == pytest.approx([first, second], rel=1e-9)
