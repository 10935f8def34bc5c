"""The baseline by itself: from a grid over what no file knows, then by an ensemble, under each law of contact."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np

from ssmr_ident.core.parameter import ParameterSet
from ssmr_ident.doctor.swivels.anchor import Anchor, Prior, priors_of
from ssmr_ident.doctor.swivels.bench import Bench
from ssmr_ident.doctor.swivels.conditions import Condition
from ssmr_ident.doctor.swivels.ensemble import Ensemble
from ssmr_ident.doctor.swivels.explained import explained
from ssmr_ident.doctor.swivels.likelihood import Score
from ssmr_ident.physics.robot import contact_named

LAWS = {"cone": "Coulomb's cone, both axes together", "relay": "a relay on each axis (6.4)"}
FIRST, LAST = 2, 8  # rounds after which the laws are compared, and more of them at most
REACH = 150.0  # of evidence that rounds may add: what lies further behind is not led on
GRID = ((-1.8, -0.9, 0.0, 0.9, 1.8), (-1.5, 0.0, 1.5))
"""Sliding speeds and heights of the floor's grain that a search begins from, in standard deviations."""


@dataclass(frozen=True, eq=False)
class Fitted:
    """A baseline as far as it was fitted.

    Parameters
    ----------
    ensemble : Ensemble
    places : tuple of (Anchor, (n, p) float)
        Where it ended, and where it began, not bent by what is missing; with slopes there.
    notes : tuple of str
    """

    ensemble: Ensemble
    places: tuple[tuple[Anchor, np.ndarray | None], ...]
    notes: tuple[str, ...]


def fitted_baseline(
    known: ParameterSet,
    conditions: tuple[Condition, ...],
    scale: np.ndarray,
    floors: tuple[int, ...],
    seed: int,
    advance: Callable[[], None],
) -> Fitted:
    """The baseline under the law that the file names, or under that which the recordings prefer, and a note on which.

    Parameters
    ----------
    known : ParameterSet
    conditions : tuple of Condition
        That it is fitted on.
    scale : (c,) float [m/s^2]
    floors : tuple of int
        Over which places are compared.
    seed : int
        Of the draws.
    advance : callable
        Called once per round.
    """
    if contact_named(known):
        benches = [Bench(known)]
    else:
        benches = [Bench(replace(known, choices={**known.choices, "tire.contact": law})) for law in LAWS]
    ended = [_begun(bench, conditions, scale, floors, seed) for bench in benches]
    begun = [one.now.anchor for one in ended]
    for number in range(FIRST):
        for one in ended:
            one.advance()
        if number == 0:
            early = {id(one): (anchor, one.slopes) for one, anchor in zip(ended, begun, strict=True)}
        advance()
    level = max(one.now.evidence for one in ended) - REACH
    alive = [one for one in ended if one.now.evidence > level]
    for one in alive:
        one.settle(LAST, advance if one is alive[0] else lambda: None)
    best = max(alive, key=lambda one: one.now.evidence)
    places = ((best.now.anchor, best.slopes), early[id(best)])
    if len(ended) == 1:
        return Fitted(best, places, ())
    apart = ", ".join(
        f"{words} to {one.now.target.rms_db:.1f} dB (log likelihood {one.now.target.log_likelihood:.0f})"
        for one, words in zip(ended, LAWS.values(), strict=True)
    )
    chosen = best.now.anchor.bench.parameters.choices["tire.contact"]
    note = f"the file names no law of contact; the baseline comes under {apart}: {chosen} is taken"
    return Fitted(best, places, (note,))


def _begun(
    bench: Bench, conditions: tuple[Condition, ...], scale: np.ndarray, floors: tuple[int, ...], seed: int
) -> Ensemble:
    """An ensemble about the best place of a grid over what files do not know."""
    priors = priors_of(bench.parameters)
    nowhere = Score(-np.inf, 0.0, 0.0)
    free = Anchor(bench, scale, priors, np.zeros(len(priors)), (), nowhere, floors)
    places = [replace(free, z=z, seeds=floors[:1]) for z in _grid(priors)]
    bench.prefetch((c, at.values, {}, seed) for at in places for c in conditions for seed in at.seeds)
    found = [one for at in places if (one := explained(at, None, {}, conditions)) is not None]
    if not found:
        raise FloatingPointError("no values within the priors make a robot that can be simulated")
    best = max(found, key=lambda one: one.evidence)
    return Ensemble(replace(best, anchor=replace(best.anchor, seeds=floors)), conditions, floors, seed)


def _grid(priors: tuple[Prior, ...]) -> list[np.ndarray]:
    index = {p.path: i for i, p in enumerate(priors)}
    grid = []
    for speed in GRID[0]:
        for floor in GRID[1]:
            z = np.zeros(len(priors))
            for path, shift in (("tire.sliding_speed_m_s", speed), ("floor.height_m", floor)):
                if path in index:
                    z[index[path]] = shift
            grid.append(z)
    return list({tuple(z): z for z in grid}.values())
