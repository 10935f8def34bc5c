"""Where fits begin: a regression of the force along a path, and the states at its begin."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np

from ssmr_ident.estimate.motor import drive_of, torque_along
from ssmr_ident.estimate.node import Node, merged
from ssmr_ident.estimate.pieces import Piece
from ssmr_ident.estimate.values import Problem, Start
from ssmr_ident.physics.voltage_drive import VoltageDrive

Array = np.ndarray


def regressed(problem: Problem, paths: Sequence[Array], node: Node) -> Array:
    """A node's coordinates by regressing the force on a path: where fits begin, whatever the file says.

    Mass, damping, stiffness and the tables of generic members enter linearly; all else begins at its usual value.

    Parameters
    ----------
    problem : Problem
    paths : sequence of (n, 3) float
        Position, velocity, acceleration per piece.
    node : Node
    """
    mass, tables = problem.baseline[0], merged(node)
    motor = drive_of(np.array([c.value(c.mean) for c in problem.baseline]))
    rows, right = [], []
    for piece, path in zip(problem.pieces, paths, strict=True):
        own = driving(piece, path, motor)
        if piece.based:  # relative to the base, whose motion acts as a force on the mass
            own = -mass.scale * own
        beside = tables.along(path, tables.courses(piece), mass.scale)
        rows.append(np.column_stack([path[:, ::-1], np.ones(len(path)), beside]))
        right.append(own - motor.inertia * path[:, 2] if motor is not None else own)
    design, force = np.vstack(rows), np.concatenate(right)
    known = mass.std < 1e-6 or not any(p.driven and not p.based for p in problem.pieces)
    if known:
        force, design = force - mass.scale * design[:, 0], design[:, 1:]
    size = np.sqrt(np.mean(design**2, axis=0)) + 1e-300
    ridge = np.diag([0.0] * (3 if known else 4) + [1e-3 * math.sqrt(len(force))] * tables.linear)
    padded = np.vstack([design / size, ridge])
    found = np.linalg.lstsq(padded, np.concatenate([force, np.zeros(len(ridge))]), rcond=None)[0] / size
    m, d, k = (mass.scale, *found[:2]) if known else found[:3]
    usual = [c.value(c.mean) for c in problem.baseline]
    values = [m if m > 0.1 * usual[0] else usual[0], max(d, 0.0), k if k > 0.0 else usual[2]]
    point = np.array([c.mean for c in node.coordinates])
    point[:3] = [c.at(v) if c.std > 1e-6 else c.mean for c, v in zip(problem.baseline[:3], values, strict=True)]
    first, coefficients = len(problem.baseline) + node.count("linear"), found[3 if known else 4 :]
    for at, value in enumerate(coefficients.tolist(), first):
        point[at] = node.coordinates[at].at(value)
    return point


def driving(piece: Piece, path: Array, motor: VoltageDrive | None, zero: float = 0.0) -> Array:
    """What drives a piece along a path [N], or [m/s^2] of its foot, (n,) float; nought where nothing does."""
    own = piece.drive[:: piece.every][: len(path)] if piece.driven else np.zeros(len(path))
    if motor is None or piece.motor is None:
        return own + zero
    return own + torque_along(piece.motor, piece.every, path, motor, zero)


def starts_of(problem: Problem, node: Node, start: Start) -> list[Array]:
    """Nuisances from the begin of the paths."""
    found = []
    assert start.paths is not None
    for piece, path in zip(problem.pieces, start.paths, strict=True):
        states = np.zeros(node.states)
        states[: node.motion_states] = path[0, : node.motion_states]
        found.append(np.concatenate([states, np.zeros(2 * int(piece.driven) + 2 * piece.y.shape[1])]))
    return found
