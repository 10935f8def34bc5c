"""What a single recording of a rig says of frequency and damping, whatever the others and the file say."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

import numpy as np

from ssmr_ident.estimate.exact import polish
from ssmr_ident.estimate.node import Node
from ssmr_ident.estimate.problem import VAGUE, VAGUE_DAMPING
from ssmr_ident.estimate.values import Fit, Problem, Start

Array = np.ndarray

STEPS = 12
"""Gauss-Newton steps from the fit of all recordings."""


@dataclass(frozen=True, eq=False)
class Oscillation:
    """Natural frequency and damping ratio of a linear rig.

    Parameters
    ----------
    omega_n, omega_n_std : float [rad/s]
    xi, xi_std : float [1]
    residuals : tuple of (n, c) float
        Of the recording's pieces, model less measured, SI.
    nuisances : tuple of (k,) float
        As in ``Fit``.
    """

    omega_n: float
    omega_n_std: float
    xi: float
    xi_std: float
    residuals: tuple[Array, ...]
    nuisances: tuple[Array, ...]


def alone(problem: Problem, fit: Fit, recording: int) -> Oscillation:
    """Damping and stiffness by one recording, the mass as all say.

    Parameters
    ----------
    problem : Problem
        Of a rig with a spring.
    fit : Fit
        Of all recordings.
    recording : int
    """
    own = [k for k, piece in enumerate(problem.pieces) if piece.recording == recording]
    part = replace(problem, pieces=tuple(problem.pieces[k] for k in own), noises=tuple(problem.noises[k] for k in own))
    mass, damping, stiffness, *motor = fit.node.baseline
    node = Node((mass, replace(damping, std=VAGUE_DAMPING), replace(stiffness, std=VAGUE), *motor))
    start = Start(fit.point, tuple(fit.nuisances[k] for k in own))
    return oscillation(polish(part, node, start, STEPS, freeze=[0, *range(3, 3 + len(motor))]))


def oscillation(fit: Fit) -> Oscillation:
    """Of a fit's mass, damping and stiffness, with standard deviations to first order."""
    m, d, k = fit.node.values(fit.point)[:3]
    omega = math.sqrt(k / m)
    xi = d / (2.0 * math.sqrt(k * m))
    slopes = fit.node.slopes(fit.point)[:3]
    turn = np.array([[-0.5 * omega / m, 0.0, 0.5 * omega / k], [-0.5 * xi / m, 0.5 / (m * omega), -0.5 * xi / k]])
    spread = (turn * slopes) @ fit.covariance[:3, :3] @ (turn * slopes).T
    stds = np.sqrt(np.maximum(np.diag(spread), 0.0))
    return Oscillation(omega, float(stds[0]), xi, float(stds[1]), fit.residuals, fit.nuisances)
