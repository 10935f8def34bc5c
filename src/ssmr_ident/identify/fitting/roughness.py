"""How far estimates scatter where contacts slide: in the smooth part of a rough cost, as far as its minima are deep.

Which wheel lets go first gives the cost of pulls local minima along every parameter. A descent ends in one, the
curvature there is that minimum's own, and says nothing of how far the next one is: of six robots that lack nothing a
quarter of all parameters lay more than three such deviations from the truth, and 2 % do now. A plane through a cloud of
simulations as wide as that curvature has it averages them out. What the cost of single points lies off that
plane's is how deep the minima are, and the lowest point is found no nearer than where the smooth part has risen by as
much.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from ssmr_ident.identify.fitting.descent import slides
from ssmr_ident.identify.fitting.joint import JointFit, Slopes, evaluate_all
from ssmr_ident.identify.fitting.scatter import covariance, sandwich

Array = np.ndarray

POINTS = 4
"""Points of a cloud for each coordinate."""

SEED = 20120512


def scatter_of(fit: JointFit) -> Array:
    """Covariance of the scaled coordinates, (p, p) float, nuisances integrated out, of a smooth cost or a rough one.

    Parameters
    ----------
    fit : JointFit
        With slopes.
    """
    local = covariance(fit)
    if not slides(fit):
        return local
    planes, depth = _planes(fit, 0.5 * (local + local.T))
    if planes is None:
        return local
    # what is known beforehand is known whatever recordings hide
    sizes, axes = np.linalg.eigh(sandwich(planes))
    result: Array = (axes * np.maximum(sizes, np.minimum(sizes * (1.0 + depth), 1.0))) @ axes.T
    return result


def _planes(fit: JointFit, wide: Array) -> tuple[JointFit | None, float]:
    """The fit with slopes of planes through a cloud of a covariance, and the standard deviation of costs about theirs.

    None where too few points of the cloud can be simulated.
    """
    random, count = np.random.default_rng(SEED), len(fit.point)
    moves = random.multivariate_normal(np.zeros(count), wide, POINTS * (count + 1), method="eigh")
    places = [(fit.point + move, fit.nuisances) for move in moves]
    found = [(k, f) for k, f in enumerate(evaluate_all(fit.trials, fit.model, places)) if np.isfinite(f.rss)]
    if len(found) < 2 * (count + 1):
        return None, 0.0
    across = np.column_stack([np.ones(len(found)), moves[[k for k, _ in found]]])
    slopes, off = [], np.zeros(len(found))
    for index, (weight, residual) in enumerate(zip(fit.weights, fit.residuals, strict=True)):
        left = np.array([f.residuals[index] for _, f in found])
        plane = np.linalg.lstsq(across, left - residual, rcond=None)[0]
        slopes.append(Slopes(-plane[1:].T, fit.slopes[index].own))
        smooth = residual + across @ plane
        off += weight * (np.sum(left**2, axis=1) - np.sum(smooth**2, axis=1))
    return replace(fit, slopes=tuple(slopes), exact=True), float(np.std(off))
