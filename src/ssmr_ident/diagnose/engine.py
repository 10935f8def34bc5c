"""The diagnosis of decays, pulls and rigs: noise, baseline, is anything left, which, and what it is worth."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from ssmr_ident.compare.recorded import follow
from ssmr_ident.core.parameter import ParameterSet
from ssmr_ident.diagnose.accept import (
    FORMULA,
    as_near,
    better,
    certain,
    leading,
    left_over,
    mends,
    significant,
    touches,
    within_file,
)
from ssmr_ident.diagnose.baseline import LAST, best_baseline, prepared, unsteady
from ssmr_ident.diagnose.coupling import coupled
from ssmr_ident.diagnose.explain import without
from ssmr_ident.diagnose.explore import Search, search
from ssmr_ident.diagnose.polish import calmed, loud, polish, turned
from ssmr_ident.diagnose.race import Progress
from ssmr_ident.diagnose.rotate import shown_in_turn
from ssmr_ident.diagnose.setup import Setup
from ssmr_ident.diagnose.weigh import TIE, Explanation, evidences
from ssmr_ident.identify.descent import descend
from ssmr_ident.identify.joint import JointFit, differentiate
from ssmr_ident.identify.trials import Trial

MOST_EFFECTS = 2
"""Effects that are looked for together."""


@dataclass(frozen=True, eq=False)
class Outcome:
    """What the search found.

    Parameters
    ----------
    setup : Setup
    baseline : Explanation
    tried : tuple of Explanation
        All, the baseline among them.
    chosen : Explanation
        The baseline where nothing is missing.
    rivals : tuple of Explanation
        Those that fit as well as the chosen one.
    found : dict of str to float
        Log evidence by id, the baseline's being 0.
    searches : tuple of Search
    """

    setup: Setup
    baseline: Explanation
    tried: tuple[Explanation, ...]
    chosen: Explanation
    rivals: tuple[Explanation, ...]
    found: dict[str, float]
    searches: tuple[Search, ...]


def examine(setup: Setup, parameters: ParameterSet, progress: Progress | None = None) -> Outcome:
    """Look for what a session's baseline leaves out."""
    if progress:
        progress("fitting the baseline", 0, 1)
    setup = informed(setup, parameters)
    fit, lengths = setup.begun or best_baseline(setup.fitted, setup, parameters)
    kept = tuple(prepared(follow(setup.kept, fit.model, fit.point)))
    if progress:
        progress("fitting the baseline", 1, 1)
    baseline = explained(kept, fit)
    tried, searches = [baseline], []
    singles: list[Explanation] = []
    chosen = baseline
    for _ in range(MOST_EFFECTS):
        if chosen is not baseline and left_over(chosen, baseline) < FORMULA:
            break
        if setup.decoupled and chosen is baseline:
            new = [coupled(setup, parameters, kept)]
            result = Search(fit, (), tuple(e.fit for e in new), lengths)
        else:
            result = search(chosen.fit, setup.campaign.session.baseline, lengths, chosen is not baseline, progress)
            new = _all_explained(kept, [calmed(f) if unsteady(f) else f for f in result.tried], chosen.kept)
        searches.append(result)
        if not new:
            break
        leader = leading(chosen, new)
        if chosen is not baseline and _cost(leader, chosen) > _cost(chosen, chosen) and not certain(leader, chosen):
            tried = _with(tried, new)
            break
        leader = _at_its_best(leader, new, kept, lengths)
        if chosen is not baseline and not setup.decoupled and mends(leader, chosen):
            # the first effect may have stood in for two
            partners = _partners(leader, kept, setup.campaign.session.baseline, lengths, progress)
            singles += partners[:1]
            new = _each_set_once([*new, *partners])
            other = leading(chosen, new)
            leader = leader if other is leader else _at_its_best(other, new, kept, lengths)
        found_fit = differentiate(leader.fit)
        first = chosen is baseline
        others = [e for e in new if e is not leader]
        good = _good(leader, chosen, first)
        if first and others and good and not significant(found_fit):
            # a law whose size the recordings do not give stands in for another
            leader = _at_its_best(leading(chosen, others), new, kept, lengths)
            found_fit = differentiate(leader.fit)
            good = _good(leader, chosen, first)
        tried = _with(tried, new)
        if first and not good and certain(leader, chosen) and loud(chosen.fit):
            together = _with_a_second(leader, chosen, kept, setup.campaign.session.baseline, lengths, progress)
            tried = _with(tried, together)
            if together and _good(together[0], chosen, first) and significant(together[0].fit):
                singles.append(leader)
                chosen = together[0]
                break
        if not good or not significant(found_fit) or within_file(found_fit, parameters):
            break
        further = [name for name in leader.fit.model.ids if name not in chosen.fit.model.ids]
        stripped = without(leader.fit, further[-1])
        # the leader of pulls was led far, over hollows: what is without it begins where it ended, and is led as far
        stripped = descend(calmed(stripped) if unsteady(stripped) else stripped, LAST // 2)
        bare = explained(kept, differentiate(stripped), leader.kept)
        if bare.id == chosen.id and _cost(bare, chosen) < _cost(chosen, chosen):
            # the effect had only shown the way to a better fit without it
            tried[tried.index(chosen)], chosen = bare, bare
            baseline = bare if first else baseline
            if not _good(leader, bare, first):
                continue
        chosen = replace(leader, fit=found_fit)
        tried[tried.index(leader)] = chosen
        singles.append(chosen)
    chosen, tried = _backward(kept, lengths, chosen, tried, singles)
    if chosen is not baseline and not touches(chosen, baseline):
        chosen = baseline
    found = evidences(tried)
    top = found[chosen.id]
    alike = [e for e in tried if e is not chosen and len(e.fit.model.ids) <= len(chosen.fit.model.ids)]
    rivals = sorted(
        (e for e in alike if e is not baseline and (top - found[e.id] < TIE or as_near(e, chosen))),
        key=lambda e: -found[e.id],
    )
    return Outcome(setup, baseline, tuple(tried), chosen, tuple(rivals), found, tuple(searches))


def _good(leader: Explanation, before: Explanation, first: bool) -> bool:
    return better(leader, before, first) or (first and shown_in_turn(leader, before))


def explained(kept: Sequence[Trial], fit: JointFit, near: JointFit | None = None) -> Explanation:
    """A fit beside what it predicts of the recordings that were kept back.

    ``near`` is another model's prediction of them, whose nuisances are a start as well.
    """
    return Explanation(fit, follow(kept, fit.model, fit.point, None if near is None else near.nuisances, fit))


def _all_explained(kept: Sequence[Trial], fits: Sequence[JointFit], near: JointFit) -> list[Explanation]:
    """Fits as explanations, but for those that make no robot of the recordings kept back."""
    return [e for e in (explained(kept, fit, near) for fit in fits) if _followable(e)]


def _followable(explanation: Explanation) -> bool:
    return bool(np.all(np.isfinite(explanation.kept.parts)))


def informed(setup: Setup, parameters: ParameterSet) -> Setup:
    """A setup whose baseline knows what its calibration recordings tell."""
    if not setup.calibration:
        return setup
    fit, _ = best_baseline(setup.calibration, setup, parameters)
    stds = np.sqrt(np.diag(fit.covariance()))
    physics = tuple(
        replace(u, prior=u.value(float(p)), prior_std=max(u.std(float(p), float(s)), 1e-12))
        for u, p, s in zip(setup.model.physics, fit.point, stds, strict=True)
    )
    return replace(setup, model=replace(setup.model, physics=physics), begun=None)


def _each_set_once(explanations: Sequence[Explanation]) -> list[Explanation]:
    """Of one pair reached from either side the better."""
    found = evidences(explanations)
    best: dict[frozenset[str], Explanation] = {}
    for explanation in sorted(explanations, key=lambda e: -found[e.id]):
        best.setdefault(frozenset(explanation.fit.model.ids), explanation)
    return list(best.values())


def _with(tried: Sequence[Explanation], new: Sequence[Explanation]) -> list[Explanation]:
    """Each model once, as last fitted: beside a better baseline all are tried again."""
    ids = {e.id for e in new}
    return [*(e for e in tried if e.id not in ids), *new]


def _cost(explanation: Explanation, reference: Explanation) -> float:
    return explanation.fit.cost(reference.fit.counted)


def _at_its_best(
    leader: Explanation, new: list[Explanation], kept: Sequence[Trial], lengths: tuple[float, ...]
) -> Explanation:
    """The leader led on, which takes its place where that is better."""
    further = explained(kept, turned(polish(leader.fit, lengths), lengths), leader.kept)
    if _followable(further) and further.fit.cost(further.fit.counted) < leader.fit.cost(further.fit.counted):
        new[new.index(leader)], leader = further, further
    return leader


def _with_a_second(
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
    new = _all_explained(kept, search(leader.fit, baseline, lengths, True, progress).tried, leader.kept)
    if not new:
        return []
    pair = _at_its_best(leading(before, new), new, kept, lengths)
    others = [e for e in new if e is not pair]
    return [replace(pair, fit=differentiate(pair.fit)), *others] if mends(pair, leader) else []


def _partners(
    pair: Explanation, kept: Sequence[Trial], baseline: str, lengths: tuple[float, ...], progress: Progress | None
) -> list[Explanation]:
    """The second effect of a pair by itself, and beside all others."""
    alone = differentiate(polish(without(pair.fit, pair.fit.model.ids[0]), lengths))
    found = search(alone, baseline, lengths, True, progress)
    return _all_explained(kept, (alone, *found.tried), pair.kept)


def _backward(
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
        tried = _with(tried, [alone])
        if not mends(chosen, alone):
            return alone, tried
    return chosen, tried
