"""Every start of every explanation, cheaply: where the baseline is, and where slopes say that it goes beside each."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace

import numpy as np

from ssmr_ident.doctor.swivels.anchor import Anchor
from ssmr_ident.doctor.swivels.candidates import Candidate, Values
from ssmr_ident.doctor.swivels.conditions import Condition
from ssmr_ident.doctor.swivels.ensemble import LARGEST, TAU_DB
from ssmr_ident.doctor.swivels.explained import Explained, cost, explained
from ssmr_ident.doctor.swivels.likelihood import NEPER_DB, score, weight_of

FOLLOWED = 2  # starts of an explanation that are simulated on all
ROUNDS = 3  # in which the weight follows what is left


def screened(
    places: Sequence[tuple[Anchor, np.ndarray | None]],
    candidate: Candidate,
    targets: tuple[Condition, ...],
    advance: Callable[[], None],
) -> list[tuple[float, Explained]]:
    """The best starts of an explanation, with what they gain over the baseline at their place; best first.

    Parameters
    ----------
    places : sequence of (Anchor, (n, p) float or None)
        Baselines to be beside, with slopes of the targets' residuals over their parameters where they were fitted on
        the targets: what such a baseline took up of an effect, it gives back.
    candidate : Candidate
    targets : tuple of Condition
    advance : callable
        Called once.
    """
    few, rows = _spread(targets, places[0][0])
    found: list[tuple[float, Explained]] = []
    for anchor, slopes in places:
        once, part = replace(anchor, seeds=anchor.seeds[:1]), None if slopes is None else slopes[rows]
        jobs = ((c, once.values, candidate.effects(s), once.seeds[0]) for s in candidate.starts for c in few)
        anchor.bench.prefetch(jobs)
        promised = []
        for start in candidate.starts:
            promise = _promise(once, candidate, start, few, part)
            if promise is not None:
                promised.append((promise, start))
        promised.sort(key=lambda one: one[0][0], reverse=True)
        chosen = [(replace(anchor, z=z), start) for (_, z), start in promised[:FOLLOWED]]
        jobs = ((c, at.values, candidate.effects(s), seed) for at, s in chosen for c in targets for seed in at.seeds)
        anchor.bench.prefetch(jobs)
        ended = [one for at, start in chosen if (one := explained(at, candidate, start, targets)) is not None]
        alone = explained(anchor, None, {}, targets)
        found += [(one.evidence - alone.evidence, one) for one in ended if alone is not None]
    advance()
    return sorted(found, key=lambda one: one[0], reverse=True)


def _spread(targets: tuple[Condition, ...], anchor: Anchor) -> tuple[tuple[Condition, ...], np.ndarray]:
    """The slowest and the fastest, and which residuals are theirs."""
    order = np.argsort([abs(c.turning) for c in targets])
    chosen = list(dict.fromkeys((int(order[0]), int(order[-1]))))
    sizes = [c.mean.log_density(anchor.scale).size for c in targets]
    ends = np.cumsum([0, *sizes])
    rows = np.concatenate([np.arange(ends[i], ends[i + 1]) for i in chosen])
    return tuple(targets[i] for i in chosen), rows


def given_way(anchor: Anchor, residual: np.ndarray, slopes: np.ndarray) -> np.ndarray:
    """Where the baseline goes to first order, (p,) float, to take up what it can of a residual, (n,) float."""
    residual = np.clip(residual, -LARGEST, LARGEST)
    change = np.zeros_like(anchor.z)
    for _ in range(ROUNDS):
        left = residual + slopes @ change
        weight = weight_of(float(np.clip(NEPER_DB * np.sqrt(np.mean(left**2)), *TAU_DB)))
        pull = weight * slopes.T @ residual + anchor.z
        change = -np.linalg.solve(weight * slopes.T @ slopes + np.eye(len(anchor.z)), pull)
    return anchor.z + change


def _promise(
    anchor: Anchor, candidate: Candidate, start: Values, conditions: tuple[Condition, ...], slopes: np.ndarray | None
) -> tuple[float, np.ndarray] | None:
    """Evidence to first order of an explanation beside the baseline that gives way, and where that goes."""
    effects = candidate.effects(start)
    if slopes is None:
        found = anchor.score(conditions, effects)
        return None if found is None else (found[0].log_likelihood - cost(candidate, conditions), anchor.z)
    blocks = anchor.blocks(conditions, effects, 0.0)
    if blocks is None:
        return None
    moved = replace(anchor, z=given_way(anchor, np.concatenate([block.residual for block in blocks]), slopes))
    taken = slopes @ (moved.z - anchor.z)
    ends = np.cumsum([len(block.residual) for block in blocks])[:-1]
    left = [
        replace(block, residual=block.residual + part)
        for block, part in zip(blocks, np.split(taken, ends), strict=True)
    ]
    return score([[block] for block in left]).log_likelihood + moved.log_prior() - cost(candidate, conditions), moved.z
