"""Explanations beside a baseline that gives way: what it took up of an effect, it may give back.

Fitted on the targets themselves, a baseline bends itself round what is missing. Beside the effect its values are then
the wrong ones, and the effect that acts may look worse than the baseline alone. How spectra change with the baseline's
parameters is simulated once, without any effect; to first order that says where the baseline goes beside each of
the explanations, for the price of one simulation of theirs.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import numpy as np

from ssmr_ident.diagnose.turning.anchor import Anchor, as_columns
from ssmr_ident.diagnose.turning.bench import COARSE
from ssmr_ident.diagnose.turning.candidates import Candidate, Values
from ssmr_ident.diagnose.turning.conditions import Condition
from ssmr_ident.diagnose.turning.likelihood import NEPER_DB, score, weight_of
from ssmr_ident.diagnose.turning.search import Explained, cost, explained

DIFFERENCE = 0.7  # standard deviations of the prior; spectra of chaotic runs are no smooth functions of less
LARGEST = 3.0  # of a residual, natural logarithm: beyond it densities differ by nothing that a slope describes
TAU_DB = (0.8, 6.0)
ROUNDS = 3  # of least squares, each with the model's own error that the last one left
RANKED_ON = 4  # target conditions, the speeds as far apart as there are, by which starts are ranked
FOLLOWED = 2  # starts of each explanation that are simulated where the baseline goes


def ranked_on(targets: tuple[Condition, ...]) -> tuple[Condition, ...]:
    """Up to four target conditions over the range of speeds."""
    order = sorted(targets, key=lambda c: abs(c.turning))
    chosen = np.unique(np.linspace(0, len(order) - 1, min(RANKED_ON, len(order))).round().astype(int))
    return tuple(order[i] for i in chosen)


def slopes_alone(anchor: Anchor, targets: tuple[Condition, ...]) -> np.ndarray | None:
    """(n, p) float: of the residuals at the speeds ranked on, over the baseline's parameters, no effect acting."""
    targets = ranked_on(targets)
    coarse = replace(anchor, seeds=anchor.seeds[:1], step=COARSE)
    ahead = [anchor.z + DIFFERENCE * (np.arange(len(anchor.z)) == i) for i in range(len(anchor.z))]
    places = [anchor.at(z) for z in (anchor.z, *ahead)]
    anchor.bench.prefetch(((c, at, {}, seed) for at in places for c in targets for seed in coarse.seeds), COARSE)
    residuals = [_residual(coarse, targets, {}, at) for at in places]
    base = residuals[0]
    if base is None:
        return None
    found = [np.zeros_like(base) if r is None else (r - base) / DIFFERENCE for r in residuals[1:]]
    return as_columns(found, len(base))


def given_way(z: np.ndarray, residual: np.ndarray, slopes: np.ndarray) -> np.ndarray:
    """Where the baseline goes to first order from ``z``, (p,) float, to take up what it can of a residual, (n,) float.

    Half a unit is asked for, and four densities are little to ask by against what is known beforehand:

    >>> given_way(np.zeros(1), np.array([0.5, -0.5, 0.5, -0.5]), np.array([[-1.0], [1.0], [-1.0], [1.0]])).round(2)
    array([0.44])
    """
    residual = np.clip(residual, -LARGEST, LARGEST)
    change = np.zeros_like(z)
    for _ in range(ROUNDS):
        left = residual + slopes @ change
        tau = float(np.clip(NEPER_DB * np.sqrt(np.mean(left**2)), *TAU_DB))
        weight = weight_of(tau)
        change = np.linalg.solve(
            weight * slopes.T @ slopes + np.eye(len(z)), -weight * slopes.T @ residual - z
        )  # fmt: skip
    return z + change


def screened_giving(
    anchor: Anchor, candidate: Candidate, targets: tuple[Condition, ...], slopes: np.ndarray,
    advance: Callable[[], None],
) -> list[Explained]:  # fmt: skip
    """The best starts of an explanation with the baseline where it goes beside each, best first.

    All starts are ranked by what slopes promise; the best of them are simulated where the baseline went, and where it
    was.
    """
    coarse, few = replace(anchor, seeds=anchor.seeds[:1], step=COARSE), ranked_on(targets)
    anchor.bench.prefetch(
        ((c, anchor.values, candidate.effects(start), seed)
         for start in candidate.starts for c in few for seed in coarse.seeds), COARSE,
    )  # fmt: skip
    promised = []
    for i, start in enumerate(candidate.starts):
        found = _promise(coarse, candidate, start, few, slopes)
        if found is not None:
            promised.append((found[0], i, found[1]))
    advance()
    promised.sort(key=lambda one: one[0], reverse=True)
    places = [
        (replace(anchor, z=z), candidate.starts[i])
        for _, i, gone in promised[:FOLLOWED] for z in (gone, anchor.z)
    ]  # fmt: skip
    anchor.bench.prefetch(
        (c, at.values, candidate.effects(start), seed) for at, start in places for c in targets for seed in at.seeds
    )
    found_at = [one for at, start in places if (one := explained(at, candidate, start, targets)) is not None]
    advance()
    best: dict[tuple, Explained] = {}
    for one in found_at:
        key = tuple(sorted(one.values.items()))
        if key not in best or one.evidence > best[key].evidence:
            best[key] = one
    return sorted(best.values(), key=lambda one: one.evidence, reverse=True)


def _promise(
    anchor: Anchor, candidate: Candidate, start: Values, targets: tuple[Condition, ...], slopes: np.ndarray
) -> tuple[float, np.ndarray] | None:
    """Evidence to first order of an explanation beside the baseline that gives way, and where that goes."""
    blocks = anchor.blocks(targets, candidate.effects(start), 0.0)
    if blocks is None:
        return None
    z = given_way(anchor.z, np.concatenate([block.residual for block in blocks]), slopes)
    taken = slopes @ (z - anchor.z)
    ends = np.cumsum([len(block.residual) for block in blocks])[:-1]
    moved = [
        replace(block, residual=block.residual + part)
        for block, part in zip(blocks, np.split(taken, ends), strict=True)
    ]
    return score(moved).log_likelihood - 0.5 * float(z @ z) - cost(candidate, targets), z


def _residual(anchor: Anchor, targets: tuple[Condition, ...], effects: dict, values: dict) -> np.ndarray | None:
    blocks = anchor.blocks(targets, effects, 0.0, values)
    return None if blocks is None else np.concatenate([block.residual for block in blocks])
