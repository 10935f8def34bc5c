"""Normal equations whose unknowns differ by many powers of ten."""

from __future__ import annotations

import numpy as np

from ssmr_ident.estimate.equations import solved_evenly, solved_positive


def test_unknowns_of_any_size_are_found() -> None:
    sizes = np.array([1e-9, 1.0, 1e12])
    plain = np.array([[2.0, 0.5, 0.1], [0.5, 1.0, 0.2], [0.1, 0.2, 3.0]])
    left, true = plain * np.outer(sizes, sizes), np.array([3.0, -1.0, 2.0]) / sizes
    np.testing.assert_allclose(solved_positive(left, (left @ true)[:, None])[:, 0], true, rtol=1e-9)
    np.testing.assert_allclose(solved_evenly(left, left @ true), true, rtol=1e-9)


def test_slopes_that_have_burst_along_one_line_leave_a_solution() -> None:
    """Two unknowns that do the same, 1e20 times as much as all else."""
    burst = np.array([[1e40, 1e40], [1e40, 1e40]]) + np.eye(2)
    assert np.all(np.isfinite(solved_positive(burst, np.array([[1.0], [1.0]]))))
