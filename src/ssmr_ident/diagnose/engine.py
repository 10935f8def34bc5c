"""The diagnosis of decays, pulls and rigs: noise, baseline, is anything left, which, and what it is worth."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from scipy.stats import chi2

from ssmr_ident.compare.recorded import follow
from ssmr_ident.core.parameter import ParameterSet
from ssmr_ident.diagnose.coupling import coupled
from ssmr_ident.diagnose.explain import without
from ssmr_ident.diagnose.explore import LAST, LOUD, Progress, Search, best_baseline, mended, prepared, search
from ssmr_ident.diagnose.scan import combinations
from ssmr_ident.diagnose.setup import Setup
from ssmr_ident.diagnose.weigh import CERTAIN, TIE, Explanation, evidences
from ssmr_ident.identify.descent import descend
from ssmr_ident.identify.horizons import led
from ssmr_ident.identify.joint import JointFit, differentiate
from ssmr_ident.identify.trials import Trial
from ssmr_ident.physics.effects import CATALOGUE

MOST_EFFECTS = 2
"""Effects that are looked for together."""

SECOND = 0.5
"""Share of the first effect's unexplained variance, on recordings kept back, that may be left when a second one is
added: the right effect in a formula that is not quite the world's leaves structure, of which any other takes a part."""

FORMULA = 0.1
"""Share of the baseline's error below which what one effect leaves is put down to its own formula: a friction that is
rounded otherwise than the catalogue's leaves a hundredth, which some second effect always mends a little."""

UNHARMED, STRONG = 1.02, 0.5
"""Where no recording kept back shows an effect: the variance that it may add to them, and the share that it must leave
in the recording that shows it best."""

ALIKE = 2.0
"""Unexplained variance over that of the best explanation, up to which another counts as near as it."""

FAR = 3.0
"""Prior standard deviations by which a parameter may have moved beside an effect before the fit is begun again."""

CHANCE = 0.0027
"""Probability, that of three standard deviations, with which an amplitude may be as far from off by chance, or
n ln(RSS) on recordings kept back fall as far where the first effect is none."""


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
    fit, lengths = best_baseline(setup.fitted, setup, parameters)
    kept = tuple(prepared(follow(setup.kept, fit.model, fit.point)))
    if progress:
        progress("fitting the baseline", 1, 1)
    baseline = explained(kept, fit)
    tried, searches = [baseline], []
    chosen = baseline
    for _ in range(MOST_EFFECTS):
        if chosen is not baseline and _left(chosen, baseline) < FORMULA:
            break
        if setup.decoupled and chosen is baseline:
            new = [coupled(setup, parameters, kept)]
            result = Search(fit, (), tuple(e.fit for e in new), lengths)
        else:
            result = search(chosen.fit, setup.campaign.session.baseline, lengths, chosen is not baseline, progress)
            new = [explained(kept, f, chosen.kept) for f in result.tried]
        searches.append(result)
        if not new:
            break
        found = evidences([chosen, *new])
        leader = max(new, key=lambda e: found[e.id])
        if chosen is not baseline and _cost(leader, chosen) > _cost(chosen, chosen):
            tried = _with(tried, new)
            break
        polished = explained(kept, turned(polish(leader.fit, lengths), lengths), leader.kept)
        if polished.fit.cost(polished.fit.counted) < leader.fit.cost(polished.fit.counted):
            new[new.index(leader)], leader = polished, polished
        tried = _with(tried, new)
        found_fit = differentiate(leader.fit)
        first = chosen is baseline
        if not _better(leader, chosen, first) or not significant(found_fit):
            break
        bare = explained(
            kept, differentiate(descend(without(leader.fit, leader.fit.model.ids[-1]), LAST // 2)), leader.kept
        )
        if _cost(bare, chosen) < _cost(chosen, chosen):
            # the effect had only shown the way to a better fit without it
            tried[tried.index(chosen)], chosen = bare, bare
            baseline = bare if first else baseline
            if not _better(leader, bare, first):
                continue
        chosen = replace(leader, fit=found_fit)
        tried[tried.index(leader)] = chosen
    chosen, tried = _backward(kept, lengths, chosen, tried)
    found = evidences(tried)
    top = found[chosen.id]
    alike = [e for e in tried if e is not chosen and len(e.fit.model.ids) <= len(chosen.fit.model.ids)]
    rivals = sorted(
        (e for e in alike if e is not baseline and (top - found[e.id] < TIE or _as_near(e, chosen))),
        key=lambda e: -found[e.id],
    )
    return Outcome(setup, baseline, tuple(tried), chosen, tuple(rivals), found, tuple(searches))


def explained(kept: Sequence[Trial], fit: JointFit, near: JointFit | None = None) -> Explanation:
    """A fit beside what it predicts of the recordings that were kept back.

    ``near`` is another model's prediction of them, whose nuisances are a start as well.
    """
    return Explanation(fit, follow(kept, fit.model, fit.point, None if near is None else near.nuisances, fit))


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
    return replace(setup, model=replace(setup.model, physics=physics))


def turned(fit: JointFit, lengths: tuple[float, ...]) -> JointFit:
    """The better of a fit and its like with other values of what is tried of its last effect and not fitted."""
    effect_id = fit.model.ids[-1]
    own = fit.model.held[effect_id]
    best = fit
    effect = CATALOGUE[effect_id]
    for tried in combinations({**effect.holds, **effect.forms}):
        if tried == {name: own[name] for name in tried} or not loud(fit):
            continue
        model = replace(fit.model, held={**fit.model.held, effect_id: {**own, **tried}})
        other = led(fit.trials, model, fit.point, lengths[1:] or lengths, LAST, fit.nuisances)
        best = min((best, other), key=lambda f: f.cost(best.counted))
    return best


def loud(fit: JointFit) -> bool:
    """Whether the median recording is left with more than noise."""
    return float(np.median(fit.parts / [t.size for t in fit.trials])) > LOUD


def polish(fit: JointFit, lengths: tuple[float, ...]) -> JointFit:
    """An explanation led to its best: on from where it stands, and where that is far from what is known or leaves more
    than noise, once more from what is known."""
    further = mended(descend(fit, LAST))
    physics = len(further.model.physics)
    if len(lengths) == 1 or not (loud(further) or float(np.max(np.abs(further.point[:physics]), initial=0.0)) > FAR):
        return further
    return min((anew(further, lengths), further), key=lambda f: f.cost(further.counted))


def anew(fit: JointFit, lengths: tuple[float, ...]) -> JointFit:
    """The effects as they are, everything else begun from what is known of it."""
    point = fit.point.copy()
    point[: len(fit.model.physics)] = 0.0
    short = [t.until(lengths[0]) for t in fit.trials]
    begun = follow(short, fit.model, point, kin=fit)
    return mended(led(fit.trials, fit.model, point, lengths, LAST, begun.nuisances))


def _with(tried: Sequence[Explanation], new: Sequence[Explanation]) -> list[Explanation]:
    """Each model once, as last fitted: beside a better baseline all are tried again."""
    ids = {e.id for e in new}
    return [*(e for e in tried if e.id not in ids), *new]


def _cost(explanation: Explanation, reference: Explanation) -> float:
    return explanation.fit.cost(reference.fit.counted)


def _better(leader: Explanation, before: Explanation, first: bool) -> bool:
    """Whether an explanation is certainly better, and predicts recordings better that it has not seen."""
    found = evidences([before, leader])
    if found[leader.id] - found[before.id] <= CERTAIN:
        return False
    change = np.log(leader.kept.parts / before.kept.parts)
    saved = float(np.exp(np.mean(change)))
    if saved < SECOND or (first and -float(leader.kept.counted @ change) > chi2.isf(CHANCE, 1)):
        return True
    # a sensor clips in the loudest recording only: what was kept back need not show it, but must not suffer
    strongest = float(np.min(leader.fit.parts / before.fit.parts))
    return first and saved < UNHARMED and strongest < STRONG


def _left(chosen: Explanation, baseline: Explanation) -> float:
    """Size of what an explanation leaves over what the baseline left, mean over all recordings."""
    pairs = ((chosen.fit, baseline.fit), (chosen.kept, baseline.kept))
    return float(np.exp(0.5 * np.mean(np.concatenate([np.log(a.parts / b.parts) for a, b in pairs]))))


def _as_near(rival: Explanation, chosen: Explanation) -> bool:
    """Whether neither of two laws is the world's, and one is about as near to it as the other.

    Where the best law leaves more than the noise, its formula is wrong by that much; a rival whose error is no more
    than that again cannot be told from it by how well it fits.
    """
    left = chosen.kept.parts / [t.size for t in chosen.kept.trials]
    if float(np.median(left)) < LOUD or len(rival.fit.model.ids) != len(chosen.fit.model.ids):
        return False
    return float(np.exp(np.mean(np.log(rival.kept.parts / chosen.kept.parts)))) < ALIKE


def significant(fit: JointFit) -> bool:
    """Whether every effect's own amplitudes are away from off by more than their uncertainty allows (Wald's test)."""
    first = len(fit.model.physics)
    covariance, point = fit.covariance()[first:, first:], fit.point[first:]
    for effect_id in {c.effect for c in fit.model.free}:
        own = [k for k, c in enumerate(fit.model.free) if c.effect == effect_id and c.parameter.off is not None]
        away = np.array(
            # off is infinitely far in a logarithm; one that is known to a third is three deviations from nothing
            [1.0 / fit.model.free[k].unknown.spread if fit.model.free[k].unknown.logarithmic else point[k] for k in own]
        )
        if own and float(away @ np.linalg.solve(covariance[np.ix_(own, own)], away)) < chi2.isf(CHANCE, len(own)):
            return False
    return True


def _backward(
    kept: Sequence[Trial], lengths: tuple[float, ...], chosen: Explanation, tried: list[Explanation]
) -> tuple[Explanation, list[Explanation]]:
    """Take out of a pair the effect that the other one made superfluous."""
    ids = chosen.fit.model.ids
    if len(ids) < 2:
        return chosen, tried
    for effect_id in ids[:-1]:
        alone = explained(kept, differentiate(polish(without(chosen.fit, effect_id), lengths)), chosen.kept)
        tried = [*(e for e in tried if e.id != alone.id), alone]
        if not _better(chosen, alone, first=False):
            return alone, tried
    return chosen, tried
