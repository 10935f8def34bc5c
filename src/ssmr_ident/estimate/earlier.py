"""Starts of a fit of means over several samples, taken back to the first sample of each recording."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from scipy.linalg import expm

from ssmr_ident.estimate.node import matrices
from ssmr_ident.estimate.values import Fit, Problem, Start

Array = np.ndarray


def earlier(few: Problem, fit: Fit, whole: Problem, begins: Sequence[int]) -> Start:
    """A fit's point with its nuisances at the begins of the recordings.

    The first mean stands in the middle of its samples: of what swings freely the state goes back by as much, as the rig
    without the members that are not linear has it. What is driven forgets its start.

    Parameters
    ----------
    few : Problem
        Of which ``fit`` is one.
    fit : Fit
    whole : Problem
    begins : sequence of int
        The piece of ``few`` that is at the begin of each of the whole one's.
    """
    node, found = fit.node, []
    values = node.values(fit.point)[: node.linear_count]
    for piece, k in zip(whole.pieces, begins, strict=True):
        nuisance, late = fit.nuisances[k].copy(), few.pieces[k].time[0] - piece.time[0]
        if not piece.driven and late > 0.0:
            states = slice(0, node.linear_states)
            nuisance[states] = expm(-late * matrices(node, values, piece.seen)[0]) @ nuisance[states]
        found.append(nuisance)
    return Start(fit.point, tuple(found))
