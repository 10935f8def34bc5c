"""What may be beside a network: members of every kind at every spring and body, and laws begun along a spring."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import replace
from functools import partial

import numpy as np
from scipy.signal import find_peaks

from ssmr_ident.doctor.laws import FORMS, GEARS, SINE, Form, Proposal, best_shape, law_along, member_of, on_path
from ssmr_ident.doctor.rules import TIE
from ssmr_ident.doctor.table import Row
from ssmr_ident.estimate.coordinate import Coordinate
from ssmr_ident.estimate.generic import branch, changing, delay, memory, rider, static
from ssmr_ident.estimate.network import motion_of
from ssmr_ident.estimate.node import Member
from ssmr_ident.estimate.values import Fit, Problem, Start

Array = np.ndarray

MAST = "flexible_mast"
"""A body that the file has not, on a spring at one that it has."""

PEAKS = 2
"""Lines of what the network leaves at which a further body is looked for."""

SPRINGS = 2
"""Springs, those at which a member of any shape takes most, along which laws are begun."""


def members_of_network(problem: Problem, base: Fit, paths: Sequence[Array]) -> list[Member]:
    """Members of any shape at every spring, further bodies on every body, and what all sensors may have in common.

    Parameters
    ----------
    problem : Problem
    base : Fit
        Of the baseline.
    paths : sequence of (n, 2·bodies) float
        Coordinates of the bodies, then their rates.
    """
    layout, f = problem.layout, problem.frequency
    found = []
    for spring, stretch in zip(layout.springs, layout.stretch, strict=True):
        own = along_spring(paths, stretch)
        kinds = [
            static(problem, own),
            memory(problem, own),
            changing(problem),
            branch(problem, 0.5 / (2 * math.pi * f)),
        ]
        found += [replace(member, element=spring) for member in kinds]
    riders = [replace(rider(problem, hz), id=MAST, form="a further body") for hz in lines_left(problem, base)]
    found += [replace(member, element=body) for body in layout.bodies for member in riders]
    if any(p.driven for p in problem.pieces):
        piece = problem.pieces[0]
        found.append(delay(piece.step * piece.every, problem.begin))
    return found


def along_spring(paths: Sequence[Array], stretch: Array) -> list[Array]:
    """(n, 3) per piece: a spring's stretch and its rate, and nought for its acceleration."""
    bodies = len(stretch)
    return [np.column_stack([p[:, :bodies] @ stretch, p[:, bodies:] @ stretch, np.zeros(len(p))]) for p in paths]


def lines_left(problem: Problem, fit: Fit) -> list[float]:
    """Frequencies [Hz] at which most is left, in sizes of each channel's noise."""
    rate = min(p.rate for p in problem.pieces)
    longest = max(len(p.y) for p in problem.pieces)
    grid = np.fft.rfftfreq(longest, 1.0 / rate)
    power = np.zeros(len(grid))
    for piece, rest in zip(problem.pieces, fit.residuals, strict=True):
        own = (rest - rest.mean(axis=0)) / piece.white
        spectrum = np.abs(np.fft.rfft(own * np.hanning(len(own))[:, None], axis=0)) ** 2
        own_grid = np.fft.rfftfreq(len(own), 1.0 / piece.rate)
        low, high = piece.band or (0.0, math.inf)
        seen = np.where((own_grid >= low) & (own_grid <= high), spectrum.sum(axis=1), 0.0)
        power += np.interp(grid, own_grid, seen)
    least = 2 + int(2.0 * longest / min(len(p.y) for p in problem.pieces))
    peaks, _ = find_peaks(power, distance=max(least, len(grid) // 60))
    peaks = peaks[peaks >= least]
    loudest = peaks[np.argsort(-power[peaks])][:PEAKS]
    return [float(grid[k]) for k in loudest] or [problem.frequency]


def laws_in_network(problem: Problem, fits: Sequence[Fit]) -> list[Proposal]:
    """Every form at the springs at which members of any shape take most, begun along the motion of these fits."""
    layout, found = problem.layout, []
    chosen: dict[str, Fit] = {}
    for fit in sorted(fits, key=lambda f: f.cost):
        for member in fit.node.members:
            if member.element in layout.springs:
                chosen.setdefault(member.element, fit)
    for spring, fit in list(chosen.items())[:SPRINGS]:
        found += _along_one(problem, fit, spring)
    return sorted(found, key=lambda p: -p.promise)


def _along_one(problem: Problem, fit: Fit, spring: str) -> list[Proposal]:
    """Every form regressed on the whole force of a spring along a fit's motion: what moves the bodies there, less what
    all other springs make of it."""
    layout, bodies, first = problem.layout, len(problem.layout.bodies), [0]
    index = layout.springs.index(spring)
    stretch = layout.stretch[index]
    values = fit.node.values(fit.point)[: len(fit.node.baseline)]
    mass, damping, stiffness = layout.matrices(values)
    own_damping, own_stiffness = values[bodies + 2 * index : bodies + 2 * index + 2].tolist()
    paths, target = [], []
    for piece, nuisance, moved in zip(problem.pieces, fit.nuisances, motion_of(problem, fit), strict=True):
        q, v, a = moved.reshape(len(moved), 3, bodies).transpose(1, 0, 2)
        net = -(a @ mass + v @ damping.T + q @ stiffness.T)
        if piece.driven and not piece.based:
            net[:, piece.into] += piece.drive[:: piece.every][: len(net)] + nuisance[fit.node.states]
        path = np.column_stack([q @ stretch, v @ stretch, np.zeros(len(q))])
        target.append(net @ stretch / (stretch @ stretch) + own_stiffness * path[:, 0] + own_damping * path[:, 1])
        paths.append(path)
        first.append(first[-1] + len(path))
    force, x, v = (np.concatenate(part) for part in (target, [p[:, 0] for p in paths], [p[:, 1] for p in paths]))
    reach, fastest, size = float(np.abs(x).max()), float(np.abs(v).max()), float(np.sqrt(np.mean(force**2)))
    plain = np.column_stack([x / reach, v / fastest, np.ones(len(x))])
    sizes, result = (reach, fastest, 0.3 * size), []
    for form in (f for f in FORMS if (layout.rotary or f.name != SINE) and f.effect != GEARS):
        along = partial(
            on_path, form, partial(law_along, problem, paths, first, ()), plain, force, own_stiffness, sizes
        )
        rest, shape, k, d, law = best_shape(along, form.shapes(*sizes))
        member = replace(member_of(form, law, form.unit(shape, own_stiffness, *sizes), reach), element=spring)
        result.append(_begun(fit, member, form, law, {2 * index: max(d, 0.0), 2 * index + 1: k}, rest, len(force)))
    return result


def _begun(
    fit: Fit, member: Member, form: Form, law: Mapping[str, float], straight: dict[int, float], rest: float, count: int
) -> Proposal:
    """A law beside the network of a fit, whose spring's straight part is another; places count behind the masses."""
    node = replace(fit.node, members=(member,))
    bodies = len(node.layout.bodies)
    old = {id(c): float(p) for c, p in zip(fit.node.coordinates, fit.point, strict=True)}
    own = {id(c): c.at(law[c.name]) for c in member.coordinates}
    point = np.array([own.get(id(c), old.get(id(c), c.mean)) for c in node.coordinates])
    for place, value in straight.items():
        c: Coordinate = node.baseline[bodies + place]
        if c.std > 1e-6:
            usual = c.value(float(point[bodies + place]))
            point[bodies + place] = c.at(max(value, 0.05 * usual) if place % 2 else value)
    promise = -0.5 * (math.log(max(rest, 1e-300)) + len(form.moved) * math.log(count) / count)
    return Proposal(node, Start(point), promise)


def also_at(rows: Sequence[Row], chosen: Row) -> tuple[str, ...]:
    """Other springs or bodies at which the same effect fits as well."""
    assert chosen.fit is not None
    own = {m.element for m in chosen.fit.node.members}
    alike = [
        r for r in rows if r.ids == chosen.ids and r.log_evidence > chosen.log_evidence - TIE and r.fit is not None
    ]
    others = [m.element for r in alike for m in (r.fit.node.members if r.fit else ())]
    return tuple(dict.fromkeys(name for name in others if name and name not in own))
