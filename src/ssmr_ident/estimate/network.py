"""A network's recordings as one inverse problem."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from ssmr_ident.core.parameter import ParameterSet
from ssmr_ident.estimate.coordinate import Coordinate
from ssmr_ident.estimate.exact import polish
from ssmr_ident.estimate.latent_force import network_paths
from ssmr_ident.estimate.node import Node
from ssmr_ident.estimate.problem import VAGUE, known_bandwidth, made, seen_hz
from ssmr_ident.estimate.shooting import shot
from ssmr_ident.estimate.simulated import Compiled, motions
from ssmr_ident.estimate.smoother import smoothed
from ssmr_ident.estimate.values import Fit, Problem, Start
from ssmr_ident.experiments.campaign import Measurement
from ssmr_ident.physics.network import ONE, Layout, Network, layout_of, network_from_parameters

Array = np.ndarray

EXACTLY = 1e-9
"""Prior standard deviation of a coordinate that stays."""

STEPS = 25
"""Gauss-Newton steps."""


def network_problem(measurements: Sequence[Measurement], parameters: ParameterSet) -> Problem:
    """Prepare recordings of a network.

    Parameters
    ----------
    measurements : sequence of Measurement
    parameters : ParameterSet
        With ``bodies`` and ``springs``, as known.
    """
    layout = layout_of(parameters)
    natural = network_from_parameters(parameters).modes()[0]
    moving = float(np.median([seen_hz(m) for m in measurements]))
    fastest = max(moving, *natural.tolist())
    bandwidth = known_bandwidth(measurements, parameters)
    problem = made(measurements, layout.bodies, (), moving, fastest, bandwidth)
    driven = any(p.driven and not p.based for p in problem.pieces)
    return replace(problem, baseline=coordinates_of(layout, parameters, driven, moving), layout=layout)


def coordinates_of(layout: Layout, parameters: ParameterSet, driven: bool, frequency: float) -> tuple[Coordinate, ...]:
    """Masses, dampings and stiffnesses with their priors. Without a measured force one mass only scales, and stays."""
    known = {key: parameters[key] for key in layout.keys}
    masses = layout.keys[: len(layout.bodies)]
    turning = 2.0 * math.pi * frequency
    typical = float(np.exp(np.mean([math.log(float(known[key].value)) for key in masses])))
    found = []
    for place, (key, estimate) in enumerate(known.items()):
        value, std = float(estimate.value), estimate.std
        if place < len(masses):
            stays = estimate.fixed or (place == 0 and not driven)
            spread = EXACTLY if stays else std / value if std else VAGUE
            found.append(Coordinate(key, value, True, 0.05 * value, 20.0 * value, 0.0, spread, estimate.unit))
        elif (place - len(masses)) % 2 == 0:
            unit = typical * turning
            spread = EXACTLY if estimate.fixed else std / unit if std else 3.0
            found.append(Coordinate(key, unit, False, 0.0, 50.0 * unit, value / unit, spread, estimate.unit))
        elif value <= 0.0:
            unit = typical * turning**2
            found.append(Coordinate(key, unit, False, 0.0, math.inf, 0.0, EXACTLY, estimate.unit))
        else:
            spread = EXACTLY if estimate.fixed else std / value if std else VAGUE
            found.append(Coordinate(key, value, True, 0.01 * value, 100.0 * value, 0.0, spread, estimate.unit))
    return tuple(found)


def bare(network: Network) -> Node:
    """A network's numbers as they are, which nothing fits."""
    keys, values = network.layout.keys, network.values.tolist()
    fixed = tuple(Coordinate(key, 1.0, mean=v, std=EXACTLY) for key, v in zip(keys, values, strict=True))
    return Node(fixed, layout=network.layout)


def paths_of(problem: Problem, node: Node, point: Array) -> list[Array]:
    """Paths from which multiple shooting begins: of one mass without any model of it, of a network by what is known."""
    if problem.layout == ONE:
        return [smoothed(piece, problem.frequency, problem.size) for piece in problem.pieces]
    return network_paths(problem, node, point)


def motion_of(problem: Problem, found: Fit) -> list[Array]:
    """Coordinates, rates and accelerations of all bodies that a fit has, (n, 3·bodies) per piece."""
    bodies = len(problem.layout.bodies)
    orders, places = np.repeat(np.arange(3), bodies), tuple(range(bodies)) * 3
    pieces = [
        replace(p, channels=("",) * len(orders), orders=orders, bodies=places, y=np.zeros((len(p.y), len(orders))))
        for p in problem.pieces
    ]
    model = Compiled.of(problem, found.node, found.point, pieces)
    return motions(model, found.nuisances)


def followed(problem: Problem, node: Node, point: Array) -> Fit:
    """A model held where it is, with starts and zeros of each recording at their best."""
    start = Start(point, paths=tuple(paths_of(problem, node, point)))
    frozen = range(len(point))
    if node.beside or any(piece.motor for piece in problem.pieces):
        return polish(problem, node, shot(problem, node, start, held=True), STEPS, freeze=frozen)
    k = node.motion_states
    nuisances = []
    for piece, path in zip(problem.pieces, start.paths or (), strict=True):
        states = np.zeros(node.states)
        states[:k] = path[0, :k]
        nuisances.append(np.concatenate([states, np.zeros(2 * int(piece.driven) + 2 * piece.y.shape[1])]))
    return polish(problem, node, Start(point, tuple(nuisances)), STEPS, freeze=frozen)
