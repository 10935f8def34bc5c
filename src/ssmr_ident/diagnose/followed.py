"""Fits beside what they predict of the recordings that were kept back."""

from __future__ import annotations

from collections.abc import Sequence
from functools import partial

import numpy as np

from ssmr_ident.compare.recorded import follow
from ssmr_ident.core.threads import side_by_side
from ssmr_ident.diagnose.polish import polish, turned
from ssmr_ident.diagnose.weigh import Explanation, evidences, log_evidence
from ssmr_ident.identify.fitting.descent import descend
from ssmr_ident.identify.fitting.joint import JointFit, evaluate
from ssmr_ident.identify.trials import Trial

FURTHER = 3
"""Gauss-Newton steps once recordings that were kept back are fitted as well."""

NEAR = 20.0
"""Log evidence by which an explanation may be behind and still be led to its best: of 25 that came to the end of a
search (short decays, bank 5801 to 5815), being led on gained 22 and 119 for two, and 5 or less for the others."""


def explained(kept: Sequence[Trial], fit: JointFit, near: JointFit | None = None) -> Explanation:
    """A fit beside what it predicts of the recordings that were kept back.

    ``near`` is another model's prediction of them, whose nuisances are a start as well.
    """
    return Explanation(fit, follow(kept, fit.model, fit.point, None if near is None else near.nuisances, fit))


def on_all(explanation: Explanation) -> JointFit:
    """A model on what was fitted and on what was kept back, all of it fitted."""
    fit, kept = explanation.fit, explanation.kept
    whole = evaluate((*fit.trials, *kept.trials), fit.model, fit.point, (*fit.nuisances, *kept.nuisances))
    return descend(whole, FURTHER)


def all_explained(kept: Sequence[Trial], fits: Sequence[JointFit], near: JointFit) -> list[Explanation]:
    """Fits as explanations, but for those that make no robot of the recordings kept back.

    Of two fits of one effect, which pulls may end in, the one that all recordings say most for.
    """
    found = [e for e in side_by_side(lambda fit: explained(kept, fit, near), fits) if _followable(e)]
    best: dict[str, Explanation] = {}
    for explanation in sorted(found, key=lambda e: -log_evidence(e, found[0])):
        best.setdefault(explanation.id, explanation)
    return [e for e in found if e is best[e.id]]


def _followable(explanation: Explanation) -> bool:
    return bool(np.all(np.isfinite(explanation.kept.parts)))


def joined(tried: Sequence[Explanation], new: Sequence[Explanation]) -> list[Explanation]:
    """Each model once, as last fitted: beside a better baseline all are tried again."""
    ids = {e.id for e in new}
    return [*(e for e in tried if e.id not in ids), *new]


def each_set_once(explanations: Sequence[Explanation]) -> list[Explanation]:
    """Of one pair reached from either side the better."""
    found = evidences(explanations)
    best: dict[frozenset[str], Explanation] = {}
    for explanation in sorted(explanations, key=lambda e: -found[e.id]):
        best.setdefault(frozenset(explanation.fit.model.ids), explanation)
    return list(best.values())


def at_its_best(
    leader: Explanation, new: list[Explanation], kept: Sequence[Trial], lengths: tuple[float, ...]
) -> Explanation:
    """The leader led on, which takes its place where that is better."""
    further = _led_on(kept, lengths, leader)
    new[new.index(leader)] = further
    return further


def contested(
    leader: Explanation, new: list[Explanation], kept: Sequence[Trial], lengths: tuple[float, ...]
) -> Explanation:
    """The first, once the leader and those close behind it are at their best."""
    found = evidences(new)
    close = [e for e in new if found[e.id] > found[leader.id] - NEAR]
    for before, after in zip(close, side_by_side(partial(_led_on, kept, lengths), close), strict=True):
        new[new.index(before)] = after
    found = evidences(new)
    return max(new, key=lambda e: found[e.id])


def _led_on(kept: Sequence[Trial], lengths: tuple[float, ...], one: Explanation) -> Explanation:
    further = explained(kept, turned(polish(one.fit, lengths, refitted=True), lengths), one.kept)
    better = further.fit.cost(further.fit.counted) < one.fit.cost(further.fit.counted)
    return further if better and _followable(further) else one
