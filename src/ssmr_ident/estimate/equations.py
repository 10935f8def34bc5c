"""Normal equations of unknowns whose sizes differ by many powers of ten."""

from __future__ import annotations

import numpy as np

Array = np.ndarray

LEAST_CURVATURE = 1e-12
"""That every coordinate has, in its own units: of what the data do not see, round-off alone is left."""


def on_diagonal(square: Array) -> Array:
    """Its diagonal, or those of several, to be written to."""
    return np.einsum("...ii->...i", square)


def solved_evenly(left: Array, right: Array) -> Array:
    """Symmetric equations, rows and columns first brought to one size."""
    size = np.sqrt(np.maximum(np.diag(left), LEAST_CURVATURE))
    return np.linalg.lstsq(left / np.outer(size, size), right / size, rcond=1e-13)[0] / size


def solved_positive(left: Array, columns: Array) -> Array:
    """Positive definite equations, rows and columns first brought to one size; what round-off alone decides stays."""
    size = np.sqrt(on_diagonal(left))[..., None]
    even = left / (size * np.swapaxes(size, -1, -2))
    on_diagonal(even)[...] += LEAST_CURVATURE
    return np.asarray(np.linalg.solve(even, columns / size) / size)
