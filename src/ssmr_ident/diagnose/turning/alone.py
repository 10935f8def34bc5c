"""The baseline once more, searched as widely as what is about to be named beside it.

Without calibration an effect is worth what it adds to the baseline at its best. Effects are begun from many places and
led on; a baseline that was searched once is then behind by that alone, and something is named where
nothing is missing.
"""

from __future__ import annotations

from collections.abc import Sequence

from ssmr_ident.diagnose.turning.conditions import Condition
from ssmr_ident.diagnose.turning.counter import Counter, Progress
from ssmr_ident.diagnose.turning.ensemble import ROUNDS, settled
from ssmr_ident.diagnose.turning.search import Explained, explained
from ssmr_ident.diagnose.turning.wider import REACH, TIMES


def without(explanations: Sequence[Explained], targets: tuple[Condition, ...]) -> list[Explained]:
    """The baselines that go with explanations, each by itself."""
    every = [explained(one.anchor, None, {}, targets) for one in explanations]
    return [one for one in every if one is not None]


def searched_again(
    baseline: Explained, best: float, needed: float, targets: tuple[Condition, ...], seed: int,
    final: tuple[int, ...], show: Progress,
) -> Explained:  # fmt: skip
    """The baseline after an ensemble of twice the size and those that lead it on.

    Only where it decides: what lies further ahead than such searches were seen to add is ahead of any baseline.

    Parameters
    ----------
    baseline : Explained
        The best place known so far.
    best : float
        Evidence of the best explanation.
    needed : float
        By how much that has to be ahead to be named.
    targets : tuple of Condition
    seed : int
        Of the draws, and of the simulated floors.
    final : tuple of int
        Floors over which places are compared.
    show : callable
        Called with the name of the stage, what of it is done, and of how much.
    """
    if not needed < best - baseline.evidence < REACH:
        return baseline
    count = Counter(show, "baseline from further away", (1 + TIMES) * ROUNDS)
    now = settled(baseline, targets, seed, final, count.advance, everywhere=True)
    for time in range(TIMES):
        if best - now.evidence <= needed:
            break
        now = settled(now, targets, seed + 1 + time, final, count.advance)
    count.finish()
    return now
