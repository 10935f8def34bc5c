"""The quadratic form that a fit's slopes make of its cost, and the damped step to its least value."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from ssmr_ident.identify.joint import JointFit

Array = np.ndarray


@dataclass(frozen=True, eq=False)
class _Part:
    """One recording's products, by its weight."""

    shared: Array  # (p, p)
    cross: Array  # (k, p)
    own: Array  # (k, k)
    right: Array  # (p,)
    side: Array  # (k,)
    nuisance: Array  # (k,)


@dataclass(frozen=True, eq=False)
class Curvature:
    """Products of slopes and residuals of all recordings, of which every damping makes a step.

    Parameters
    ----------
    point : (p,) float
    parts : sequence of products
        Of each recording; see ``of``.
    """

    point: Array
    parts: Sequence[_Part]

    @staticmethod
    def of(fit: JointFit, weights: Array) -> Curvature:
        """Of a fit with slopes, its recordings by their weights, (t,) float."""
        parts = []
        for weight, slopes, residual, nuisance in zip(weights, fit.slopes, fit.residuals, fit.nuisances, strict=True):
            a, b = slopes.shared, weight * slopes.own
            parts.append(
                _Part(weight * (a.T @ a), b.T @ a, b.T @ slopes.own, weight * (residual @ a), residual @ b, nuisance)
            )
        return Curvature(fit.point, parts)

    def normal_equations(self, damping: float = 0.0) -> tuple[Array, Array]:
        """Matrix and right side in the shared coordinates, nuisances eliminated (Schur complement)."""
        count = len(self.point)
        matrix, right = np.eye(count), -self.point
        for part in self.parts:
            solved = np.linalg.solve(
                _damped(part.own, damping), np.column_stack([part.cross, part.side - part.nuisance])
            )
            matrix += part.shared - part.cross.T @ solved[:, :count]
            right = right + part.right - part.cross.T @ solved[:, count]
        return matrix, right

    def step(self, damping: float, shared: bool = True) -> tuple[Array, list[Array]]:
        """Of the shared coordinates and of each recording's nuisances (Levenberg 1944, Marquardt 1963).

        Parameters
        ----------
        damping : float
        shared : bool
            False moves the nuisances alone.
        """
        move = np.zeros(len(self.point))
        if shared and len(move):
            matrix, right = self.normal_equations(damping)
            matrix.flat[:: len(move) + 1] *= 1.0 + damping
            move = np.linalg.solve(matrix, right)
        own = [
            np.linalg.solve(_damped(part.own, damping), part.side - part.cross @ move - part.nuisance)
            for part in self.parts
        ]
        return move, own


def _damped(own: Array, damping: float) -> Array:
    """Curvature along nuisances, their priors of unit width in it."""
    found = own.copy()
    diagonal = found.reshape(-1)[:: len(found) + 1]
    diagonal += 1.0
    diagonal *= 1.0 + damping
    return found
