"""The search: the baseline at its best, every effect beside it, then what two effects do together."""

from __future__ import annotations

import itertools
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from scipy.stats import chi2

from ssmr_ident.compare.recorded import follow, radian
from ssmr_ident.core.parameter import ParameterSet
from ssmr_ident.diagnose.accept import CHANCE
from ssmr_ident.diagnose.explain import from_what_is_known
from ssmr_ident.diagnose.race import FAR, Progress, raced, ranked, run_on, screened, started, variants
from ssmr_ident.diagnose.scan import Suspect, candidates, scan
from ssmr_ident.diagnose.setup import Setup
from ssmr_ident.diagnose.start import begin
from ssmr_ident.identify.clouds import settled
from ssmr_ident.identify.descent import LOUD, chatters, descend
from ssmr_ident.identify.horizons import horizons, led
from ssmr_ident.identify.joint import JointFit, differentiate, evaluate
from ssmr_ident.identify.swings import led_through_slides
from ssmr_ident.identify.trials import Trial
from ssmr_ident.physics.effect import Site
from ssmr_ident.physics.effects import CATALOGUE

PROMISING = 6.0
"""Fall of n ln(RSS), beyond one for each parameter, from which a suspect is refitted. Noise alone passes it in
1 to 2 of 100 probes (chi-square, one and two parameters); passing costs time and decides nothing."""

CLOSE = 1.5
"""Difference in the logarithm of the unexplained variance, before refits have come to rest, up to which an effect may
still overtake another: a factor of 4.5."""

WIDE = 4.0
"""Variance over the noise's that the median recording may be left with when an effect has been found already, or where
what pulls leave may be swings out of step: of sessions without missing physics it was left with up to 3.5."""

SCREENED, REFITTED = 8, 3
"""Effects that are refitted on the first horizons, and to the end."""

ASIDE = 1.5
"""Standard deviations of what is known of the centre of mass, where pulls are begun again."""

LAST = 8
"""Gauss-Newton steps on whole recordings."""


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
    """

    baseline: JointFit
    suspects: tuple[tuple[Suspect, ...], ...]
    tried: tuple[JointFit, ...]
    lengths: tuple[float, ...]


def fit_baseline(trials: Sequence[Trial], setup: Setup, parameters: ParameterSet) -> JointFit:
    """Maximum a posteriori of the baseline, mains lines and noise taken from what it leaves."""
    fit = begin(trials, setup, parameters)
    fit = descend(fit, 2)
    fit = evaluate(prepared(fit), fit.model, fit.point, fit.nuisances, fit.slopes)
    return differentiate(descend(fit, LAST))


def prepared(fit: JointFit) -> list[Trial]:
    """A fit's trials with the mains lines that stand out of its residual.

    Where no quiet tail tells the noise, it is what the fit leaves at its fastest.
    """
    found = []
    for trial, simulated in zip(fit.trials, fit.simulated, strict=True):
        clean = trial.with_lines(trial.colour(simulated))
        found.append(clean if trial.quiet else clean.renoised(simulated))
    return found


def best_baseline(
    trials: Sequence[Trial], setup: Setup, parameters: ParameterSet
) -> tuple[JointFit, tuple[float, ...]]:
    """The baseline from two roads: straight over whole recordings, and led from their beginnings where that leaves
    more than noise."""
    fit = fit_baseline(trials, setup, parameters)
    lengths = tuple(horizons(fit.trials, radian(fit.trials)))
    if _leaves_much(fit) and len(lengths) > 1:
        other = differentiate(led(fit.trials, fit.model, fit.point, lengths, LAST // 2))
        fit = min((fit, other), key=lambda f: f.cost(fit.counted))
    return led_out(fit) if chatters(fit) or unsteady(fit) else called_back(fit), lengths


def called_back(fit: JointFit) -> JointFit:
    """A fit that leaves little and has left what is known for it, begun again with one such parameter as known.

    Gains, a centre of mass and inertias stand in for each other in pairs, far from the truth as well; of a hollow
    seven deviations off one parameter alone shows the way out.
    """
    left = fit.parts / [t.size for t in fit.trials]
    far = np.flatnonzero(np.abs(fit.point[: len(fit.model.physics)]) > FAR)
    if not len(far) or not float(np.median(left)) < WIDE or any(t.searched for t in fit.trials):
        return fit
    ends = [fit]
    for column in far:
        point = fit.point.copy()
        point[column] = 0.0
        ends.append(descend(follow(fit.trials, fit.model, point, fit.nuisances), LAST))
    best = min(ends, key=lambda f: f.cost(fit.counted))
    return differentiate(best)


def led_out(fit: JointFit) -> JointFit:
    """Pulls led out of the hollow in which a descent has left them: from all sides, through their slides, by clouds."""
    begun = (fit, *from_all_sides(fit))
    best = min((*begun, *(led_through_slides(f) for f in begun if unsteady(f))), key=lambda f: f.cost(fit.counted))
    best = min((best, descend(best, LAST), descend(settled(best), LAST)), key=lambda f: f.cost(fit.counted))
    return differentiate(best)


def unsteady(fit: JointFit) -> bool:
    """Whether pulls leave more than noise does by chance, and no more than swings that are out of step.

    Far less than what is large: from a hollow of the baseline any effect is a way out. Where most recordings are left
    with much more, it is no swing that is missed.
    """
    by_chance = [chi2.isf(CHANCE, t.size) if t.slides_from is not None else np.inf for t in fit.trials]
    near = float(np.median(fit.parts / [t.size for t in fit.trials])) < WIDE
    return near and bool(np.any(fit.parts > by_chance))


def from_all_sides(fit: JointFit) -> list[JointFit]:
    """Pulls fitted from a centre of mass off to either side, front or back.

    It decides which wheel lets go first, and a descent does not change that order: a wrong one is a hollow.
    """
    names = [unknown.name for unknown in fit.model.physics]
    own = [names.index(name) for name in ("contact_shift_x_m", "contact_shift_y_m") if name in names]
    begun = []
    for signs in itertools.product((-ASIDE, ASIDE), repeat=len(own)):
        point = fit.point.copy()
        point[own] = signs
        begun.append(descend(evaluate(fit.trials, fit.model, point, fit.nuisances), 3, plain=True))
    nearest = sorted(begun, key=lambda f: f.rss + f.penalty if np.isfinite(f.rss) else np.inf)
    return [descend(f, LAST) for f in nearest[:1] if np.isfinite(f.rss)]


def search(
    base: JointFit,
    baseline: str,
    lengths: Sequence[float],
    further: bool = False,
    progress: Progress | None = None,
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
    """
    misfit = base.parts / [t.size for t in base.trials]
    # one recording that stands out may be the only one in which a wheel lifts; beside an effect that explains the
    # others it is more likely the effect's own formula
    loud = float(np.median(misfit)) > WIDE if further else float(np.max(misfit)) > LOUD
    # pulls along one axis alone may show what tires do that go far
    loud = loud or (chatters(base) and float(np.max(misfit)) > WIDE)
    groups = scan(base, candidates(base, baseline), small=not loud)
    rest = [np.inf]
    if loud and len(lengths) > 1:
        rough = screened(base, groups, lengths, progress)
        rest = list(lengths[1:])
    elif loud:
        rough = raced(base, groups, progress)
    else:
        chosen = [g for g in groups if g[0].gain > PROMISING + len(g[0].at)][: REFITTED if further else SCREENED]
        alone = bent(base) and not further and len(lengths) > 1
        hidden = [g for g in groups if alone and _moves_beyond(g[0].effect)]
        field = [started(base, s) for group in _each_group(chosen, hidden) for s in variants(group)]
        rough = run_on(field + [from_what_is_known(base, s, lengths) for group in hidden for s in variants(group)])
    tried = _to_the_end(base, rough, rest, lengths, progress)
    if loud and baseline == "sdof" and len(lengths) > 1 and tried and _leaves_much(ranked(tried)[0]):
        # what a first horizon tells of two recordings had put something else in front; rigs are simulated in no time
        tried += _to_the_end(base, raced(base, groups, progress), [np.inf], lengths, progress)
    if progress:
        progress("refitting explanations", 1, 1)
    return Search(base, tuple(tuple(g) for g in groups), tuple(_each_once(tried)), tuple(lengths))


def _to_the_end(
    base: JointFit,
    rough: Sequence[JointFit],
    rest: Sequence[float],
    lengths: Sequence[float],
    progress: Progress | None,
) -> list[JointFit]:
    """The first few of what was tried, refitted to all recordings at their full length."""
    tried: list[JointFit] = []
    rough = _finalists([fit for fit in rough if _close(rough, fit)], starts=2 if chatters(base) else 1)
    for index, fit in enumerate(rough):
        if progress:
            progress("refitting explanations", index, len(rough))
        if chatters(base):
            fit = descend(fit, LAST // 2, plain=True)
        begun = led(base.trials, fit.model, fit.point, rest, LAST // 2, _all_nuisances(base, fit, lengths))
        # what is as far behind as this halfway does not win, and where exactly it ends decides nothing
        tried.append(mended(descend(begun, LAST - LAST // 2)) if _close(ranked([begun, *tried]), begun) else begun)
    return tried


def _leaves_much(fit: JointFit) -> bool:
    return float(np.max(fit.parts / [t.size for t in fit.trials])) > LOUD


def _each_group(*lists: Sequence[Sequence[Suspect]]) -> list[Sequence[Suspect]]:
    return list({group[0].effect: group for groups in lists for group in groups}.values())


def _moves_beyond(effect_id: str) -> bool:
    """Whether an effect changes motions, and that only beyond some value."""
    effect = CATALOGUE[effect_id]
    return effect.sudden and Site.OUTPUT not in effect.acts


def bent(fit: JointFit) -> bool:
    """Whether a baseline has left what is known of it, as it does to follow recordings without what is missing."""
    return float(np.max(np.abs(fit.point[: len(fit.model.physics)]), initial=0.0)) > FAR


def mended(fit: JointFit) -> JointFit:
    """A fit that explains most of its recordings, the others begun elsewhere: one release in a valley of its own spoils
    the physics that all share."""
    left = fit.parts / [t.size for t in fit.trials]
    if not float(np.median(left)) < LOUD < float(np.max(left)):
        return fit
    return descend(follow(fit.trials, fit.model, fit.point, fit.nuisances), LAST)


def _close(ranked: Sequence[JointFit], fit: JointFit) -> bool:
    """Whether a refit to the end may still bring one before the first."""
    if not ranked:
        return False
    counted = ranked[0].counted
    return fit.cost(counted) < ranked[0].cost(counted) + CLOSE * float(counted.sum())


def _finalists(ranked: Sequence[JointFit], starts: int) -> list[JointFit]:
    """The first few effects, and of the very first also what is tried and not fitted of it.

    ``starts`` is how many fits of the very first go on: where contacts let go, how far one comes in a few steps says
    little of where it ends.
    """
    if not ranked:
        return []
    effects = list(dict.fromkeys(fit.model.ids for fit in ranked))[:REFITTED]
    best: dict[tuple[object, ...], list[JointFit]] = {}
    for fit in ranked:
        if fit.model.ids in effects:
            first = fit.model.ids == effects[0]
            own = fit.model.held[fit.model.ids[-1]] if first else {}
            same = best.setdefault((fit.model.ids, *own.values()), [])
            if len(same) < (starts if first else 1):
                same.append(fit)
    return [fit for same in best.values() for fit in same]


def _each_once(fits: Sequence[JointFit]) -> list[JointFit]:
    """Of every effect the fit that leaves least."""
    best: dict[tuple[str, ...], JointFit] = {}
    for fit in ranked(fits):
        best.setdefault(fit.model.ids, fit)
    return list(best.values())


def _all_nuisances(base: JointFit, fit: JointFit, lengths: Sequence[float]) -> list[np.ndarray]:
    """Nuisances for all trials: those of the fit, and for trials that it left out those that fit it best."""
    known = {trial.name: own for trial, own in zip(fit.trials, fit.nuisances, strict=True)}
    left = [trial for trial in base.trials if trial.name not in known]
    if left:
        second = lengths[min(1, len(lengths) - 1)]
        short = follow([trial.until(second) for trial in left], fit.model, fit.point, kin=fit)
        known |= {trial.name: own for trial, own in zip(left, short.nuisances, strict=True)}
    return [known[trial.name] for trial in base.trials]
