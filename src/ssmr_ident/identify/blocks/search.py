"""Which physics the pulls of a block ask for: every shape of model beside the file's own, each by its evidence."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from ssmr_ident.core.parameter import ParameterSet
from ssmr_ident.experiments.campaign import Measurement
from ssmr_ident.identify.blocks.fit import Fitted, begun, fitted, height, with_scatter
from ssmr_ident.identify.blocks.log import PulledLog, pulled_log
from ssmr_ident.identify.blocks.model import KINETIC, SCATTER, STATIC, STIFFNESS, Blocks, Shape, shared_unknowns
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
    return Shape(math.isfinite(stiffness), (two or "stribeck" in parameters.effects) and math.isfinite(stiffness))


def searched(pulls: Pulls, parameters: ParameterSet, base: Shape) -> tuple[list[Fitted], tuple[float, ...]]:
    """Every model from the base on, poorest first, and the noise that they are weighed by [N] of each log.

    What no model explains is not white, and counts as noise: else the richest would always be right.
    """
    white = [log.noise for log in pulls.logs]
    rough = [max(n, ROUGH * log.load) for n, log in zip(white, pulls.logs, strict=True)]
    plain = [s for s in _all_shapes() if base.parts <= s.parts]
    found: dict[Shape, Fitted] = {}
    for shape in plain:
        found[shape] = _fit(pulls, parameters, shape, rough, found)
    given = parameters.get(STIFFNESS)
    if base.stretches and given is not None and given.std and not given.fixed:
        for shape in list(found):
            found[replace(shape, softer=True)] = _fit(pulls, parameters, replace(shape, softer=True), rough, found)
    if min(_over(f, white) for f in found.values()) > WORTH:
        for shape in (replace(s, **{more: True}) for more in ("drifts", "changes") for s in plain):
            found[shape] = _fit(pulls, parameters, shape, rough, found)
    best = min(found.values(), key=lambda f: _over(f, white))
    noise = tuple(max(n, float(np.std(best.left(k)))) for k, n in enumerate(white))
    final = [_again(f, noise) for f in found.values()]
    return final, noise


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
    results = []
    for index, log in enumerate(pulls.logs):
        one = pulls.only(index)
        blocks = replace(found.blocks, logs=one.logs, moments=one.moments)
        results.append(
            fitted(blocks, [max(log.noise, ROUGH * log.load)], (found.shared, [blocks.own_start(0)]), held=True)
        )
    return results


def blocks_of(pulls: Pulls, parameters: ParameterSet, shape: Shape) -> Blocks:
    """A model of the pulls before any fit."""
    shared = tuple(shared_unknowns(parameters, pulls.logs, shape, pulls.mass * GRAVITY))
    spread = SCATTER * height(pulls.logs, pulls.moments, pulls.mass)
    return Blocks(pulls.logs, pulls.moments, pulls.mass, shape, shared, spread)


def error(found: Fitted, index: int) -> float:
    """NRMSE of a recording [%]."""
    log = found.blocks.logs[index]
    return nrmse_percent(log.force[:, None], found.simulated[index][:, None], 1.0 / log.step, low_pass_hz=None)


def _all_shapes() -> list[Shape]:
    """Without what changes; friction that falls shows behind a drive that stretches alone."""
    return [Shape(), Shape(stretches=True), Shape(stretches=True, falls=True)]


def _fit(
    pulls: Pulls, parameters: ParameterSet, shape: Shape, noise: Sequence[float], found: dict[Shape, Fitted]
) -> Fitted:
    like = [f for s, f in found.items() if s.stretches and s.parts <= shape.parts]
    if not shape.falls:
        return begun(blocks_of(pulls, parameters, shape), noise, like[-1] if like else None)
    most = max(len(own) for own in pulls.moments)
    counts = [count for count in GROWING if count < most] + [most]
    fit = begun(blocks_of(pulls.first(counts[0]), parameters, shape), noise, like[-1] if like else None)
    for count in counts[1:]:
        fit = fitted(blocks_of(pulls.first(count), parameters, shape), noise, _longer(fit, pulls.first(count)))
    return with_scatter(fit, noise)


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
