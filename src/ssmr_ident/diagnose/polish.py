"""An explanation led to its best: further, from other starts, in other formulas."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from functools import partial

import numpy as np

from ssmr_ident.core.threads import side_by_side
from ssmr_ident.diagnose.baseline import LAST, leaves_much, unsteady
from ssmr_ident.diagnose.finals import anew, mended
from ssmr_ident.diagnose.formulas import other_formulas
from ssmr_ident.diagnose.gathered import gathered
from ssmr_ident.diagnose.race import far_off, ranked
from ssmr_ident.diagnose.scan import held_at
from ssmr_ident.diagnose.weigh import TIE
from ssmr_ident.identify.fitting.after_release import fit_past_release
from ssmr_ident.identify.fitting.descent import LOUD, chatters, descend
from ssmr_ident.identify.fitting.horizons import horizon_fit
from ssmr_ident.identify.fitting.joint import JointFit, evaluate
from ssmr_ident.identify.fitting.sampled_slopes import settled
from ssmr_ident.physics.effects import CATALOGUE

MOST_TURNS = 2
"""Formulas that are found one from the other: a spring's knee from a cubic in proportion to its stiffness."""


def turned(fit: JointFit, lengths: tuple[float, ...]) -> JointFit:
    """The best of a fit and its like: with other values of what is tried of its last effect and not fitted, and with
    its effects in other formulas."""
    if not loud(fit):
        return fit
    effect_id = fit.model.ids[-1]
    own = fit.model.held[effect_id]
    best, rest = fit, lengths[1:] or lengths
    for tried in held_at(CATALOGUE[effect_id], fit.model):
        if tried != {name: own[name] for name in tried}:
            model = replace(fit.model, held={**fit.model.held, effect_id: {**own, **tried}})
            best = ranked((best, horizon_fit(fit.trials, model, fit.point, rest, LAST, fit.nuisances)))[0]
    for name in fit.model.ids:
        for _ in range(MOST_TURNS):
            before, best = best, _otherwise(best, name, rest)
            if best is before or not leaves_much(best):
                break
    return best


def _otherwise(fit: JointFit, name: str, lengths: tuple[float, ...]) -> JointFit:
    """The best of a fit and those with one of its effects in another formula; along one axis a cubic spring and one in
    proportion to its stiffness are the same law, and the one that it was begun with stays."""
    forms = list(other_formulas(fit, name))
    others = side_by_side(lambda form: horizon_fit(fit.trials, *form, lengths, LAST, fit.nuisances), forms)
    first = ranked((fit, *others))[0]
    return first if fit.cost(first.counted) - first.cost(first.counted) > 2.0 * TIE else fit


def loud(fit: JointFit) -> bool:
    """Whether the median recording is left with more than noise."""
    return float(np.median(fit.parts / [t.size for t in fit.trials])) > LOUD


def polish(fit: JointFit, lengths: tuple[float, ...], refitted: bool = False) -> JointFit:
    """An explanation led to its best: on from where it stands, and where that is far from what is known or leaves more
    than noise, once more from what is known.

    ``refitted`` is one that a search has led to its end, other starts of its recordings among it.
    """

    def on() -> JointFit:
        return heard(gathered(mended(descend(gathered(fit), LAST), fit if refitted else None)))

    # what is in doubt before it has been led on is in doubt for good, as a rule
    ways: list[Callable[[], JointFit]] = [on, partial(anew, fit, lengths)] if _doubtful(fit, lengths) else [on]
    further, *others = side_by_side(lambda way: way(), ways)
    if not _doubtful(further, lengths):
        return further
    return min((*(others or [anew(further, lengths)]), further), key=lambda f: f.cost(further.counted))


def _doubtful(fit: JointFit, lengths: tuple[float, ...]) -> bool:
    """Whether a fit that can be led over horizons is far from what is known, or leaves more than noise."""
    return len(lengths) > 1 and (loud(fit) or bool(far_off(fit).any()))


def heard(fit: JointFit) -> JointFit:
    """A fit that leaves much in some recordings, led by those alone and then on with all, where that is better.

    What a recording leaves is what it is measured by: those that are explained to the noise hold the fit where it is,
    and those that are not have no say. Pulls are led by plain squares, through their slides, and by clouds.
    """
    if chatters(fit):
        return calmed(fit)
    left = fit.parts / [t.size for t in fit.trials]
    unheard = [k for k, size in enumerate(left) if size > LOUD]
    if not unheard or len(unheard) == len(left):
        return fit
    few = [fit.trials[k] for k in unheard], [fit.nuisances[k] for k in unheard]
    led_by = descend(evaluate(few[0], fit.model, fit.point, few[1]), LAST)
    own = dict(enumerate(fit.nuisances)) | dict(zip(unheard, led_by.nuisances, strict=True))
    other = descend(evaluate(fit.trials, fit.model, led_by.point, [own[k] for k in range(len(left))]), LAST)
    return ranked((fit, other))[0]


def calmed(fit: JointFit) -> JointFit:
    """Pulls led on by plain squares, through their slides where these may be out of step, and by clouds.

    Through the slides at once: a descent over the whole of them would first find the nearest hollow.
    """
    begun = descend(fit, LAST, plain=True)
    if unsteady(fit):
        begun = min((begun, fit_past_release(fit)), key=lambda f: f.rss + f.penalty)
    return ranked((fit, descend(settled(begun), LAST)))[0]
