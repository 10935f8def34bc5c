"""Which physics the pulls of a block ask for: every shape of model beside the file's own, each by its evidence."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np

from ssmr_ident.core.parameter import ParameterSet
from ssmr_ident.experiments.campaign import Measurement
from ssmr_ident.identify.blocks.fit import Fitted, begun, fitted, height, with_scatter
from ssmr_ident.identify.blocks.log import PulledLog, pulled_log
from ssmr_ident.identify.blocks.model import (
    FALLING,
    KINETIC,
    SCATTER,
    STATIC,
    STIFFNESS,
    Blocks,
    Shape,
    shared_unknowns,
)
from ssmr_ident.identify.blocks.teeth import moments
from ssmr_ident.physics.robot import GRAVITY
from ssmr_ident.signals.metrics import nrmse_percent

Array = np.ndarray

CERTAIN = 20.0
"""Natural log of the odds from which a richer model stands beside a poorer one."""

ROUGH = 0.02
"""Of the load: what a model need not explain while it is looked for."""

GROWING = (2, 4, 7)
"""Teeth that are fitted first: where a block stands tells of all that was before, and a long way has many hollows."""

MOST_TEETH = 12
"""That a recording is read up to: what follows tells the same again, and where it is let go, chance decides."""

MORE = "drifts", "changes"
"""What else may be there."""

WORTH = 1.1
"""Times the white noise that has to be left before friction is taken to change along the way."""


@dataclass(frozen=True, eq=False)
class Pulls:
    """Logs of one block with what was found in each before any fit.

    Parameters
    ----------
    logs : tuple of PulledLog
        Up to ``MOST_TEETH`` teeth.
    moments : tuple of (k,) float [s]
    mass : float [kg]
    teeth : tuple of int
        Of the whole logs.
    """

    logs: tuple[PulledLog, ...]
    moments: tuple[Array, ...]
    mass: float
    teeth: tuple[int, ...]

    def first(self, count: int) -> Pulls:
        """Up to so many teeth of each."""
        logs, moments = [], []
        for log, own in zip(self.logs, self.moments, strict=True):
            cut = len(own) > count
            logs.append(log.until(round(float(own[count] + own[count - 1]) / 2.0 / log.step)) if cut else log)
            moments.append(own[:count])
        return Pulls(tuple(logs), tuple(moments), self.mass, self.teeth)

    def only(self, index: int) -> Pulls:
        return Pulls(self.logs[index : index + 1], self.moments[index : index + 1], self.mass, self.teeth[index:][:1])


def pulls_of(measurements: Sequence[Measurement], mass: float) -> Pulls:
    """Read the logs of a block's pulls.

    Raises
    ------
    InputError
        A log without a force, or without a speed.
    """
    logs, found, teeth = [], [], []
    for measurement in measurements:
        log = pulled_log(measurement)
        own = moments(log)
        teeth.append(len(own) if len(own) > 2 else 0)
        if len(own) > MOST_TEETH:
            end = round(float(own[MOST_TEETH] + own[MOST_TEETH - 1]) / 2.0 / log.step)
            log, own = log.until(end), own[:MOST_TEETH]
        logs.append(log)
        found.append(own)
    return Pulls(tuple(logs), tuple(found), mass, tuple(teeth))


def known_shape(parameters: ParameterSet) -> Shape:
    """What the file already has: a drive with a stiffness, and two frictions."""
    stiffness = parameters.number(STIFFNESS, math.inf)
    if "cable_compliance" in parameters.effects:
        stiffness = 0.0
    static, kinetic = parameters.get(STATIC), parameters.get(KINETIC)
    two = static is not None and kinetic is not None and float(static.value) != float(kinetic.value)
    falls = (two or "stribeck" in parameters.effects) and math.isfinite(stiffness)
    over = parameters.effects.get("stribeck", {}).get(FALLING)
    return Shape(math.isfinite(stiffness), falls, falls and over is not None and not over.fixed)


def searched(pulls: Pulls, parameters: ParameterSet, base: Shape) -> tuple[list[Fitted], tuple[float, ...]]:
    """Every model from the base on, poorest first, and the noise that they are weighed by [N] of each log.

    What no model explains is not white, and counts as noise: else the richest would always be right.
    """
    white = [log.noise for log in pulls.logs]
    rough = [max(n, ROUGH * log.load) for n, log in zip(white, pulls.logs, strict=True)]
    found: dict[Shape, Fitted] = {}

    def fit(*shapes: Shape) -> None:
        for shape in (s for s in shapes if s not in found):
            found[shape] = _fit(pulls, parameters, shape, rough, found)

    stretched = replace(base, stretches=True)
    fit(base, stretched)
    if min(_over(f, white) for f in found.values()) > WORTH:
        fit(*(replace(s, **{more: True}) for more in MORE for s in (base, stretched)))
    if base.stretches or _stretches(found):
        last = stretched
        if not base.falls:
            falls = replace(stretched, falls=True)
            last = smoothly = replace(falls, smoothly=True)
            fit(falls, smoothly)
        given = parameters.get(STIFFNESS)
        if base.stretches and given is not None and given.std and not given.fixed:
            fit(*(replace(s, softer=True) for s in (base, last)))
        if not base.falls and not found[smoothly].cost < found[falls].cost - 2.0 * CERTAIN:
            last = falls
        if min(_over(f, white) for f in found.values()) > WORTH:
            fit(*(replace(last, **{more: True}) for more in MORE))
    best = min(found.values(), key=lambda f: _over(f, white))
    noise = tuple(max(n, float(np.std(best.left(k)))) for k, n in enumerate(white))
    final = [_again(f, noise) for f in found.values()]
    return [_offered(f, final, noise) for f in final], noise


def _stretches(found: Mapping[Shape, Fitted]) -> bool:
    """Whether a drive stretches: beside what else the best model has, it is certainly better for it. Friction that
    falls shows behind such a drive alone."""
    best = min(found, key=lambda shape: found[shape].cost)
    rigid, stretched = (found[replace(best, stretches=stretches)] for stretches in (False, True))
    return stretched.cost < rigid.cost - 2.0 * CERTAIN


def chosen(found: Sequence[Fitted]) -> Fitted:
    """The poorest model that no richer one is certainly better than."""
    best = max(found, key=lambda f: f.log_evidence)
    while True:
        poorer = [
            f for f in found
            if f.blocks.shape.parts < best.blocks.shape.parts and f.log_evidence > best.log_evidence - CERTAIN
        ]  # fmt: skip
        if not poorer:
            return best
        best = min(poorer, key=lambda f: len(f.blocks.shape.parts))


def held(found: Fitted, pulls: Pulls) -> list[Fitted]:
    """The same model on other recordings, one by one: its shared unknowns stay, their own are found."""
    away = _let_go_before(found)
    return [alone(found.blocks, found.shared, pulls.only(index), away) for index in range(len(pulls.logs))]


def alone(blocks: Blocks, shared: Array, pulls: Pulls, away: float) -> Fitted:
    """A recording's own unknowns under shared ones that stay, over more and more teeth, which are let go where they
    were found or ``away`` [s] from there."""
    noise = [max(log.noise, ROUGH * log.load) for log in pulls.logs]
    tried = [_growing(blocks, shared, pulls, noise, shift) for shift in sorted({0.0, away})]
    return min(tried, key=lambda f: f.cost)


def _growing(blocks: Blocks, shared: Array, pulls: Pulls, noise: Sequence[float], shift: float) -> Fitted:
    parts = [pulls.first(count) for count in _counts(pulls, blocks.shape)]
    blocks = replace(blocks, logs=parts[0].logs, moments=parts[0].moments)
    own = blocks.own_start(0)
    own[blocks.let_go(0)] += shift
    fit = fitted(blocks, noise, (shared, [own]), held=True)
    for part in parts[1:]:
        fit = fitted(replace(blocks, logs=part.logs, moments=part.moments), noise, _longer(fit, part), held=True)
    return fit


def _counts(pulls: Pulls, shape: Shape) -> list[int]:
    """Teeth that are fitted at first, and then, up to all."""
    most = max(len(own) for own in pulls.moments)
    return [*(count for count in GROWING if count < most and shape.falls), most]


def _let_go_before(found: Fitted) -> float:
    """By how much a fit lets the block go from where the force falls [s]; 0 where it does not."""
    if not found.blocks.shape.falls:
        return 0.0
    away = [own[found.blocks.let_go(k)] - found.blocks.moments[k] for k, own in enumerate(found.own)]
    return float(np.median(np.concatenate(away)))


def _offered(poorer: Fitted, all_of_them: Sequence[Fitted], noise: Sequence[float]) -> Fitted:
    """A model, or what is left of a better one that has all that it has, led on from there."""
    shape = poorer.blocks.shape
    way = shape.stretches, shape.falls
    alike = [f for f in all_of_them if (f.blocks.shape.stretches, f.blocks.shape.falls) == way]
    richer = [f for f in alike if shape.parts < f.blocks.shape.parts]
    best = max(richer, key=lambda f: f.log_evidence, default=poorer)
    if not best.log_evidence > poorer.log_evidence:
        return poorer
    there = dict(zip((u.name for u in best.blocks.shared), best.shared, strict=True))
    there.setdefault(STIFFNESS, math.log(best.values.get(STIFFNESS, 1.0)))
    shared = [there[u.name] for u in poorer.blocks.shared]
    own = [o[: len(p)] for o, p in zip(best.own, poorer.own, strict=True)]
    blocks = replace(poorer.blocks, spread=best.blocks.spread)
    return max(poorer, fitted(blocks, noise, (np.array(shared), own)), key=lambda f: f.log_evidence)


def blocks_of(pulls: Pulls, parameters: ParameterSet, shape: Shape) -> Blocks:
    """A model of the pulls before any fit."""
    shared = tuple(shared_unknowns(parameters, pulls.logs, shape, pulls.mass * GRAVITY))
    spread = SCATTER * height(pulls.logs, pulls.moments, pulls.mass)
    drive = parameters.number(STIFFNESS, math.inf)
    return Blocks(pulls.logs, pulls.moments, pulls.mass, shape, shared, spread, drive)


def error(found: Fitted, index: int) -> float:
    """NRMSE of a recording [%]."""
    log = found.blocks.logs[index]
    return nrmse_percent(log.force[:, None], found.simulated[index][:, None], 1.0 / log.step, low_pass_hz=None)


def _fit(
    pulls: Pulls, parameters: ParameterSet, shape: Shape, noise: Sequence[float], found: dict[Shape, Fitted]
) -> Fitted:
    poorer = [f for s, f in found.items() if s.stretches and s.parts <= shape.parts]
    like = min(poorer, key=lambda f: f.cost, default=None)
    if not shape.falls:
        return begun(blocks_of(pulls, parameters, shape), noise, like)
    counts = _counts(pulls, shape)
    fit = begun(blocks_of(pulls.first(counts[0]), parameters, shape), noise, like)
    for count in counts[1:]:
        fit = fitted(blocks_of(pulls.first(count), parameters, shape), noise, _longer(fit, pulls.first(count)))
    return with_scatter(_each_anew(fit, noise), noise)


def _each_anew(found: Fitted, noise: Sequence[float]) -> Fitted:
    """All recordings once more, those that are followed better alone, from their own begin, begun as they are there."""
    own, blocks = list(found.own), found.blocks
    for index in range(len(own)):
        one = replace(blocks, logs=blocks.logs[index : index + 1], moments=blocks.moments[index : index + 1])
        now, anew = (
            fitted(one, noise[index : index + 1], (found.shared, [begin]), held=True)
            for begin in (own[index], one.own_start(0))
        )
        if anew.cost < now.cost:
            own[index] = anew.own[0]
    return min(found, fitted(blocks, noise, (found.shared, own)), key=lambda f: f.cost)


def _longer(found: Fitted, pulls: Pulls) -> tuple[Array, list[Array]]:
    """A fit of the first teeth as a start for more of them: they are let go as much before the fall as those were."""
    blocks, starts = found.blocks, []
    longer = replace(blocks, logs=pulls.logs, moments=pulls.moments)
    for k, own in enumerate(found.own):
        known = own[blocks.let_go(k)]
        further = pulls.moments[k][len(known) :] + float(np.median(known - blocks.moments[k]))
        level = longer.level_start(k) if blocks.shape.changes else np.zeros(0)
        starts.append(np.concatenate([own[:2], known, further, level]))
    return found.shared, starts


def _again(found: Fitted, noise: Sequence[float]) -> Fitted:
    return fitted(found.blocks, noise, (found.shared, found.own))


def _over(found: Fitted, white: Sequence[float]) -> float:
    """RMS of what is left over the white noise."""
    ratios = [float(np.mean(found.left(k) ** 2)) / n**2 for k, n in enumerate(white)]
    return math.sqrt(float(np.mean(ratios)))
