"""Effects tried side by side where much is left: few steps each, the worse half out, and again."""

from __future__ import annotations

import itertools
from collections.abc import Callable, Sequence
from dataclasses import replace
from functools import partial

import numpy as np

from ssmr_ident.compare.recorded import follow, nearest
from ssmr_ident.core.threads import side_by_side
from ssmr_ident.diagnose.explain import as_large_as_it_takes, beside, in_its_place, with_suspect
from ssmr_ident.diagnose.gathered import gathered
from ssmr_ident.diagnose.loose import begun_loose
from ssmr_ident.diagnose.scan import Suspect, both_ways, promising
from ssmr_ident.identify.fitting.descent import chatters, descend, slides
from ssmr_ident.identify.fitting.horizons import STEPS, horizon_fit
from ssmr_ident.identify.fitting.joint import JointFit, each_best, evaluate
from ssmr_ident.identify.trials.trial import Trial
from ssmr_ident.physics.effects import CATALOGUE

Progress = Callable[[str, int, int], None]

BASELINE = "baseline."

FAR = 3.0
"""Prior standard deviations by which a parameter may have moved before a fit is begun from what is known as well."""

REPLACED = 3
"""Effects, the first by a straight line, that are begun in the place of what a baseline has left the file for."""

CLOSE = 1.5
"""Difference in the logarithm of the unexplained variance, before refits have come to rest, up to which an effect may
still overtake another: a factor of 4.5."""

HEATS = ((0, 1), (12, 3), (6, 4))
"""Rounds in which probes are tried: how many go in, and Gauss-Newton steps in each. All probes go into the first, on
the first horizon; the others are run on the second."""


def far_off(fit: JointFit) -> np.ndarray:
    """Which coordinates of the physics have left what is known, (p,) bool."""
    return np.abs(fit.point[: len(fit.model.physics)]) > FAR


def _each_form(ranked: Sequence[JointFit]) -> list[JointFit]:
    """Of every effect, in each formula, the fit that leaves least: a first step says little of where one ends."""
    best: dict[tuple[tuple[str, ...], ...], JointFit] = {}
    for fit in ranked:
        ids = fit.model.ids
        form = tuple(c.parameter.name for c in fit.model.free if c.effect == ids[-1])
        if ids[-1] == "unlisted" and len(form) == 1:
            form = ()
        best.setdefault((ids, form), fit)
    return list(best.values())


def _few_unlisted(ordered: Sequence[JointFit]) -> list[JointFit]:
    """Fits without all terms of `unlisted` but the best two, which would crowd out every effect that shows later."""
    terms = [fit for fit in ordered if fit.model.ids[-1] == "unlisted"]
    return [fit for fit in ordered if fit not in terms[2:]]


def raced(base: JointFit, groups: Sequence[Sequence[Suspect]], progress: Progress | None) -> list[JointFit]:
    """All effects on whole recordings, a few steps each; the most likely first.

    Pulls by plain squares: a wheel that lets go a moment later makes a step in a recording that is explained, and what
    that counts for outweighs the slope in the one that shows an effect.
    """
    plain = chatters(base)
    order = _by_squares if plain else ranked
    ways = [way for group in groups for suspect in group for way in both_ways(suspect)]
    starts: list[Callable[[], JointFit | None]] = [partial(started, base, way, plain) for way in ways]
    starts += [partial(started_from_known, base, way, plain) for way in ways] if plain else []
    starts += [partial(_enlarged, base, way) for way in ways] if plain else []
    likely = [suspect for group in groups for suspect in group if promising(suspect)] if plain else []
    starts += [partial(begun_in_its_place, base, suspect) for suspect in likely]
    starts += begun_loose(base, [CATALOGUE[group[0].effect] for group in groups]) if plain else []
    field: list[JointFit] = []
    rounds = len(starts) + (len(groups) if plain else 0)
    for done, fit in enumerate(side_by_side(lambda start: start(), starts)):
        if progress:
            progress("trying effects", done, rounds)
        field += [] if fit is None else [fit]
    for index, group in enumerate(groups if plain else ()):
        if progress:
            progress("trying effects", len(starts) + index, rounds)
        field += side_by_side(lambda fit: descend(fit, HEATS[1][1], plain=True), combined(base, group[0]))
    if progress:
        progress("trying effects", 1, 1)
    ordered, kept = _few_unlisted(order(field)), HEATS[2][0]
    # after two steps the first few may all be of one effect
    once = ranked(field)[:1] if plain else _each_form(ordered)[:kept]
    once += [f for f in ordered[:kept] if f not in once]
    further = order(list(side_by_side(lambda fit: descend(fit, 2, plain=plain), once)))
    # an offset that takes back what the baseline had bent leaves as much, and is ahead in what the priors charge
    best = ranked(further)[:1] if plain else []
    return [*further[:1], *(f for f in best if f not in further[:1]), *(f for f in further[1:] if f not in best)]


def run_on(started: Sequence[JointFit]) -> list[JointFit]:
    """The best fit of each effect a few steps on, two of what was begun at many sizes; the most likely first.

    Two steps from a start say little: relaxation with two branches was then 80 ahead of none and a slow sensor 330,
    and they ended 940 and 370 ahead.
    """
    kept, steps = HEATS[-1]
    field = _few_unlisted(_each_form(ranked(started)))[:kept]
    if any(slides(fit) for fit in field):
        field += _each_form([f for f in ranked(started) if f not in field and CATALOGUE[f.model.ids[-1]].loosens])
    return ranked(list(side_by_side(lambda fit: descend(fit, steps), field)))


def combined(base: JointFit, suspect: Suspect) -> list[JointFit]:
    """An effect at the best of all combinations of its spans, by squares and by recordings, each in its own noise.

    A saw-tooth that comes at the wrong time is worse than none, in squares: from a baseline through its middle no
    descent leads there. The recordings in which teeth are told by their sizes show which combination is near. All else
    begins as the fit has it, and as it is known: a robot that is bent round the grip that its turning wheels lose is
    none from which a descent comes back.
    """
    spans = CATALOGUE[suspect.effect].spans
    names = [unknown.name.rpartition(".")[2] for unknown in base.model.physics]

    def at_values(known: bool, values: tuple[float, ...]) -> JointFit:
        at = dict(zip(spans, values, strict=True))
        own = {name: value for name, value in at.items() if not name.startswith(BASELINE)}
        model, point = with_suspect(base, replace(suspect, at=own))
        point = model.as_known(point) if known else point
        for name in at.keys() - own.keys():
            for k in (k for k, other in enumerate(names) if other == name.removeprefix(BASELINE)):
                point[k] += np.log(at[name]) / model.physics[k].spread
        return evaluate(base.trials, model, point, base.nuisances)

    best: dict[int, JointFit] = {}
    for known in (False, True) if spans else ():
        found = side_by_side(partial(at_values, known), list(itertools.product(*spans.values())))
        finite = [fit for fit in found if np.isfinite(fit.rss)]
        best |= {id(order[0]): order[0] for order in (_by_squares(finite), ranked(finite)) if order}
    return list(best.values())


def _by_squares(fits: Sequence[JointFit]) -> list[JointFit]:
    return sorted((f for f in fits if np.isfinite(f.rss)), key=lambda f: f.rss + f.penalty)


def screened(
    base: JointFit, groups: Sequence[Sequence[Suspect]], lengths: Sequence[float], progress: Progress | None
) -> list[JointFit]:
    """All effects on the first horizon, the better half on the second; the most likely first.

    Where much is left unexplained, what a straight line promises is no guide: an effect may bend the motion far
    away from the baseline's. Probes that lie apart all go on: two masts of 7 and 9 Hz, a third of a second into
    releases of a robot that has one of 7.8 Hz (bank 5057), were 120 behind nothing, and are 28,000 ahead in the end.
    """
    loud = _loudest(base)
    few = evaluate([base.trials[k] for k in loud], base.model, base.point, [base.nuisances[k] for k in loud])
    first = horizon_fit(few.trials, few.model, few.point, lengths[:1], STEPS, few.nuisances)
    known = _from_what_is_known(first)
    starts = [
        (start, suspect)
        for group in groups
        for suspect in group
        for start in ((first, known) if CATALOGUE[suspect.effect].sudden else (first,))
        if start is not None
    ]
    begins = [partial(_begun, *start) for start in starts]
    if known is not None:
        # a baseline that has stiffened round a tire that hardens leaves that no room
        begins += [partial(begun_in_its_place, first, group[0], HEATS[0][1]) for group in groups[:REPLACED]]
    field: list[JointFit] = []
    rounds = len(begins) + 3
    for fit in side_by_side(lambda begin: begin(), begins):
        if progress:
            progress("trying effects", len(field), rounds)
        field.append(fit)
    apart = [
        fit
        for fit, (_, suspect) in zip(field, starts, strict=False)
        if CATALOGUE[suspect.effect].apart and np.isfinite(fit.rss)
    ]
    second = lengths[1:2] if len(lengths) > 2 else lengths[:1]
    for heat, (kept, steps) in enumerate(HEATS[1:]):
        ordered = ranked(field)
        # after a step or two the first dozen may all be of two effects
        once = [] if heat else [*(f for f in _each_form(ordered) if f not in apart), *apart]
        field = [*once, *(f for f in _few_unlisted(ordered)[:kept] if f not in once)]
        field = list(side_by_side(partial(_led_on, few.trials, second, steps), field))
        if progress:
            progress("trying effects", len(begins) + heat, rounds)
    if progress:
        progress("trying effects", 1, 1)
    return ranked(field)


def _led_on(trials: Sequence[Trial], lengths: Sequence[float], steps: int, fit: JointFit) -> JointFit:
    return horizon_fit(trials, fit.model, fit.point, lengths, steps, fit.nuisances)


def _enlarged(base: JointFit, suspect: Suspect) -> JointFit | None:
    """A suspect many times as large as a straight line promises, led on; None where that alone does not halve what is
    left.

    Each recording in its own noise, not by plain squares: those of one that is 30,000 times its noise drew the mass 60
    standard deviations away, and hardening ended at a cost of 277 where four steps from here lead to -7.
    """
    grown = as_large_as_it_takes(base, suspect)
    return descend(grown, 4) if grown.rss < 0.5 * base.rss else None


def _from_what_is_known(fit: JointFit) -> JointFit | None:
    """The physics that is known beside a baseline that has left it; None where that has not.

    A baseline bends far round wheels that lift in one loud release, and where it is bent so they do not lift.
    """
    if not far_off(fit).any():
        return None
    return descend(follow(fit.trials, fit.model, fit.model.as_known(fit.point)), 2)


def begun_in_its_place(base: JointFit, suspect: Suspect, steps: int = 2) -> JointFit:
    """A suspect in the place of what a baseline has bent, in the size that costs least there.

    Where nothing is bent the size is worth it by itself: a straight line that has to tell relaxation from chattering
    contacts made 3,586 N/m of 523 (bank 6374), from where a descent ended 26 above the baseline; from the best size it
    ends 67 below, and 87 from the truth.
    """
    return descend(in_its_place(base, suspect, far_off(base)), steps)


def _begun(first: JointFit, suspect: Suspect) -> JointFit:
    """A probe's first step on the first horizon; where it is worse than nothing, from starts of its own as well.

    Where wheels have play, the start that a release has without it lies on the other side of the gap.
    """
    probe = beside(first, suspect)
    fit = descend(probe, HEATS[0][1])
    if fit.cost(first.counted) < first.cost(first.counted) or not CATALOGUE[suspect.effect].loosens:
        return fit
    starts = [nearest(first.trials, probe.model, probe.point, near) for near in (first.nuisances, None)]
    anew = descend(each_best(starts), HEATS[0][1])
    return ranked((fit, anew))[0] if np.isfinite(anew.rss) else fit


def ranked(fits: Sequence[JointFit]) -> list[JointFit]:
    """Fits, the best first: by what they leave, in the best one's independent samples, and by their numbers."""
    finite = [f for f in fits if np.isfinite(f.rss)]
    if not finite:
        return []
    counted = min(finite, key=lambda f: float(np.log(f.parts).sum())).counted
    # a formula with one number more has to be that much better (Schwarz), one with a state more by what chance gives
    return sorted(finite, key=lambda f: f.cost(counted) + len(f.model.free) * float(np.log(counted.sum())) + f.states)


def within_reach(ranked: Sequence[JointFit], fit: JointFit) -> bool:
    """Whether a refit to the end may still bring one before the first."""
    if not ranked:
        return False
    counted = ranked[0].counted
    return fit.cost(counted) < ranked[0].cost(counted) + CLOSE * float(counted.sum())


def _loudest(base: JointFit) -> list[int]:
    """The loudest trial of each kind; of a rig's, which are all of one kind, the quietest as well."""
    kinds: dict[tuple[str, str], list[int]] = {}
    for index, trial in enumerate(base.trials):
        kinds.setdefault((trial.experiment.name, trial.kind), []).append(index)
    chosen = set()
    for members in kinds.values():
        ordered = sorted(members, key=lambda k: float(np.ptp(base.trials[k].target)))
        chosen |= {ordered[-1]} if base.trials[members[0]].kind else {ordered[-1], ordered[0]}
    return sorted(chosen)


def started(base: JointFit, suspect: Suspect, plain: bool = False) -> JointFit:
    begun = beside(base, suspect)
    if CATALOGUE[suspect.effect].sudden and not slides(base) and not within_reach([base], begun):
        return begun  # all else has settled beside it: 10 of 10 such probes stayed behind
    return descend(gathered(begun), 2, plain=plain)


def started_from_known(base: JointFit, suspect: Suspect, plain: bool = False) -> JointFit:
    """A suspect beside all else as it is known: from the hollow where pulls leave a baseline no effect may come near.

    Play of 0.84 mm ended at most 32 below the cost of a baseline of 443, and 189 below it from here. A wheel's load
    that a baseline had put elsewhere, by 24 standard deviations, stayed there beside a soft cable, 740 behind here.
    """
    model, point = with_suspect(base, suspect)
    return descend(evaluate(base.trials, model, model.as_known(point), base.nuisances), 4, plain=plain)
