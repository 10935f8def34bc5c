"""The force of a law over what it depends on, as far as the recordings went, with its standard deviation."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np

from ssmr_ident.estimate.generic import STATIC
from ssmr_ident.estimate.motion import motion
from ssmr_ident.estimate.network import motion_of
from ssmr_ident.estimate.node import Member, effects_of
from ssmr_ident.estimate.values import Fit, Problem
from ssmr_ident.physics.element import STATES, element_force
from ssmr_ident.physics.network import ONE
from ssmr_ident.physics.slots import effect_vector

Array = np.ndarray

POINTS, BENT = 61, 3.0
"""Of a curve, and how much denser they lie around nought, where friction turns: evenly in asinh of ``BENT``'s sinh."""

VARIABLES = {"x": "displacement [m]", "v": "velocity [m/s]"}
SHARE = 0.1
"""Standard deviations of a coordinate over which slopes are differences."""


def law_curve(problem: Problem, fit: Fit, member: Member) -> Mapping[str, Any] | None:
    """Spring and law over deflection, or damper and law over speed; None for what is a function of neither alone.

    Parameters
    ----------
    problem : Problem
    fit : Fit
    member : Member
        Of its node.
    """
    if member.law is None or member.kind != STATIC or member.variable not in VARIABLES:
        return None
    order = "xv".index(member.variable)
    reach = _reach(problem, fit)[order]
    grid = reach * np.sinh(np.linspace(-BENT, BENT, POINTS)) / np.sinh(BENT)
    node = fit.node
    place = len(node.layout.bodies) + 2 * node.site + (1 - order)

    def force(point: Array) -> Array:
        values, slots = node.values(point), effect_vector({member.id: effects_of(node, point)[member.id]})
        stiffness, rest = float(values[len(node.layout.bodies) + 2 * node.site + 1]), np.zeros(STATES)
        places = np.column_stack([grid, np.zeros(POINTS)] if order == 0 else [np.zeros(POINTS), grid])
        beside = [element_force(s, v, rest, stiffness, 1.0, 1.0, True, slots) for s, v in places.tolist()]
        return float(values[place]) * grid + np.array(beside)

    spread = np.sqrt(np.maximum(np.diag(fit.covariance), 0.0))
    slopes = np.zeros((POINTS, len(fit.point)))
    for k in np.flatnonzero(spread > 0.0):
        step = np.zeros(len(fit.point))
        step[k] = SHARE * spread[k]
        slopes[:, k] = (force(fit.point + step) - force(fit.point - step)) / (2.0 * step[k])
    std = np.sqrt(np.maximum(np.einsum("gi,ij,gj->g", slopes, fit.covariance, slopes), 0.0))
    return {
        "variable": VARIABLES[member.variable], "points": grid.tolist(), "force": force(fit.point).tolist(),
        "std": std.tolist(),
    }  # fmt: skip


def _reach(problem: Problem, fit: Fit) -> tuple[float, float]:
    """Largest deflection and speed of the spring at which the law acts."""
    if problem.layout == ONE:
        paths = [path[:, :2] for path in motion(problem, fit)]
    else:
        stretch, bodies = fit.node.layout.stretch[fit.node.site], len(fit.node.layout.bodies)
        whole = motion_of(problem, fit)
        paths = [np.column_stack([p[:, :bodies] @ stretch, p[:, bodies : 2 * bodies] @ stretch]) for p in whole]
    most = np.max([np.abs(path).max(axis=0) for path in paths], axis=0)
    return float(most[0]), float(most[1])
