"""A damped step by parts is the dense least-squares step, and damping shortens it."""

from __future__ import annotations

from types import SimpleNamespace

import numpy as np
import pytest

from ssmr_ident.identify.fitting.curvature import Curvature
from ssmr_ident.identify.fitting.joint import Slopes

SIZES, SHARED, OWN = (40, 25), 3, (2, 4)
WEIGHTS = np.array([0.7, 2.5])


@pytest.fixture
def fit() -> SimpleNamespace:
    random = np.random.default_rng(5)
    slopes = tuple(
        Slopes(random.standard_normal((n, SHARED)), random.standard_normal((n, k)))
        for n, k in zip(SIZES, OWN, strict=True)
    )
    return SimpleNamespace(
        point=random.standard_normal(SHARED),
        slopes=slopes,
        residuals=tuple(random.standard_normal(n) for n in SIZES),
        nuisances=tuple(random.standard_normal(k) for k in OWN),
    )


def _dense(fit: SimpleNamespace) -> tuple[np.ndarray, np.ndarray]:
    """Rows of all recordings and priors over shared coordinates and nuisances, and what they should give."""
    rows, right, column = [], [], SHARED
    for weight, slopes, residual in zip(WEIGHTS, fit.slopes, fit.residuals, strict=True):
        block = np.zeros((len(residual), SHARED + sum(OWN)))
        block[:, :SHARED] = slopes.shared
        block[:, column : column + slopes.own.shape[1]] = slopes.own
        column += slopes.own.shape[1]
        rows.append(np.sqrt(weight) * block)
        right.append(np.sqrt(weight) * residual)
    rows.append(np.eye(SHARED + sum(OWN)))
    right.append(-np.concatenate([fit.point, *fit.nuisances]))
    return np.vstack(rows), np.concatenate(right)


def test_a_step_is_that_of_dense_least_squares(fit: SimpleNamespace) -> None:
    move, own = Curvature.of(fit, WEIGHTS).step(0.0)  # type: ignore[arg-type]
    expected = np.linalg.lstsq(*_dense(fit), rcond=None)[0]
    np.testing.assert_allclose(np.concatenate([move, *own]), expected, atol=1e-12)


def test_nuisances_alone_leave_the_shared_coordinates(fit: SimpleNamespace) -> None:
    rows, right = _dense(fit)
    expected = np.linalg.lstsq(rows[:, SHARED:], right, rcond=None)[0]
    for shared in (True, False):  # whether their products were asked for or not
        move, own = Curvature.of(fit, WEIGHTS, shared).step(0.0, shared=False)  # type: ignore[arg-type]
        assert not move.any()
        np.testing.assert_allclose(np.concatenate(own), expected, atol=1e-12)


def test_damping_shortens_a_step_and_keeps_it_downhill(fit: SimpleNamespace) -> None:
    rows, right = _dense(fit)
    steps = [np.concatenate([m, *o]) for m, o in (Curvature.of(fit, WEIGHTS).step(d) for d in (0.0, 1.0, 100.0))]  # type: ignore[arg-type]
    lengths = [float(np.linalg.norm(step)) for step in steps]
    assert lengths == sorted(lengths, reverse=True)
    costs = [float(np.sum((right - rows @ step) ** 2)) for step in (*steps, np.zeros(len(rows[0])))]
    assert costs == sorted(costs)
