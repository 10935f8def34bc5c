"""The baseline at its best: over whole recordings, led from their beginnings, led out of hollows."""

from __future__ import annotations

import itertools
from collections.abc import Sequence
from dataclasses import replace

import numpy as np
from scipy.stats import chi2

from ssmr_ident.compare.recorded import follow
from ssmr_ident.core.parameter import ParameterSet
from ssmr_ident.core.threads import side_by_side
from ssmr_ident.diagnose.accept import CHANCE
from ssmr_ident.diagnose.hollows import from_afar
from ssmr_ident.diagnose.race import far_off
from ssmr_ident.diagnose.setup import Setup
from ssmr_ident.diagnose.start import begin, pooled
from ssmr_ident.identify.fitting.after_release import fit_past_release
from ssmr_ident.identify.fitting.descent import LOUD, chatters, descend, slides
from ssmr_ident.identify.fitting.horizons import horizon_fit, horizons, radian
from ssmr_ident.identify.fitting.joint import JointFit, differentiate, evaluate
from ssmr_ident.identify.fitting.sampled_slopes import settled
from ssmr_ident.identify.trials import Trial
from ssmr_ident.signals.noise import block_noises

WIDE = 4.0
"""Variance over the noise's that the median recording may be left with when an effect has been found already, or where
what pulls leave may be swings out of step: of sessions without missing physics it was left with up to 3.5."""

SWINGS = 10.0
"""Variance over the noise's that a single pull may be left with in a hollow: of 80 sessions without missing physics the
baselines of 13 left more than noise, up to 2.4 in twelve and 6.7 in one. A pull that leaves
more is taken to lack something. Under an earlier law of contacts one null session had stood at 14.7."""

ASIDE = 1.5
"""Standard deviations of what is known of the centre of mass, where pulls are begun again."""

LAST = 8
"""Gauss-Newton steps on whole recordings."""


def fit_baseline(trials: Sequence[Trial], setup: Setup, parameters: ParameterSet) -> JointFit:
    """Maximum a posteriori of the baseline, mains lines and noise taken from what it leaves."""
    fit = begin(trials, setup, parameters)
    fit = descend(fit, 2)
    fit = evaluate(prepared(fit), fit.model, fit.point, fit.nuisances, fit.slopes)
    return differentiate(descend(fit, LAST))


def prepared(fit: JointFit) -> list[Trial]:
    """A fit's trials with the mains lines that stand out of its residual.

    Where no quiet tail tells the noise, it is what the fit leaves at its fastest; of a load cell, what it leaves of all
    pulls together.
    """
    found: list[Trial] = []
    slow: list[tuple[int, np.ndarray]] = []
    for trial, simulated in zip(fit.trials, fit.simulated, strict=True):
        clean = trial.with_lines(trial.colour(simulated))
        together = trial.channels == ("force",) and not trial.quiet
        if together:
            slow.append((len(found), simulated))
        found.append(clean if trial.quiet or together else clean.renoised(simulated))
    blocks = [found[index].blocks(simulated) for index, simulated in slow]
    for (index, _), std in zip(slow, block_noises(blocks) if slow else (), strict=True):
        found[index] = found[index].with_noises((replace(found[index].noises[0], std=float(std)),))
    return found


def best_baseline(
    trials: Sequence[Trial], setup: Setup, parameters: ParameterSet
) -> tuple[JointFit, tuple[float, ...]]:
    """The baseline from two roads: straight over whole recordings, and led from their beginnings where that leaves
    more than noise."""
    fit = fit_baseline(trials, setup, parameters)
    lengths = tuple(horizons(fit.trials, radian(fit.trials)))
    if leaves_much(fit) and len(lengths) > 1:
        other = differentiate(horizon_fit(fit.trials, fit.model, fit.point, lengths, LAST // 2))
        fit = min((fit, other), key=lambda f: f.cost(fit.counted))
    if any(trial.uneven is not None for trial in fit.trials):
        other = brought_home(uneven(fit))
        if other.cost(fit.counted) < fit.cost(fit.counted):
            return other, lengths
    return brought_home(fit), lengths


def uneven(fit: JointFit) -> JointFit:
    """A fit of pulls of a robot that is alike left and right, led on with what all pulls say of where it is not."""
    begun = evaluate([t.as_it_is() for t in fit.trials], fit.model, fit.point, fit.nuisances)
    return differentiate(descend(pooled(begun), LAST)) if np.isfinite(begun.rss) else begun


def alike_in(kept: Sequence[Trial], fitted: Sequence[Trial]) -> list[Trial]:
    """Recordings kept back, of a robot that is as even as that of those that were fitted."""
    return list(kept) if any(t.uneven is not None for t in fitted) else [t.as_it_is() for t in kept]


def brought_home(fit: JointFit) -> JointFit:
    """A fit led out of the hollow in which a descent has left it, where it may be in one."""
    return led_out(fit) if chatters(fit) or unsteady(fit) else called_back(fit)


def called_back(fit: JointFit) -> JointFit:
    """A fit that leaves little and has left what is known for it, begun again with one such parameter as known.

    Gains, a centre of mass and inertias stand in for each other in pairs, far from the truth as well; of a hollow
    seven deviations off one parameter alone shows the way out.
    """
    left = fit.parts / [t.size for t in fit.trials]
    far = np.flatnonzero(far_off(fit))
    if not len(far) or not float(np.median(left)) < WIDE or slides(fit):
        return fit

    def home(column: int) -> JointFit:
        point = fit.point.copy()
        point[column] = 0.0
        return descend(follow(fit.trials, fit.model, point, fit.nuisances), LAST)

    best = min((fit, *side_by_side(home, far.tolist())), key=lambda f: f.cost(fit.counted))
    return differentiate(best)


def begun_again(fit: JointFit, lengths: Sequence[float]) -> JointFit | None:
    """Decays of which a bent baseline leaves much, led once more from what is known; None where it is another case.

    Both roads of ``best_baseline`` end near where the first one went. With nothing missing (bank 5796) that was at 2 to
    12 times the noise's variance, with the place of the accelerometer 11 deviations off, and a cost of 3,461; from what
    is known it is 2,296, and 2,275 from the true values.
    """
    if slides(fit) or len(lengths) == 1 or not bent(fit) or not leaves_much(fit):
        return None
    return differentiate(called_back(horizon_fit(fit.trials, fit.model, np.zeros_like(fit.point), lengths, LAST)))


def led_out(fit: JointFit) -> JointFit:
    """Pulls led out of the hollow in which a descent has left them: from all sides, through their slides, by clouds."""
    begun = (fit, *from_all_sides(fit))
    best = min((*begun, *(fit_past_release(f) for f in begun if unsteady(f))), key=lambda f: f.cost(fit.counted))
    best = min((best, descend(best, LAST), descend(settled(best), LAST)), key=lambda f: f.cost(fit.counted))
    afar = from_afar(best) if unsteady(best) and swings_alone(best) else []
    return differentiate(min((best, *afar), key=lambda f: f.cost(best.counted)))


def unsteady(fit: JointFit) -> bool:
    """Whether pulls leave more than noise does by chance, and no more than swings that are out of step.

    Far less than what is large: from a hollow of the baseline any effect is a way out. Where most recordings are left
    with much more, it is no swing that is missed.
    """
    left = fit.parts / [t.size for t in fit.trials]
    swings = np.array([t.slides_from is not None for t in fit.trials])
    return float(np.median(left)) < WIDE and bool(np.any(swings & (left > chi2.isf(CHANCE, fit.counted) / fit.counted)))


def swings_alone(fit: JointFit) -> bool:
    """Whether no recording is left with more than swings that are out of step."""
    return float(np.max(fit.parts / [t.size for t in fit.trials])) < SWINGS


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


def leaves_much(fit: JointFit) -> bool:
    return float(np.max(fit.parts / [t.size for t in fit.trials])) > LOUD


def bent(fit: JointFit) -> bool:
    """Whether a baseline has left what is known of it, as it does to follow recordings without what is missing."""
    return bool(np.any(far_off(fit)))
