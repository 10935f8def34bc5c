"""The search: every effect beside a model, the best of them to the end."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import partial

import numpy as np

from ssmr_ident.core.threads import side_by_side
from ssmr_ident.diagnose.baseline import WIDE, bent
from ssmr_ident.diagnose.explain import from_what_is_known
from ssmr_ident.diagnose.finals import REFITTED, anew, each_once, to_the_end
from ssmr_ident.diagnose.from_known import begun_from_known
from ssmr_ident.diagnose.loose import begun_loose
from ssmr_ident.diagnose.race import (
    Progress,
    begun_in_its_place,
    raced,
    ranked,
    run_on,
    screened,
    started,
    started_from_known,
)
from ssmr_ident.diagnose.scan import Suspect, candidates, moves_beyond, out_of_reach, promising, scan, variants
from ssmr_ident.identify.fitting.descent import LOUD, chatters, slides
from ssmr_ident.identify.fitting.joint import JointFit
from ssmr_ident.physics.effects import CATALOGUE

SCREENED = 8
"""Effects that are refitted on the first horizons."""

SAME = 0.01
"""Share of a change's square below which the baseline makes it as well: steps of a tenth of a change leave so much."""


@dataclass(frozen=True, eq=False)
class Search:
    """What was tried.

    Parameters
    ----------
    baseline : JointFit
        At its best, with slopes.
    suspects : tuple of tuple of Suspect
        Per effect, most promising first.
    tried : tuple of JointFit
        Models with one effect more, refitted to the end.
    lengths : tuple of float [s]
        Horizons.
    astray : bool
        Of decays, none of them leads home.
    """

    baseline: JointFit
    suspects: tuple[tuple[Suspect, ...], ...]
    tried: tuple[JointFit, ...]
    lengths: tuple[float, ...]
    astray: bool = False


def search(
    base: JointFit,
    baseline: str,
    lengths: Sequence[float],
    further: bool = False,
    progress: Progress | None = None,
    elsewhere: bool = False,
) -> Search:
    """Every effect of the catalogue beside a model.

    Parameters
    ----------
    base : JointFit
        With slopes.
    baseline : str
        The session's.
    lengths : sequence of float [s]
        Horizons.
    further : bool
        The model has an effect already, and a second one is looked for.
    progress : callable, optional
    elsewhere : bool
        Recordings kept back leave what those that were fitted do not.
    """
    misfit = base.parts / [t.size for t in base.trials]
    # one recording that stands out may be the only one in which a wheel lifts; beside an effect that explains the
    # others it is more likely the effect's own formula
    loud = float(np.median(misfit)) > WIDE if further else float(np.max(misfit)) > LOUD
    # pulls along one axis alone may show what tires do that go far; a small share of friction that falls, which a
    # straight line tells from less friction by nothing, is no saw-tooth yet
    loud = loud or (chatters(base) and float(np.max(misfit)) > (LOUD if further else WIDE))
    alone = bent(base) and not further
    asked = candidates(base, baseline)
    groups = scan(base, asked, small=not loud)
    groups += out_of_reach(base, asked, groups) if alone or elsewhere else []
    rest = [np.inf]
    if loud and len(lengths) > 1:
        rough = screened(base, groups, lengths, progress) if groups else []
        rest = list(lengths[1:])
    elif loud:
        rough = raced(base, groups, progress) if groups else []
    else:
        chosen = [g for g in groups if promising(g[0])][: REFITTED if further else SCREENED]
        beyond = [
            g for g in groups if (alone or elsewhere) and moves_beyond(CATALOGUE[g[0].effect]) and len(lengths) > 1
        ]
        pulls = slides(base)
        same = [g[0] for g in groups if alone and (pulls or g[0].own < SAME) and not CATALOGUE[g[0].effect].sudden]
        each = _each_group(chosen, beyond)
        starts = [partial(started, base, s) for group in each for s in variants(group)]
        starts += [partial(from_what_is_known, base, s, lengths) for group in beyond for s in variants(group)]
        starts += [partial(started_from_known, base, group[0], pulls) for group in chosen if alone]
        same += [g[0] for g in beyond if alone]  # what a belt gives, a baseline puts into the tires
        starts += [partial(begun_in_its_place, base, s) for s in same]
        starts += begun_loose(base, asked) if pulls else []
        rough = run_on(list(side_by_side(lambda begin: begin(), starts)))
        if pulls and rough and CATALOGUE[rough[0].model.ids[-1]].loosens:
            known = replace(base, point=base.model.as_known(base.point))
            begun = list(side_by_side(lambda begin: begin(), begun_loose(known, asked)))
            rough = ranked([*rough, *run_on(begun)])
    tried = to_the_end(base, rough, rest, lengths, progress)
    if loud and len(lengths) > 1 and not chatters(base) and groups and promising(groups[0][0]):
        # what grows while a recording lasts hardly shows on a first horizon, and is left behind there
        first = groups[0][0]
        tried += [] if _has(tried, first) else to_the_end(base, [started(base, first)], [np.inf], lengths, progress)
    astray = loud and len(lengths) > 1 and not further and leads_astray(tried)
    if astray:
        # the first may only have lost its way, and knows its size
        home = [anew(fit, tuple(lengths)) for fit in ranked(tried)[:1]]
        astray = not home or float(np.median(home[0].parts / [t.size for t in base.trials])) >= LOUD
        tried += [] if astray else home
    if progress:
        progress("refitting explanations", 1, 1)
    # of two fits of pulls all recordings decide, those kept back as well
    ends = tried if slides(base) else each_once(tried)
    return Search(base, tuple(tuple(g) for g in groups), tuple(ends), tuple(lengths), astray)


def searched_from_known(before: Search, baseline: str, progress: Progress | None = None) -> Search | None:
    """All effects in all sizes beside what is known, for decays in which nothing led home; none if none does better.

    It takes twice as long as the search before. Where two effects are missing it adds nothing (practice 22), so they
    are looked for first.

    Parameters
    ----------
    before : Search
        Of the first effect.
    baseline : str
        The session's.
    progress : callable, optional
    """
    begun = begun_from_known(before.baseline, baseline, before.lengths[0], progress)
    more = to_the_end(before.baseline, begun, before.lengths[1:], before.lengths, progress, starts=2)
    best = ranked([*more, *before.tried])[:1]
    if not any(fit is best[0] for fit in more):
        return None
    return replace(before, tried=tuple(each_once([*before.tried, *more])), astray=False)


def leads_astray(tried: Sequence[JointFit]) -> bool:
    """Whether what explains most leaves far more than another formula would, in most recordings of decays; so does
    nothing at all."""
    best = ranked(tried)[:1]
    return not any(chatters(f) for f in best) and all(
        float(np.median(f.parts / [t.size for t in f.trials])) > WIDE for f in best
    )


def _has(fits: Sequence[JointFit], suspect: Suspect) -> bool:
    """Whether a suspect's effect was refitted in its formula."""
    forms = [(f.model.ids[-1], {c.parameter.name for c in f.model.free if c.effect == f.model.ids[-1]}) for f in fits]
    return (suspect.effect, set(suspect.at)) in forms


def _each_group(*lists: Sequence[Sequence[Suspect]]) -> list[Sequence[Suspect]]:
    return list({group[0].effect: group for groups in lists for group in groups}.values())
