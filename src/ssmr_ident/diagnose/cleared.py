"""What the parameters and nuisances of a fit leave of a change in its recordings."""

from __future__ import annotations

import numpy as np

from ssmr_ident.identify.fitting.joint import JointFit

Array = np.ndarray


class Cleared:
    """What the baseline's parameters and nuisances leave of a change, all of them refitted within their priors.

    The posterior about the fit is a quadratic form; the Schur complement of everything that the baseline can move is
    what a further coordinate has to itself. Where a prior holds a parameter back against the recordings, a direction
    like its own gains what the prior charges: an offset far beyond what the file says of it is an effect.
    """

    def __init__(self, fit: JointFit) -> None:
        self.weights = fit.weights
        self._own: list[tuple[Array, Array, Array]] = []
        shared: list[Array] = []
        ends = np.cumsum([len(r) for r in fit.residuals])
        self._cuts = ends[:-1]
        self.residual = np.concatenate(fit.residuals)
        count = len(fit.point)
        matrix, right = np.eye(count), -fit.point.copy()
        for w, slopes, residual, nuisance in zip(self.weights, fit.slopes, fit.residuals, fit.nuisances, strict=True):
            a, b = slopes.shared, slopes.own
            gram = np.linalg.inv(w * (b.T @ b) + np.eye(b.shape[1]))
            side = w * (b.T @ residual) - nuisance
            self._own.append((b, gram, side))
            cross = w * (b.T @ a)
            matrix += w * (a.T @ a) - cross.T @ gram @ cross
            right += w * (a.T @ residual) - cross.T @ gram @ side
            shared.append(a)
        self._shared, self._matrix, self._right = shared, matrix, right

    def size_of(self, columns: Array) -> Array:
        """Squares of changes, (k,), every recording as it counts."""
        parts = np.split(columns, self._cuts)
        return np.sum([w * np.sum(part**2, axis=0) for w, part in zip(self.weights, parts, strict=True)], axis=0)

    def __call__(self, columns: Array) -> tuple[Array, Array]:
        """Curvature and slope of the log posterior (times two) along new coordinates."""
        parts = np.split(columns, self._cuts)
        size = columns.shape[1]
        gram, slope = np.zeros((size, size)), np.zeros(size)
        mixed = np.zeros((len(self._matrix), size))
        residuals = np.split(self.residual, self._cuts)
        together = zip(self.weights, parts, self._shared, residuals, self._own, strict=True)
        for w, part, a, residual, (b, inverse, side) in together:
            cross = w * (b.T @ part)
            gram += w * (part.T @ part) - cross.T @ inverse @ cross
            slope += w * (part.T @ residual) - cross.T @ inverse @ side
            mixed += w * (a.T @ part) - w * (a.T @ b) @ inverse @ cross
        solved = np.linalg.solve(self._matrix, mixed)
        return gram - mixed.T @ solved, slope - solved.T @ self._right
