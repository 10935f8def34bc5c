"""The quadratic form that a fit's slopes make of its cost, and the damped step to its least value."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from ssmr_ident.identify.fitting.joint import JointFit

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
    def of(fit: JointFit, weights: Array, shared: bool = True) -> Curvature:
        """Of a fit with slopes, its recordings by their weights, (t,) float; of nuisances alone where no step in the
        shared coordinates will be asked for."""
        p, counts = len(fit.point), np.array([len(nuisance) for nuisance in fit.nuisances])
        most = int(counts.max(initial=0))
        matrix, right = np.eye(p), -fit.point
        own, sides = np.zeros((len(counts), most, most)), np.zeros((len(counts), most, p + 1))
        for index, (weight, slopes, residual, nuisance) in enumerate(
            zip(weights, fit.slopes, fit.residuals, fit.nuisances, strict=True)
        ):
            a, b, k = slopes.shared, slopes.own, len(nuisance)
            own[index, :k, :k] = weight * (b.T @ b)
            sides[index, :k, p] = weight * (residual @ b) - nuisance
            if shared:
                matrix += weight * (a.T @ a)
                right = right + weight * (residual @ a)
                sides[index, :k, :p] = weight * (b.T @ a)
        return Curvature(fit.point, matrix, right, own, sides, counts)

    def normal_equations(self) -> tuple[Array, Array]:
        """Matrix and right side in the shared coordinates, nuisances eliminated (Schur complement)."""
        matrices, right = self._reduced(np.linalg.solve(self._damped(np.zeros(1)), self.sides))
        return matrices[0], right[0]

    def step(self, damping: float, shared: bool = True) -> tuple[Array, list[Array]]:
        """``steps`` for one damping."""
        return self.steps([damping], shared)[0]

    def steps(self, dampings: Sequence[float], shared: bool = True) -> list[tuple[Array, list[Array]]]:
        """Of the shared coordinates and of each recording's nuisances (Levenberg 1944, Marquardt 1963).

        Parameters
        ----------
        dampings : sequence of float
        shared : bool
            False moves the nuisances alone.
        """
        count, raised = len(self.point), np.asarray(dampings, float)
        moves, matrices = np.zeros((len(raised), count)), self._damped(raised)
        if not shared or not count:
            found = np.linalg.solve(matrices, self.sides[:, :, count:])[..., 0]
        else:
            solved = np.linalg.solve(matrices, self.sides)
            shares, right = self._reduced(solved)
            diagonal = np.einsum("dpp->dp", shares)
            diagonal *= 1.0 + raised[:, None]
            moves = np.linalg.solve(shares, right[..., None])[..., 0]
            found = solved[..., count] - (solved[..., :count] @ moves[:, None, :, None])[..., 0]
        return [
            (move, [one[:k] for one, k in zip(own, self.counts, strict=True)])
            for move, own in zip(moves, found, strict=True)
        ]

    def _reduced(self, solved: Array) -> tuple[Array, Array]:
        """Of each damping, (d, p, p) and (d, p) float."""
        count = len(self.point)
        taken = (np.swapaxes(self.sides[:, :, :count], 1, 2) @ solved).sum(axis=1)
        return self.shared - taken[..., :count], self.right - taken[..., count]

    def _damped(self, dampings: Array) -> Array:
        """Curvature along nuisances, their priors of unit width in it, raised by each damping; (d, t, k, k) float."""
        found = np.repeat(self.own[None], len(dampings), axis=0)
        diagonal = np.einsum("dtkk->dtk", found)
        diagonal += 1.0
        diagonal *= 1.0 + dampings[:, None, None]
        return found
