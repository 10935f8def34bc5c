"""The diagnosis of decays, pulls and rigs: noise, baseline, is anything left, which, and what it is worth."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from ssmr_ident.compare.recorded import follow
from ssmr_ident.core.parameter import ParameterSet
from ssmr_ident.diagnose.accept import (
    FORMULA,
    certain,
    halves,
    leading,
    leaves_structure,
    left_over,
    may_mend,
    mends,
    promises,
    significant,
    touches,
    within_file,
)
from ssmr_ident.diagnose.baseline import alike_in, begun_again, best_baseline, prepared, swings_alone, unsteady
from ssmr_ident.diagnose.coupling import coupled
from ssmr_ident.diagnose.explore import Search, leads_astray, search, searched_from_known
from ssmr_ident.diagnose.followed import all_explained, at_its_best, contested, each_set_once, explained, joined
from ssmr_ident.diagnose.pairs import backward, exchange, instead, partners_of, with_a_second
from ssmr_ident.diagnose.polish import calmed, loud
from ssmr_ident.diagnose.race import Progress
from ssmr_ident.diagnose.rivals import rivals_of, shared_by_all
from ssmr_ident.diagnose.rotate import left_elsewhere, shown_by_all
from ssmr_ident.diagnose.setup import Setup
from ssmr_ident.diagnose.stripped import good_enough, outdone, shaken, stripped_of, way_home
from ssmr_ident.diagnose.weigh import Explanation, evidences
from ssmr_ident.identify.fitting.descent import slides
from ssmr_ident.identify.fitting.joint import differentiate
from ssmr_ident.identify.fitting.roughness import scatter_of

MOST_EFFECTS = 2
"""Effects that are looked for together."""

MOST_MOVES = 2
"""Times that the search is begun anew beside a better fit of what stands, which an effect has led to."""


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
    beside : tuple of Explanation
        Pairs that all have the chosen effect, where the recordings leave open which is beside it; the likeliest first.
    """

    setup: Setup
    baseline: Explanation
    tried: tuple[Explanation, ...]
    chosen: Explanation
    rivals: tuple[Explanation, ...]
    found: dict[str, float]
    searches: tuple[Search, ...]
    beside: tuple[Explanation, ...] = ()


def examine(setup: Setup, parameters: ParameterSet, progress: Progress | None = None) -> Outcome:
    """Look for what a session's baseline leaves out."""
    if progress:
        progress("fitting the baseline", 0, 1)
    setup = informed(setup, parameters)
    found = _examined(setup, parameters, progress)
    if not (found.searches and found.searches[0].astray and leads_astray([found.chosen.fit])):
        return found
    more = searched_from_known(found.searches[0], setup.campaign.session.baseline, progress)
    if more is None:
        return found
    return _examined(replace(setup, begun=(more.baseline, more.lengths)), parameters, progress, more)


def _examined(
    setup: Setup, parameters: ParameterSet, progress: Progress | None, searched: Search | None = None
) -> Outcome:
    """``searched`` is a first search beside the setup's baseline that has been made."""
    fit, lengths = setup.begun or best_baseline(setup.fitted, setup, parameters)
    kept = tuple(prepared(follow(alike_in(setup.kept, fit.trials), fit.model, fit.point)))
    if progress:
        progress("fitting the baseline", 1, 1)
    baseline = explained(kept, fit)
    tried, searches = [baseline], []
    singles: list[Explanation] = []
    chosen = baseline
    rounds, moves, exchanged = MOST_EFFECTS, MOST_MOVES, False
    while rounds:
        rounds -= 1
        small = chosen is not baseline and left_over(chosen, baseline) < FORMULA
        if small and not leaves_structure(chosen):
            break
        if setup.decoupled and chosen is baseline:
            new = [coupled(setup, parameters, kept)]
            result = Search(fit, (), tuple(e.fit for e in new), lengths)
        else:
            further = chosen is not baseline
            elsewhere = not further and left_elsewhere(chosen)
            kind = setup.campaign.session.baseline
            known, searched = searched, None  # beside a baseline that has moved all is looked for again
            result = known or search(chosen.fit, kind, lengths, further, progress, elsewhere)
            new = all_explained(kept, [calmed(f) if unsteady(f) else f for f in result.tried], chosen.kept)
        searches.append(result)
        if not new:
            break
        leader = leading(chosen, new)
        if chosen is not baseline and _cost(leader, chosen) > _cost(chosen, chosen) and not certain(leader, chosen):
            tried = joined(tried, new)
            break
        if chosen is not baseline and not slides(chosen.fit) and not promises(leader, chosen):
            tried = joined(tried, new)
            break
        if chosen is baseline or setup.decoupled or slides(chosen.fit) or may_mend(leader, chosen):
            leader = contested(leader, new, kept, lengths)
        if small and not halves(leader, chosen):
            break
        if chosen is not baseline and not setup.decoupled and mends(leader, chosen):
            # the first effect may have stood in for two
            partners = partners_of(leader, kept, setup.campaign.session.baseline, lengths, progress)
            singles += partners[:1]
            new = each_set_once([*new, *partners])
            other = leading(chosen, new)
            leader = leader if other is leader else at_its_best(other, new, kept, lengths)
        found_fit = differentiate(leader.fit)
        first = chosen is baseline
        others = [e for e in new if e is not leader]
        good = good_enough(leader, chosen, first)
        vague = leader if first and good and not significant(found_fit) else None
        if vague is not None and others:
            # a law whose size the recordings do not give stands in for another
            leader = at_its_best(leading(chosen, others), new, kept, lengths)
            found_fit = differentiate(leader.fit)
            good = good_enough(leader, chosen, first)
        tried = joined(tried, new)
        # or for two
        single = vague if vague is not None and (not good or leader is vague) else leader
        if first and (single is vague or (not good and certain(leader, chosen) and _lacks(chosen))):
            together = with_a_second(single, chosen, kept, setup.campaign.session.baseline, lengths, progress)
            tried = joined(tried, together)
            if together and good_enough(together[0], chosen, first) and significant(together[0].fit):
                singles.append(single)
                chosen = together[0]
                break
        if not good or not significant(found_fit) or within_file(found_fit, parameters):
            # not in pulls, where it was not counted: there the one effect may lie in a hollow of the other's
            no_first = first or exchanged or setup.decoupled or slides(chosen.fit)
            alone = None if no_first else exchange(leader, chosen, kept, lengths, singles)
            if alone is None:
                break
            # the second one is looked for anew
            chosen, exchanged, rounds = alone, True, rounds + 1
            singles.append(alone)
            tried = joined(tried, [alone])
            continue
        stripped = stripped_of(leader, chosen)
        if first and slides(stripped) and (swings_alone(stripped) or swings_alone(chosen.fit)):
            stripped = shaken(stripped, chosen, leader, kept)
        bare = explained(kept, differentiate(stripped), leader.kept)
        moved = bare.id == chosen.id and _cost(bare, chosen) < _cost(chosen, chosen)
        if moved:
            # the effect had only shown the way to a better fit without it
            tried[tried.index(chosen)], chosen = bare, bare
            baseline = bare if first else baseline
        refuted = outdone(leader, chosen) or (first and not shown_by_all(leader, chosen))
        if refuted or (moved and not good_enough(leader, chosen, first)):
            if moved and moves:
                moves, rounds = moves - 1, rounds + 1
                continue
            break
        chosen = replace(leader, fit=found_fit)
        tried[tried.index(leader)] = chosen
        singles.append(chosen)
    chosen, tried = backward(kept, lengths, chosen, tried, singles)
    if chosen is not baseline and not setup.decoupled:
        chosen, tried = instead(chosen, tried, kept, setup.campaign.session.baseline, lengths, progress)
    home = None if chosen is baseline or setup.decoupled else way_home(chosen, baseline, tried, kept, parameters)
    if home is not None:
        return _examined(replace(setup, begun=(home.fit, lengths)), parameters, progress)
    if chosen is not baseline and not touches(chosen, baseline):
        chosen = baseline
    if chosen is baseline and not setup.decoupled:
        again = begun_again(baseline.fit, lengths)
        if again is not None and certain(explained(kept, again, baseline.kept), baseline):
            return _examined(replace(setup, begun=(again, lengths)), parameters, progress)
    suspects = searches[0].suspects if searches else ()
    rivals, tried = rivals_of(chosen, baseline, tried, suspects, kept)
    beside: tuple[Explanation, ...] = ()
    core = shared_by_all(chosen, rivals, tried, baseline)
    if core is not None:
        shown = replace(core, fit=differentiate(core.fit))
        beside, tried, chosen = (chosen, *rivals), [shown if e is core else e for e in tried], shown
        rivals, tried = rivals_of(chosen, baseline, tried, suspects, kept)
    return Outcome(setup, baseline, tuple(tried), chosen, tuple(rivals), evidences(tried), tuple(searches), beside)


def informed(setup: Setup, parameters: ParameterSet) -> Setup:
    """A setup whose baseline knows what its calibration recordings tell."""
    if not setup.calibration:
        return setup
    fit, _ = best_baseline(setup.calibration, setup, parameters)
    stds = np.sqrt(np.diag(scatter_of(fit)))
    physics = tuple(
        replace(u, prior=u.value(float(p)), prior_std=max(u.std(float(p), float(s)), 1e-12))
        for u, p, s in zip(setup.model.physics, fit.point, stds, strict=True)
    )
    return replace(setup, model=replace(setup.model, physics=physics), begun=None)


def _lacks(baseline: Explanation) -> bool:
    """Whether a baseline leaves so much that something is missing, though no one effect be good enough: in most of the
    recordings that were fitted, or more in any than null sessions leave by their hollows."""
    return loud(baseline.fit) or not (swings_alone(baseline.fit) and swings_alone(baseline.kept))


def _cost(explanation: Explanation, reference: Explanation) -> float:
    return explanation.fit.cost(reference.fit.counted)
