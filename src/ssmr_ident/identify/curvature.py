"""The quadratic form that a fit's slopes make of its cost, and the damped step to its least value."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ssmr_ident.identify.joint import JointFit

Array = np.ndarray


@dataclass(frozen=True, eq=False)
class Curvature:
    """Products of slopes and residuals of all recordings, of which every damping makes a step.

    Parameters
    ----------
    point : (p,) float
    shared : (p, p) float
        Weighted products of the slopes in the shared coordinates, their priors of unit width in it.
    right : (p,) float
        Of these and the residuals.
    own : (t, k, k) float
        The same of each recording's nuisances, k being the most that one has; rows of zeros fill up the others.
    sides : (t, k, p + 1) float
        Products of nuisances' slopes and shared ones, and last their right side.
    counts : (t,) int
        Nuisances of each recording.
    """

    point: Array
    shared: Array
    right: Array
    own: Array
    sides: Array
    counts: Array

    @staticmethod
    def of(fit: JointFit, weights: Array) -> Curvature:
        """Of a fit with slopes, its recordings by their weights, (t,) float."""
        p, counts = len(fit.point), np.array([len(nuisance) for nuisance in fit.nuisances])
        most = int(counts.max(initial=0))
        shared, right = np.eye(p), -fit.point
        own, sides = np.zeros((len(counts), most, most)), np.zeros((len(counts), most, p + 1))
        for index, (weight, slopes, residual, nuisance) in enumerate(
            zip(weights, fit.slopes, fit.residuals, fit.nuisances, strict=True)
        ):
            a, b, k = slopes.shared, slopes.own, len(nuisance)
            shared += weight * (a.T @ a)
            right = right + weight * (residual @ a)
            own[index, :k, :k] = weight * (b.T @ b)
            sides[index, :k, :p] = weight * (b.T @ a)
            sides[index, :k, p] = weight * (residual @ b) - nuisance
        return Curvature(fit.point, shared, right, own, sides, counts)

    def normal_equations(self, damping: float = 0.0) -> tuple[Array, Array]:
        """Matrix and right side in the shared coordinates, nuisances eliminated (Schur complement)."""
        return self._reduced(np.linalg.solve(self._damped(damping), self.sides))

    def step(self, damping: float, shared: bool = True) -> tuple[Array, list[Array]]:
        """Of the shared coordinates and of each recording's nuisances (Levenberg 1944, Marquardt 1963).

        Parameters
        ----------
        damping : float
        shared : bool
            False moves the nuisances alone.
        """
        count = len(self.point)
        move, matrices = np.zeros(count), self._damped(damping)
        if not shared or not count:
            found = np.linalg.solve(matrices, self.sides[:, :, count:])[:, :, 0]
        else:
            solved = np.linalg.solve(matrices, self.sides)
            matrix, right = self._reduced(solved)
            matrix.flat[:: count + 1] *= 1.0 + damping
            move = np.linalg.solve(matrix, right)
            found = solved[:, :, count] - solved[:, :, :count] @ move
        return move, [own[:k] for own, k in zip(found, self.counts, strict=True)]

    def _reduced(self, solved: Array) -> tuple[Array, Array]:
        count = len(self.point)
        taken = (np.swapaxes(self.sides[:, :, :count], 1, 2) @ solved).sum(axis=0)
        return self.shared - taken[:, :count], self.right - taken[:, count]

    def _damped(self, damping: float) -> Array:
        """Curvature along nuisances, their priors of unit width in it."""
        found = self.own.copy()
        diagonal = np.einsum("tkk->tk", found)
        diagonal += 1.0
        diagonal *= 1.0 + damping
        return found
