"""What is kept back, up to where it rests, and forces that are held from one value of a log to the next."""

from __future__ import annotations

from dataclasses import replace
from types import SimpleNamespace
from typing import Any, cast

import numpy as np
import pytest

from ssmr_ident.doctor.held import with_motion
from ssmr_ident.estimate.generic import delay
from ssmr_ident.estimate.held_force import held, is_held
from ssmr_ident.estimate.node import Node
from ssmr_ident.estimate.pieces import Piece
from ssmr_ident.estimate.values import Problem
from ssmr_ident.signals.noise import AutoregressiveNoise

RATE, HZ, NOISE = 200.0, 1.0, 1e-3


def problem(y: np.ndarray, drive: np.ndarray | None = None, white: float = NOISE) -> Problem:
    time = np.arange(len(y)) / RATE
    driven = drive is not None
    piece = Piece(
        "log.csv", 0, ("position",), np.zeros(1, int), time, y[:, None], np.ones((len(y), 1), bool),
        drive if drive is not None else np.zeros(2), False, driven, 1.0 / RATE, 1, np.array([white]),
        late=0.5 / RATE if driven else 0.0,
    )  # fmt: skip
    return Problem((piece,), (), ((AutoregressiveNoise(np.ones(1), white),),), HZ, 1.0)


def swing(seconds: float, seed: int) -> np.ndarray:
    """Friction ends it after six seconds; what is left is noise."""
    time = np.arange(int(seconds * RATE)) / RATE
    size = np.maximum(1.0 - time / 6.0, 0.0)
    return size * np.cos(2.0 * np.pi * HZ * time) + NOISE * np.random.default_rng(seed).standard_normal(len(time))


def test_a_swing_is_kept_back_up_to_where_it_rests() -> None:
    fitted = problem(swing(12.0, 1))
    kept = with_motion(problem(swing(30.0, 2)), fitted)
    assert kept is not None
    assert 5.5 < len(kept.pieces[0].y) / RATE < 7.5
    assert kept.noises == problem(swing(30.0, 2)).noises


def test_where_nothing_moves_there_is_nothing_to_foretell() -> None:
    """Differences of what rests are taken for motion until a fit has told the two apart."""
    rest = problem(NOISE * np.random.default_rng(3).standard_normal(2000), white=0.02 * NOISE)
    assert with_motion(rest, problem(swing(12.0, 1))) is None


def test_a_force_that_is_held_acts_half_a_sample_later() -> None:
    time = np.arange(400) / RATE
    own = problem(np.sin(7.0 * time), np.cos(7.0 * time))
    later = held(own)
    assert later.held
    assert later.pieces[0].drive[1:-1] == pytest.approx(np.cos(7.0 * (time - 0.5 / RATE))[1:-1], abs=1e-6)


@pytest.mark.parametrize(("samples", "is_one"), [(0.5, True), (0.35, True), (0.1, False), (1.0, False)])
def test_half_a_sample_late_is_a_held_force(samples: float, is_one: bool) -> None:
    own = problem(np.zeros(400), np.zeros(400))
    node = Node((), (delay(1.0 / RATE, 1.0),))
    fit = cast(Any, SimpleNamespace(node=node, point=np.array([samples]), covariance=np.array([[1e-4]])))
    assert is_held(own, fit) is is_one
    assert not is_held(replace(own, pieces=(replace(own.pieces[0], late=0.0),)), fit)
