"""What a fit leaves: noise of its own, what follows the motion, and a moment that stands out."""

from __future__ import annotations

import math
from types import SimpleNamespace

import numpy as np
import pytest

from ssmr_ident.doctor.left import Left, left, wandering
from ssmr_ident.doctor.rules import FOLLOWS, UNEVEN

RATE, HZ = 200.0, 4.0


def asked(seconds: float, rest_of, ask=left) -> Left:
    """``rest_of(motion, white)`` : what is left beside a motion whose size falls from 1 to 0.2."""
    time = np.arange(int(seconds * RATE)) / RATE
    motion = np.sin(2.0 * np.pi * HZ * time) * np.linspace(1.0, 0.2, len(time))
    rest = rest_of(motion, 0.01 * np.random.default_rng(1).standard_normal(len(time)))[:, None]
    piece = SimpleNamespace(
        channels=("position",), y=motion[:, None] - rest, counts=np.ones_like(rest, bool), rate=RATE, name="log.csv"
    )
    return ask(SimpleNamespace(pieces=(piece,), frequency=HZ), SimpleNamespace(residuals=(rest,)))  # type: ignore[arg-type]


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
