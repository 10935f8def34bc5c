"""What a model says of a pull: its unknowns, shared and of one recording, and the residuals that they leave.

Shared are the friction while sliding, how far the static one is above it, and the drive's stiffness and damping ratio.
Of one recording are the moment at which the drive starts to pull, the load cell's zero, the moments of letting go,
whose forces scatter about the static friction, and a level of friction that changes along the way.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from ssmr_ident.core.parameter import ParameterSet
from ssmr_ident.identify.blocks.log import PulledLog
from ssmr_ident.physics.robot import GRAVITY
from ssmr_ident.simulate.pulled_block import pull

Array = np.ndarray

KNOTS = 8
"""Of a level that changes: straight lines between them along the head's way."""

KINETIC, STATIC = "mu_kinetic", "mu_static"
STIFFNESS, DAMPING = "cable.stiffness_N_m", "cable.damping_N_s_m"
FALLING = "stribeck_velocity_m_s"
SERIES = "cable.series_N_m"
"""Stiffness of what is in series with the drive that the file knows."""
DRIFT = "zero_drift_N_s"

HELD = 1e-3
"""Of the logarithm of what is not fitted."""

SCATTER = 0.1
"""Of the forces at which a block is let go, over what they fall by, before that is known."""


@dataclass(frozen=True)
class Shape:
    """Which physics a model has beside constant friction behind a rigid drive.

    Parameters
    ----------
    stretches : bool
        The drive has a stiffness.
    falls : bool
        Friction falls once it slides.
    smoothly : bool
        It falls over a speed, and not at once.
    softer : bool
        Something that stretches is in series with the drive that the file knows.
    drifts : bool
        The load cell's zero drifts, in every recording at one rate.
    changes : bool
        Friction changes along the way, in every recording its own way.
    """

    stretches: bool = False
    falls: bool = False
    smoothly: bool = False
    softer: bool = False
    drifts: bool = False
    changes: bool = False

    @property
    def parts(self) -> frozenset[str]:
        """What it has."""
        return frozenset(name for name, there in vars(self).items() if there)


@dataclass(frozen=True)
class Unknown:
    """A shared unknown: its coordinate is ``value``, or the logarithm of it."""

    name: str
    mean: float
    std: float
    logarithmic: bool = False

    def value(self, at: float) -> float:
        return math.exp(at) if self.logarithmic else at


@dataclass(frozen=True, eq=False)
class Blocks:
    """Pulls of one block under one shape of model.

    Parameters
    ----------
    logs : tuple of PulledLog
    moments : tuple of (k,) float [s]
        Of letting go, as found in each log.
    mass : float [kg]
    shape : Shape
    shared : tuple of Unknown
    spread : float [N]
        Of the forces of letting go.
    drive : float [N/m]
        Stiffness that the file knows.
    """

    logs: tuple[PulledLog, ...]
    moments: tuple[Array, ...]
    mass: float
    shape: Shape
    shared: tuple[Unknown, ...]
    spread: float
    drive: float = math.inf

    @property
    def weight(self) -> float:
        """Of the block [N]."""
        return self.mass * GRAVITY

    def values(self, shared: Array) -> dict[str, float]:
        """Numbers by their keys."""
        found = {u.name: u.value(float(at)) for u, at in zip(self.shared, shared, strict=True)}
        found[STATIC] = found[KINETIC] + found.pop("fall", 0.0)
        if SERIES in found:
            found[STIFFNESS] = 1.0 / (1.0 / self.drive + 1.0 / found[SERIES])
        if STIFFNESS in found:
            found[DAMPING] = 2.0 * found.pop("ratio") * math.sqrt(found[STIFFNESS] * self.mass)
        return found

    def own_start(self, index: int) -> Array:
        """Coordinates of a recording: start of the drive, zero, moments, level."""
        log = self.logs[index]
        moments = self.moments[index] if self.shape.falls else np.zeros(0)
        level = self.level_start(index) if self.shape.changes else np.zeros(0)
        return np.concatenate([[self._starts(log), log.rests], moments, level])

    def _starts(self, log: PulledLog) -> float:
        """Of the drive, or where it is taken as rigid, of the force [s]."""
        return log.starts if self.shape.stretches else log.jumps

    def level_start(self, index: int) -> Array:
        """How the force goes on along the way once the block slides, (KNOTS,) float [N] about the load of all."""
        log = self.logs[index]
        slides = log.time - log.time[0] > self.moments[index][0]
        place = (log.head - log.head[0]) / max(float(log.head[-1] - log.head[0]), 1e-300) * (KNOTS - 1)
        hats = np.maximum(1.0 - np.abs(place[:, None] - np.arange(KNOTS)), 0.0)
        rest = log.force - log.rests - self.weight * next(u.mean for u in self.shared if u.name == KINETIC)
        design, wanted = np.vstack([hats[slides], 1e-3 * np.eye(KNOTS)]), np.r_[rest[slides], np.zeros(KNOTS)]
        level: Array = np.linalg.lstsq(design, wanted, rcond=None)[0]
        return level

    def own_prior(self, index: int) -> tuple[Array, Array]:
        """Means and standard deviations of them; of moments where no force of letting go says more."""
        log = self.logs[index]
        span = float(log.time[-1] - log.time[0])
        moments = self.moments[index] if self.shape.falls else np.zeros(0)
        usual = float(np.median(np.diff(moments))) if len(moments) > 1 else span
        level = np.full(KNOTS if self.shape.changes else 0, 0.3 * log.load)
        mean = np.concatenate([[self._starts(log), log.rests], moments, np.zeros(len(level))])
        return mean, np.r_[span, 0.3 * log.load, np.full(len(moments), usual), level]

    def static_at(self, index: int, values: Mapping[str, float], own: Array) -> Array:
        """Static friction at the moments of letting go, (k,) float [N]."""
        log, moments = self.logs[index], own[self.let_go(index)]
        level = np.full(len(moments), values[STATIC] * self.weight)
        if self.shape.changes:
            heads = np.interp(moments, log.time - log.time[0], log.head)
            level += np.interp(heads, np.linspace(log.head[0], log.head[-1], KNOTS), own[-KNOTS:])
        return level

    def let_go(self, index: int) -> slice:
        """Which of a recording's coordinates are moments of letting go."""
        return slice(2, 2 + (len(self.moments[index]) if self.shape.falls else 0))

    def simulated(self, index: int, values: Mapping[str, float], own: Array) -> tuple[Array, Array]:
        """Force of a recording, (n,) float [N], and the forces at which the block was let go."""
        log, shape = self.logs[index], self.shape
        head, elapsed = log.head, log.time - log.time[0]
        slack = float(np.interp(own[0], elapsed, head))
        # the start lies between samples
        moved = np.maximum(head - slack, 0.0)
        level = np.full(len(head), values[KINETIC] * self.weight)
        if shape.changes:
            level = level + np.interp(head, np.linspace(head[0], head[-1], KNOTS), own[-KNOTS:])
        zero = own[1] + values.get(DRIFT, 0.0) * elapsed
        if not shape.stretches:
            return zero + np.where(moved > 0.0, level, 0.0), np.zeros(0)
        moments = own[self.let_go(index)]
        excess = (values[STATIC] - values[KINETIC]) * self.weight
        force, tops = pull(
            self.mass, values[STIFFNESS], values[DAMPING], level, max(excess, 0.0), moved, log.step, moments,
            values.get(FALLING, 0.0),
        )  # fmt: skip
        return force + zero, tops[: len(moments)]


def shared_unknowns(parameters: ParameterSet, logs: Sequence[PulledLog], shape: Shape, weight: float) -> list[Unknown]:
    """What all recordings have in common, with what is known of it beforehand.

    A file in which both frictions are one number knows one friction, and a drive that it calls stiff, none.
    """
    load = float(np.median([log.load for log in logs])) / weight
    kinetic, static = parameters.get(KINETIC), parameters.get(STATIC)
    one = kinetic is None or static is None or float(kinetic.value) == float(static.value)
    known = kinetic if kinetic is not None and kinetic.std and not one else None
    found = [Unknown(KINETIC, float(known.value), float(known.std or 1.0)) if known else Unknown(KINETIC, load, 1.0)]
    if one and kinetic is not None and kinetic.std:
        found[0] = Unknown(KINETIC, float(kinetic.value), float(kinetic.std))
    if shape.falls:
        fall = 0.0 if one else float(static.value) - float(kinetic.value)  # type: ignore[union-attr]
        both = None if one else [e.std for e in (static, kinetic) if e is not None]
        std = math.hypot(*both) if both and all(both) else 0.5  # type: ignore[arg-type]
        found.append(Unknown("fall", fall, std))
        if shape.smoothly:
            found.append(_falling(parameters, float(np.median([log.speed for log in logs]))))
    if shape.drifts:
        longest = max(float(log.time[-1] - log.time[0]) for log in logs)
        found.append(Unknown(DRIFT, 0.0, load * weight / longest))
    if shape.stretches:
        given = parameters.get(STIFFNESS)
        guess = float(np.median([log.rise / log.speed for log in logs]))
        mean, std = math.log(guess), 3.0
        if given is not None and math.isfinite(float(given.value)):
            mean, std = math.log(float(given.value)), float(given.std or 3.0 * float(given.value)) / float(given.value)
        found.append(Unknown(SERIES, mean, 3.0, True) if shape.softer else Unknown(STIFFNESS, mean, std, True))
        damping = parameters.get(DAMPING)
        ratio, width = math.log(0.03), 2.0
        if damping is not None and float(damping.value) > 0.0:
            mass = parameters.number("mass_kg")
            ratio = math.log(float(damping.value) / (2.0 * math.sqrt(math.exp(mean) * mass)))
            width = float(damping.std or 3.0 * float(damping.value)) / float(damping.value)
        found.append(Unknown("ratio", ratio, width, logarithmic=True))
    return found


def _falling(parameters: ParameterSet, pulled: float) -> Unknown:
    """Over which speed friction falls: as the file has it, else about the speed of the pulls [m/s]."""
    given = parameters.effects.get("stribeck", {}).get(FALLING)
    if given is None:
        return Unknown(FALLING, math.log(pulled), 2.0, logarithmic=True)
    value = float(given.value)
    std = HELD if given.fixed else float(given.std or 2.0 * value) / value
    return Unknown(FALLING, math.log(value), std, logarithmic=True)
