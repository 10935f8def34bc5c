"""Exponentials of small matrices against a library's, and against a rotation's closed form."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.linalg import expm

from ssmr_ident.physics.exponential import exponentials


@pytest.mark.parametrize("size", [2, 5, 9])
def test_exponentials_are_a_librarys(size: int) -> None:
    scales = np.array([0.0, 1e-3, 0.1, 1.0, 20.0])
    matrices = np.random.default_rng(size).normal(size=(5, size, size)) * scales[:, None, None]
    found, known = exponentials(matrices), np.array([expm(m) for m in matrices])
    assert np.all(np.abs(found - known).max(axis=(1, 2)) < 1e-11 * np.abs(known).max(axis=(1, 2)))


def test_a_swing_that_nothing_damps_turns() -> None:
    angle = np.array([0.01, 1.0, 40.0])
    found = exponentials(angle[:, None, None] * np.array([[0.0, 1.0], [-1.0, 0.0]]))
    turned = np.array([[np.cos(angle), np.sin(angle)], [-np.sin(angle), np.cos(angle)]]).transpose(2, 0, 1)
    np.testing.assert_allclose(found, turned, atol=1e-12)
