"""Along which axis a baseline's parameters drift when they are refitted in parts: that types the missing physics.

Dry friction shows as a damping ratio that goes as 1/A with the amplitude A, quadratic damping as A; a hardening
spring stiffens as A², play softens as 1/A. Source: Feldman, Hilbert Transform Applications in Mechanical Vibration
(2011), chapter 10 (backbones and damping curves); the averages over a cycle are those of harmonic balance.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from ssmr_ident.diagnose.evidence import Drift
from ssmr_ident.diagnose.parts import Part, windows
from ssmr_ident.diagnose.reading import reading
from ssmr_ident.diagnose.trend import bins, chance, scatter
from ssmr_ident.identify.fitting.joint import JointFit
from ssmr_ident.identify.posterior.objective import Unknown

Array = np.ndarray

KINDS, PER_KIND = ("stiffness", "damping", "mu_kinetic"), 2
FEWEST = 6
"""Windows below which an axis is not looked at."""

ALIKE = 0.5
"""Rank correlation of two axes above which the second is left out: a drift along the first would be read twice."""

SUSPECT = 0.05
"""p-value of a drift that may explain another."""

FARTHEST = 1.6
"""Natural logarithm by which a straight line is believed: a factor of five."""

STATE = ("amplitude", "speed", "side", "direction")
"""Axes whose scale is that of one motion."""

SECOND = ("side", "direction", "time")
"""Axes that are looked at for parameters that drift along no other."""

UNITS = {"amplitude": "m", "speed": "m/s", "time": "s", "travel": "m", "load": "N", "pulling speed": "m/s"}


def drifts(fit: JointFit, most: int = 4, seed: int = 0) -> tuple[Drift, ...]:
    """Parameters that differ between parts of the data, clearest first; ``reading`` is empty where none is clear.

    Parameters
    ----------
    fit : JointFit
        With slopes.
    most : int
    seed : int
        Of the permutations.
    """
    columns = _telling(fit)
    if not columns:
        return ()
    unknowns = [fit.model.unknowns[k] for k in columns]
    points = fit.point[columns]
    rotary = any(channel.startswith("ang") for trial in fit.trials for channel in trial.channels)
    parts = windows(fit, columns)
    rng = np.random.default_rng(seed)
    found: list[Drift] = []
    for axis in _axes(parts):
        chosen = [part for part in parts if axis in part.along]
        unit = UNITS[axis].replace("m", "rad") if rotary and axis in ("amplitude", "speed") else UNITS[axis]
        found += _along(axis, unit, chosen, unknowns, points, rng)
    halves = [] if any(trial.channels == ("force",) for trial in fit.trials) else windows(fit, columns, halved=True)
    for axis in ("side", "direction"):
        chosen = [part for part in halves if axis in part.along]
        if len(chosen) >= FEWEST:
            found += _along(axis, "1", chosen, unknowns, points, rng)
    found = [replace(drift, reading=reading(drift, len(found))) for drift in found]
    # the first swing is the largest, early, and on the side of the release: what drifts with size differs there too
    sized = {drift.parameter for drift in found if drift.along not in SECOND and drift.p_value < SUSPECT}
    found = [drift for drift in found if drift.along not in SECOND or drift.parameter not in sized]
    order = sorted(found, key=lambda drift: (drift.p_value, -_spread(drift)))
    return tuple(order[:most])


def _telling(fit: JointFit) -> list[int]:
    """Of each kind the parameters that the recordings say most of."""
    weight = fit.independent / fit.rss
    told = sum(weight * np.sum(slopes.shared**2, axis=0) for slopes in fit.slopes)
    names = [unknown.name for unknown in fit.model.physics]
    chosen = []
    for kind in KINDS:
        if kind.startswith("mu") and not all(trial.channels == ("force",) for trial in fit.trials):
            continue  # a decay hardly slides: a straight line says nothing of its friction
        members = [k for k, name in enumerate(names) if kind in name and told[k] > 1.0]
        chosen += sorted(members, key=lambda k: -float(told[k]))[:PER_KIND]
    return chosen


def _axes(parts: Sequence[Part]) -> list[str]:
    """Axes along which the parts differ, without those that repeat another."""
    kept: list[str] = []
    for axis in ("amplitude", "travel", "load", "speed", "pulling speed", "time"):
        chosen = [part for part in parts if axis in part.along]
        if len(chosen) < FEWEST or np.ptp([part.along[axis] for part in chosen]) == 0.0:
            continue
        ranks = {name: np.argsort(np.argsort([part.along.get(name, 0.0) for part in chosen])) for name in (axis, *kept)}
        if all(abs(np.corrcoef(ranks[axis], ranks[name])[0, 1]) < ALIKE for name in kept):
            kept.append(axis)
    return kept


def _along(
    axis: str, unit: str, parts: Sequence[Part], unknowns: Sequence[Unknown], points: Array,
    rng: np.random.Generator,
) -> list[Drift]:  # fmt: skip
    drifts = []
    for k, unknown in enumerate(unknowns):
        chosen = _telling_motion(parts, k) if axis in STATE else list(parts)
        if len(chosen) >= FEWEST:
            found = _one(axis, unit, chosen, k, unknown, float(points[k]), rng)
            drifts += [found] if found else []
    return drifts


def _telling_motion(parts: Sequence[Part], k: int) -> list[Part]:
    """Parts of the motion that says most of a parameter."""
    told: dict[tuple[str, ...], float] = {}
    for part in parts:
        told[part.motion] = told.get(part.motion, 0.0) + float(part.std[k]) ** -2.0
    return [part for part in parts if part.motion == max(told, key=lambda motion: told[motion])]


def _one(
    axis: str, unit: str, parts: Sequence[Part], k: int, unknown: Unknown, point: float, rng: np.random.Generator
) -> Drift | None:
    position = np.array([part.along[axis] for part in parts])
    place = bins(position)
    count = int(place.max()) + 1
    if count < 2:
        return None
    moves, stds = (np.array([getattr(part, name)[k] for part in parts]) for name in ("move", "std"))
    weight = 1.0 / (stds**2 + scatter(moves, stds))
    p = chance(position, moves, weight, rng)
    reach = FARTHEST / unknown.spread if unknown.logarithmic else np.inf
    means = [np.average(moves[place == b], weights=weight[place == b]) for b in range(count)]
    errors = [float(np.sum(weight[place == b])) ** -0.5 for b in range(count)]
    ahead = point + np.clip(means, -reach, reach)
    whole = unknown.value(point)
    value = np.array([unknown.value(float(at)) for at in ahead]) / whole
    std = np.abs([unknown.std(float(at), e) / whole for at, e in zip(ahead, errors, strict=True)])
    centres = np.array([position[place == b].mean() for b in range(count)])
    return Drift(unknown.name, axis, unit, centres, value, std, p)


def _spread(drift: Drift) -> float:
    weight = drift.std**-2.0
    return float(np.sum(weight * (drift.value - np.average(drift.value, weights=weight)) ** 2))
