"""The motion that a fit has."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from ssmr_ident.estimate.instrument import OUTPUT
from ssmr_ident.estimate.node import LAGS, STATES_OF, Node
from ssmr_ident.estimate.simulated import Compiled, motions
from ssmr_ident.estimate.values import Fit, Problem

Array = np.ndarray


def motion(problem: Problem, found: Fit) -> list[Array]:
    """(n, 3) per piece: position, velocity, acceleration (absolute on a driven base) of a fit at the samples."""
    pieces = [
        replace(p, channels=("position", "velocity", "acceleration"), orders=np.arange(3), y=np.zeros((len(p.y), 3)))
        for p in problem.pieces
    ]
    node, begun = found.node, []
    bare = Node(
        node.baseline, tuple(m for m in node.members if m.linear not in LAGS and m.after not in ("clip", OUTPUT))
    )
    names = [id(c) for c in node.coordinates]
    point = np.array([found.point[names.index(id(c))] for c in bare.coordinates])
    model = Compiled.of(problem, bare, point, pieces)
    for nuisance in found.nuisances:
        own, at = [], 2
        for member in (m for m in node.members if m.linear):
            size = STATES_OF[member.linear]
            own += list(nuisance[at : at + size]) if member.linear not in LAGS else []
            at += size
        begun.append(np.array([*nuisance[:2], *own, *nuisance[node.linear_states :]]))
    return motions(model, begun)
