"""Effects at an instrument's output that the catalogue holds beside those of this room, a user's own among them."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from ssmr_ident.estimate.coordinate import Coordinate
from ssmr_ident.estimate.node import Member
from ssmr_ident.estimate.pieces import Piece
from ssmr_ident.estimate.values import Problem
from ssmr_ident.physics.effect import Effect, Site, Sized
from ssmr_ident.physics.effects import CATALOGUE

Array = np.ndarray

OUTPUT = "output"
"""What such a member does afterwards."""

OF_THEIR_OWN = ("sensor_saturation", "sensor_delay")
"""Links of the sensor chain that have members with slopes of their own."""

TINY = 1e-6
"""Of a channel's size, or of a parameter's: step of the differences."""


def at_outputs(problem: Problem) -> list[Member]:
    """A member for every place where such an effect of a rig is looked for first."""
    sizes = sizes_of(problem)
    chosen = [e for e in CATALOGUE.values() if e.rig and Site.OUTPUT in e.acts and e.id not in OF_THEIR_OWN]
    return [at_output(e, probe, sizes) for e in chosen for probe in (*e.probes, *e.rig_probes)]


def sizes_of(problem: Problem) -> dict[str, float]:
    """What a recording shows, in SI, by the names of ``Sized``."""
    piece, mass = problem.pieces[0], problem.baseline[0].scale
    turn = 2.0 * np.pi * problem.frequency
    acceleration = problem.size * turn**2
    return {
        "deflection": problem.size, "speed": problem.speed, "acceleration": acceleration, "time": 1.0 / turn,
        "mass": mass, "force": mass * acceleration, "stiffness": mass * turn**2,
        "duration": float(piece.time[-1] - piece.time[0]), "reading": float(np.abs(piece.y).max()),
    }  # fmt: skip


def at_output(effect: Effect, probe: Mapping[str, float | Sized], sizes: Mapping[str, float]) -> Member:
    """A member of one effect, begun at given parameters."""
    declared = {p.name: p for p in effect.parameters}
    coordinates = []
    for name, value in probe.items():
        p = declared[name]
        begin = value.value(sizes) if isinstance(value, Sized) else float(value)
        scale = abs(begin) or abs(p.nominal) or 1.0
        coordinates.append(Coordinate(name, scale, False, p.lower, p.upper, begin / scale, 10.0, p.unit))
    return Member(effect.id, "sensor_chain", "", tuple(coordinates), after=OUTPUT)


def passed_on(
    member: Member, piece: Piece, y: Array, dy: Array, given: Mapping[str, float], own: Mapping[str, tuple[int, float]]
) -> tuple[Array, Array]:
    """Channels behind the instrument, and their slopes by differences: the law may be any function.

    Parameters
    ----------
    member : Member
    piece : Piece
    y, dy : (n, c), (n, c, columns) float
    given : mapping of str to float
        Its parameters.
    own : mapping of str to (int, float)
        Column of each parameter in ``dy``, and what a unit of its coordinate is.
    """
    change = CATALOGUE[member.id].acts[Site.OUTPUT]
    assert change is not None

    def through(channels: Array, values: Mapping[str, float]) -> Array:
        named = dict(zip(piece.channels, channels.T, strict=True))
        found = change(piece.time, named, **CATALOGUE[member.id].begun(values))
        return np.column_stack([found[name] for name in piece.channels])

    out, slopes = through(y, given), np.zeros_like(dy)
    for column in range(dy.shape[2]):
        largest = float(np.abs(dy[..., column]).max())
        if largest > 0.0:
            step = TINY * float(np.abs(y).max() or 1.0) / largest
            slopes[..., column] = (through(y + step * dy[..., column], given) - out) / step
    for name, (column, unit) in own.items():
        moved = {**given, name: given[name] + TINY * unit}
        slopes[..., column] += (through(y, moved) - out) / TINY
    return out, slopes
