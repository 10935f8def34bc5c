"""Two effects at once: partners, pairs of which neither shows alone, and what a pair can do without."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

from ssmr_ident.diagnose.accept import ahead, certain, harmless, leading, mends, significant
from ssmr_ident.diagnose.baseline import LAST
from ssmr_ident.diagnose.explain import without
from ssmr_ident.diagnose.explore import search
from ssmr_ident.diagnose.followed import all_explained, at_its_best, each_set_once, explained, joined
from ssmr_ident.diagnose.polish import loud, polish
from ssmr_ident.diagnose.race import Progress, within_reach
from ssmr_ident.diagnose.weigh import Explanation, evidences
from ssmr_ident.identify.fitting.descent import chatters, descend
from ssmr_ident.identify.fitting.joint import differentiate
from ssmr_ident.identify.trials import Trial

OTHERS = 2
"""Single effects behind the first one that partners are looked for as well."""


def with_a_second(
    leader: Explanation,
    before: Explanation,
    kept: Sequence[Trial],
    baseline: str,
    lengths: tuple[float, ...],
    progress: Progress | None,
) -> list[Explanation]:
    """Pairs of a leader that predicts no better alone, the best one first; none where that does not mend it.

    Of two effects that recordings show in turn neither need.
    """
    new = all_explained(kept, search(leader.fit, baseline, lengths, True, progress).tried, leader.kept)
    if not new:
        return []
    pair = at_its_best(leading(before, new), new, kept, lengths)
    others = [e for e in new if e is not pair]
    return [replace(pair, fit=differentiate(pair.fit)), *others] if mends(pair, leader) else []


def partners_of(
    pair: Explanation, kept: Sequence[Trial], baseline: str, lengths: tuple[float, ...], progress: Progress | None
) -> list[Explanation]:
    """The second effect of a pair by itself, and beside all others."""
    alone = differentiate(polish(without(pair.fit, pair.fit.model.ids[0]), lengths))
    found = search(alone, baseline, lengths, True, progress)
    return all_explained(kept, (alone, *found.tried), pair.kept)


def exchange(
    pair: Explanation,
    single: Explanation,
    kept: Sequence[Trial],
    lengths: tuple[float, ...],
    singles: Sequence[Explanation],
) -> Explanation | None:
    """The second effect of a pair by itself, where it says certainly more than the first one.

    Which of two is found first the start decides. Hardening that a baseline has bent round (bank 5224) showed first as
    a mast of 0.24 kg with a damping ratio of 0.27, was turned down as its partner for the 0.70 of the variance that it
    left, and is 2,600 units ahead of the mast alone.
    """
    if not certain(pair, single):
        return None
    first, *rest = pair.fit.model.ids
    alone = next((e for e in singles if list(e.fit.model.ids) == rest), None)
    if alone is None:
        begun = descend(without(pair.fit, first), LAST // 2)
        if not within_reach([single.fit], begun):
            return None
        alone = explained(kept, differentiate(polish(begun, lengths)), pair.kept)
    better = ahead(alone, single) and harmless(alone, single)
    return alone if better and significant(alone.fit) else None


def backward(
    kept: Sequence[Trial],
    lengths: tuple[float, ...],
    chosen: Explanation,
    tried: list[Explanation],
    singles: Sequence[Explanation],
) -> tuple[Explanation, list[Explanation]]:
    """Take out of a pair the effect that the other one made superfluous.

    ``singles`` have been led to their best already.
    """
    ids = chosen.fit.model.ids
    if len(ids) < 2:
        return chosen, tried
    known = {e.id: e for e in singles}
    for effect_id, other in zip(ids, reversed(ids), strict=True):
        alone = known.get(other)
        if alone is None:
            alone = explained(kept, differentiate(polish(without(chosen.fit, effect_id), lengths)), chosen.kept)
        tried = joined(tried, [alone])
        if not mends(chosen, alone):
            return alone, tried
    return chosen, tried


def instead(
    chosen: Explanation,
    tried: Sequence[Explanation],
    kept: Sequence[Trial],
    baseline: str,
    lengths: tuple[float, ...],
    progress: Progress | None,
) -> tuple[Explanation, list[Explanation]]:
    """A pair in place of a single effect that leaves much itself, and all that was tried.

    Of two effects that hide each other neither is in front alone: a force in no list had stood for hardening with a
    loop. So partners are looked for beside the next singles as well. Each effect of such a pair has to mend what the
    other one leaves; that both are better than a third, which none of them is the formula of, evidence says. Where one
    of them does not, the other one alone is asked.
    """
    tried = list(tried)
    if len(chosen.fit.model.ids) != 1 or not loud(chosen.fit) or chatters(chosen.fit):
        return chosen, tried
    found = evidences(tried)
    singles = [e for e in tried if e is not chosen and len(e.fit.model.ids) == 1 and "unlisted" not in e.fit.model.ids]
    pairs: list[Explanation] = []
    for single in sorted(singles, key=lambda e: -found[e.id])[:OTHERS]:
        begun = differentiate(polish(single.fit, lengths))
        pairs += all_explained(kept, search(begun, baseline, lengths, True, progress).tried, single.kept)
    pairs = [p for p in pairs if chosen.fit.model.ids[0] not in p.fit.model.ids]
    if not pairs:
        return chosen, tried
    pairs = each_set_once(pairs)
    leader = at_its_best(leading(chosen, pairs), pairs, kept, lengths)
    tried = joined(tried, pairs)
    if not ahead(leader, chosen) or not harmless(leader, chosen):
        return chosen, tried
    shown = replace(leader, fit=differentiate(leader.fit))
    left, tried = backward(kept, lengths, shown, [shown if e is leader else e for e in tried], ())
    # what the pair can do without may have shown the way to a single effect that no search had brought so far
    better = left is shown or (ahead(left, chosen) and harmless(left, chosen))
    return (left if better and significant(left.fit) else chosen), tried
