"""What a fit leaves: noise of its own, what follows the motion, and a moment that stands out."""

from __future__ import annotations

import math
from types import SimpleNamespace

import numpy as np
import pytest

from ssmr_ident.doctor.left import Beyond, Left, beyond, left, wandering
from ssmr_ident.doctor.rules import FOLLOWS, UNEVEN
from ssmr_ident.estimate.network import bare
from ssmr_ident.estimate.pieces import Piece
from ssmr_ident.estimate.values import Problem
from ssmr_ident.physics.network import ONE, Network
from ssmr_ident.signals.noise import AutoregressiveNoise

RATE, HZ = 200.0, 4.0


def asked(seconds: float, rest_of, ask=left) -> Left:
    """``rest_of(motion, white)`` : what is left beside a motion whose size falls from 1 to 0.2."""
    time = np.arange(int(seconds * RATE)) / RATE
    motion = np.sin(2.0 * np.pi * HZ * time) * np.linspace(1.0, 0.2, len(time))
    rest = rest_of(motion, 0.01 * np.random.default_rng(1).standard_normal(len(time)))[:, None]
    piece = Piece(
        "log.csv", 0, ("position",), np.zeros(1, int), time, motion[:, None] - rest, np.ones_like(rest, bool),
        np.zeros(2), False, False, 1.0 / RATE, 1, np.array([0.01]),
    )  # fmt: skip
    problem = Problem((piece,), (), ((AutoregressiveNoise(np.ones(1), 0.01),),), HZ, 1.0)
    return ask(problem, SimpleNamespace(residuals=(rest,)))  # type: ignore[arg-type]


def far_off(hz: float) -> Beyond | None:
    """What is said of a rig of 5 Hz that leaves a decay of another frequency beside noise."""
    time = np.arange(4000) / 400.0
    swing = np.exp(-time) * np.sin(2.0 * np.pi * hz * time)
    rest = (swing + 0.05 * np.random.default_rng(2).standard_normal(len(time)))[:, None]
    piece = Piece(
        "log.csv", 0, ("acceleration",), np.array([2]), time, rest, np.ones_like(rest, bool),
        np.zeros(2), False, False, 1.0 / 400.0, 1, np.array([0.05]),
    )  # fmt: skip
    node = bare(Network(ONE, np.array([1.0, 0.3, (2.0 * np.pi * 5.0) ** 2])))
    point = np.array([c.mean for c in node.baseline])
    return beyond(SimpleNamespace(pieces=(piece,)), SimpleNamespace(node=node, point=point, residuals=(rest,)))  # type: ignore[arg-type]


def test_a_mode_beyond_the_model_proposes_a_band_without_it() -> None:
    found = far_off(80.0)
    assert found is not None
    assert (found.found, found.highest) == pytest.approx((80.0, 5.0), rel=0.01)
    assert found.band_hz == (0.0, 20.0)
    assert far_off(8.0) is None


def test_noise_follows_nothing() -> None:
    found = asked(30.0, lambda motion, white: white)
    assert abs(found.follows) < FOLLOWS
    assert found.uneven < UNEVEN


def test_what_grows_with_the_motion_follows_it() -> None:
    envelope = np.linspace(1.0, 0.2, int(30.0 * RATE))
    assert asked(30.0, lambda motion, white: white * envelope).follows > FOLLOWS


def test_a_knock_stands_out() -> None:
    knock = np.exp(-0.5 * ((np.arange(int(30.0 * RATE)) / RATE - 20.0) / 0.05) ** 2)
    found = asked(30.0, lambda motion, white: white + knock)
    assert found.uneven > UNEVEN
    assert found.loudest == "log.csv"


@pytest.mark.parametrize("seconds", [1.0, 3.0])
def test_too_little_to_tell_is_not_taken_for_noise(seconds: float) -> None:
    assert math.isinf(asked(seconds, lambda motion, white: white).follows)


def test_a_zero_that_wanders_is_slower_than_the_motion() -> None:
    slow = 0.3 * np.sin(2.0 * np.pi * 0.07 * np.arange(int(30.0 * RATE)) / RATE)
    ((name, hz),) = asked(30.0, lambda motion, white: white + slow, wandering)
    assert name == "position"
    assert 0.05 < hz < 0.2
    assert asked(30.0, lambda motion, white: white, wandering) == []
    assert asked(30.0, lambda motion, white: white + 0.1 * motion, wandering) == []
