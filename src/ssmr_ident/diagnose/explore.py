"""The search: the baseline at its best, every effect beside it, then what two effects do together."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np

from ssmr_ident.compare.recorded import follow, radian
from ssmr_ident.core.parameter import ParameterSet
from ssmr_ident.diagnose.explain import beside
from ssmr_ident.diagnose.scan import Suspect, both_ways, candidates, scan
from ssmr_ident.diagnose.setup import Setup
from ssmr_ident.diagnose.start import begin
from ssmr_ident.identify.descent import chatters, descend
from ssmr_ident.identify.horizons import STEPS, horizons, led
from ssmr_ident.identify.joint import JointFit, differentiate, evaluate
from ssmr_ident.identify.trials import Trial
from ssmr_ident.physics.effects import CATALOGUE

Progress = Callable[[str, int, int], None]

PROMISING = 6.0
"""Fall of n ln(RSS), beyond one for each parameter, from which a suspect is refitted. Noise alone passes it in
1 to 2 of 100 probes (chi-square, one and two parameters); passing costs time and decides nothing."""

LOUD = 2.0
"""Variance over the noise's from which a residual is large: then effects are tried by simulation alone."""

CLOSE = 1.5
"""Difference in the logarithm of the unexplained variance, before refits have come to rest, up to which an effect may
still overtake another: a factor of 4.5."""

WIDE = 4.0
"""The same for the median recording when an effect has been found already."""

HEATS = ((0, 1), (12, 3), (6, 4))
"""Rounds in which probes are tried: how many go in, and Gauss-Newton steps in each. All probes go into the first, on
the first horizon; the others are run on the second."""

SCREENED, REFITTED = 8, 3
"""Effects that are refitted on the first horizons, and to the end."""

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
    if float(np.max(fit.parts / [t.size for t in fit.trials])) > LOUD and len(lengths) > 1:
        other = differentiate(led(fit.trials, fit.model, fit.point, lengths, LAST // 2))
        fit = min((fit, other), key=lambda f: f.cost(fit.counted))
    return fit, lengths


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
        rough = _screened(base, groups, lengths, progress)
        rest = list(lengths[1:])
    elif loud:
        rough = _raced(base, groups, progress)
    else:
        chosen = [g for g in groups if g[0].gain > PROMISING + len(g[0].at)][: REFITTED if further else SCREENED]
        rough = ranked([_started(base, suspect) for group in chosen for suspect in _variants(group)])
    tried: list[JointFit] = []
    rough = _finalists([fit for fit in rough if _close(rough, fit)])
    for index, fit in enumerate(rough):
        if progress:
            progress("refitting explanations", index, len(rough))
        if chatters(base):
            fit = descend(fit, LAST // 2, plain=True)
        begun = led(base.trials, fit.model, fit.point, rest, LAST // 2, _all_nuisances(base, fit, lengths))
        # what is as far behind as this halfway does not win, and where exactly it ends decides nothing
        tried.append(mended(descend(begun, LAST - LAST // 2)) if _close(ranked([begun, *tried]), begun) else begun)
    if progress:
        progress("refitting explanations", 1, 1)
    return Search(base, tuple(tuple(g) for g in groups), tuple(_each_once(tried)), tuple(lengths))


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


def _finalists(ranked: Sequence[JointFit]) -> list[JointFit]:
    """The first few effects, and of the very first also what is tried and not fitted of it."""
    if not ranked:
        return []
    effects = list(dict.fromkeys(fit.model.ids for fit in ranked))[:REFITTED]
    best: dict[tuple[object, ...], JointFit] = {}
    for fit in ranked:
        if fit.model.ids in effects:
            own = fit.model.held[fit.model.ids[-1]] if fit.model.ids == effects[0] else {}
            best.setdefault((fit.model.ids, *own.values()), fit)
    return list(best.values())


def _each_once(fits: Sequence[JointFit]) -> list[JointFit]:
    """Of every effect the fit that leaves least."""
    best: dict[tuple[str, ...], JointFit] = {}
    for fit in ranked(fits):
        best.setdefault(fit.model.ids, fit)
    return list(best.values())


def _each_form(ranked: Sequence[JointFit]) -> list[JointFit]:
    """Of every effect, in each formula, the fit that leaves least: a first step says little of where one ends."""
    best: dict[tuple[tuple[str, ...], ...], JointFit] = {}
    for fit in ranked:
        ids = fit.model.ids
        form = () if ids[-1] == "unlisted" else tuple(c.parameter.name for c in fit.model.free if c.effect == ids[-1])
        best.setdefault((ids, form), fit)
    return list(best.values())


def _few_unlisted(ordered: Sequence[JointFit]) -> list[JointFit]:
    """Fits without all terms of `unlisted` but the best two, which would crowd out every effect that shows later."""
    terms = [fit for fit in ordered if fit.model.ids[-1] == "unlisted"]
    return [fit for fit in ordered if fit not in terms[2:]]


def _raced(base: JointFit, groups: Sequence[Sequence[Suspect]], progress: Progress | None) -> list[JointFit]:
    """All effects on whole recordings, a few steps each; the most likely first.

    Pulls by plain squares: a wheel that lets go a moment later makes a step in a recording that is explained, and what
    that counts for outweighs the slope in the one that shows an effect.
    """
    plain = chatters(base)
    order = _by_squares if plain else ranked
    field = []
    for index, group in enumerate(groups):
        if progress:
            progress("trying effects", index, len(groups))
        for suspect in group:
            field += [_started(base, way, plain) for way in both_ways(suspect)]
    if progress:
        progress("trying effects", 1, 1)
    return order([descend(f, 2, plain=plain) for f in _few_unlisted(order(field))[: HEATS[2][0]]])


def _by_squares(fits: Sequence[JointFit]) -> list[JointFit]:
    return sorted((f for f in fits if np.isfinite(f.rss)), key=lambda f: f.rss + f.penalty)


def _screened(
    base: JointFit, groups: Sequence[Sequence[Suspect]], lengths: Sequence[float], progress: Progress | None
) -> list[JointFit]:
    """All effects on the first horizon, the better half on the second; the most likely first.

    Where much is left unexplained, what a straight line promises is no guide: an effect may bend the motion far
    away from the baseline's.
    """
    loud = _loudest(base)
    few = evaluate([base.trials[k] for k in loud], base.model, base.point, [base.nuisances[k] for k in loud])
    first = led(few.trials, few.model, few.point, lengths[:1], STEPS, few.nuisances)
    begun = []
    for index, group in enumerate(groups):
        if progress:
            progress("trying effects", index, len(groups) + 3)
        for suspect in group:
            begun.append(descend(beside(first, suspect), HEATS[0][1]))
    field = begun
    second = lengths[1:2] if len(lengths) > 2 else lengths[:1]
    for heat, (kept, steps) in enumerate(HEATS[1:]):
        ordered = ranked(field)
        # after a step or two the first dozen may all be of two effects
        once = [] if heat else _each_form(ordered)
        field = [*once, *(f for f in _few_unlisted(ordered)[:kept] if f not in once)]
        field = [led(few.trials, f.model, f.point, second, steps, f.nuisances) for f in field]
        if progress:
            progress("trying effects", len(groups) + heat, len(groups) + 3)
    if progress:
        progress("trying effects", 1, 1)
    return ranked(field)


def ranked(fits: Sequence[JointFit]) -> list[JointFit]:
    """Fits, the best first: by what they leave, in the best one's independent samples, and by their numbers."""
    finite = [f for f in fits if np.isfinite(f.rss)]
    if not finite:
        return []
    counted = min(finite, key=lambda f: float(np.log(f.parts).sum())).counted
    # a formula with one number more has to be that much better (Schwarz)
    return sorted(finite, key=lambda f: f.cost(counted) + len(f.model.free) * float(np.log(counted.sum())))


def _loudest(base: JointFit) -> list[int]:
    """The loudest trial of each kind; of a rig's, which are all of one kind, the quietest as well."""
    kinds: dict[tuple[str, str], list[int]] = {}
    for index, trial in enumerate(base.trials):
        kinds.setdefault((trial.experiment, trial.kind), []).append(index)
    chosen = set()
    for members in kinds.values():
        ordered = sorted(members, key=lambda k: float(np.ptp(base.trials[k].target)))
        chosen |= {ordered[-1]} if base.trials[members[0]].kind else {ordered[-1], ordered[0]}
    return sorted(chosen)


def _all_nuisances(base: JointFit, fit: JointFit, lengths: Sequence[float]) -> list[np.ndarray]:
    """Nuisances for all trials: those of the fit, and for trials that it left out those that fit it best."""
    known = {trial.name: own for trial, own in zip(fit.trials, fit.nuisances, strict=True)}
    left = [trial for trial in base.trials if trial.name not in known]
    if left:
        second = lengths[min(1, len(lengths) - 1)]
        short = follow([trial.until(second) for trial in left], fit.model, fit.point, kin=fit)
        known |= {trial.name: own for trial, own in zip(left, short.nuisances, strict=True)}
    return [known[trial.name] for trial in base.trials]


def _started(base: JointFit, suspect: Suspect, plain: bool = False) -> JointFit:
    return descend(beside(base, suspect), 2, plain=plain)


def _variants(group: Sequence[Suspect]) -> list[Suspect]:
    """The best probe of an effect, for each value of what is tried and not fitted; all of what acts beyond a threshold.

    A straight line promises nothing there.
    """
    found: dict[tuple[tuple[str, float], ...], Suspect] = {}
    for suspect in group:
        begun = suspect.at.items() if CATALOGUE[suspect.effect].sudden else ()
        found.setdefault((*sorted(suspect.held.items()), *begun), suspect)
    return list(found.values())
