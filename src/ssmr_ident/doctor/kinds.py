"""Generic members of every kind that recordings can show."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np

from ssmr_ident.estimate.generic import RANGES, branch, by_recording, changing, clip, delay, lag, memory, static
from ssmr_ident.estimate.instrument import at_outputs
from ssmr_ident.estimate.node import Member
from ssmr_ident.estimate.values import Problem
from ssmr_ident.physics.effects import CATALOGUE

Array = np.ndarray


def kinds(problem: Problem, paths: Sequence[Array]) -> list[Member]:
    """Generic members of every kind that these recordings can show, and the links of the sensor chain; but for what
    rides, which begins where two modes are."""
    f = problem.frequency
    found = [static(problem, paths, variable) for variable in ("x", "v", "")]
    found += [memory(problem, paths), changing(problem)]
    found.append(branch(problem, 0.5 / (2.0 * math.pi * f)))
    other = by_recording(problem)
    found += [other] if other else []
    piece = problem.pieces[0]
    if any(p.driven and p.motor is None for p in problem.pieces):
        found.append(delay(piece.step * piece.every, problem.begin))
    if 2 in piece.orders:
        most = min(0.5 * problem.bandwidth_hz, 0.4 * piece.rate)
        found += [lag(min(q * f, most), problem.bandwidth_hz, order) for order in (2.0, 1.0) for q in (3.0, 12.0)]
    found += at_outputs(problem)
    ranges = {p.name: p for p in CATALOGUE["sensor_saturation"].parameters}
    for c, (name, unit) in enumerate(zip(piece.channels, piece.units, strict=True)):
        if RANGES[unit] in ranges:
            most = max(float(np.abs(p.y[:, c]).max()) for p in problem.pieces)
            found.append(clip(name, 0.95 * most, RANGES[unit], unit))
    return found
