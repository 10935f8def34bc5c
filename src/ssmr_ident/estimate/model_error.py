"""How far parameters may be off where a model leaves more than noise."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from ssmr_ident.estimate.exact import curvature_of_nuisances, side_by_side, solved_positive, whitened_columns
from ssmr_ident.estimate.scales import priors
from ssmr_ident.estimate.values import Fit, Problem
from ssmr_ident.signals.noise import long_run_variance

Array = np.ndarray

TOGETHER = 0.25
"""Share of a piece, at the most, over which what is left is taken to hang together."""


def under_model_error(problem: Problem, fit: Fit) -> Fit:
    """A fit whose covariance counts what the model leaves as it is, and not as the white noise that it should be.

    What a wrong model leaves goes on for as long as the motion that it comes of: over a period. Deviations are never
    below those by the noise.

    Notes
    -----
    The covariance of a quasi-maximum-likelihood estimate (White 1982), scores added up over a period (Newey and West
    1987).
    """
    node, point = fit.node, fit.point
    local, scales = side_by_side(problem, node, fit.nuisances)
    room = local.shape[1]
    prior = np.diag(priors(node)[1])
    spread = prior.copy()
    for k, (white, _, _) in enumerate(whitened_columns(problem, node, point, local)):
        flat = white.reshape(-1, white.shape[2])
        normal = (flat.T @ flat)[None]
        own = curvature_of_nuisances(normal, scales[k : k + 1], 0.0)
        slopes = white[..., room:-1] - white[..., :room] @ solved_positive(own, normal[:, :room, room:-1])[0]
        scores = np.einsum("ncp,nc->np", slopes, white[..., -1])
        period = round(problem.pieces[k].rate / problem.frequency)
        spread += long_run_variance(scores, min(period, int(TOGETHER * len(scores))))
    robust = np.diag(fit.covariance @ spread @ fit.covariance)
    known = np.diag(fit.covariance)
    louder = np.sqrt(np.maximum(robust / np.maximum(known, 1e-300), 1.0))
    return replace(fit, covariance=fit.covariance * np.outer(louder, louder))
