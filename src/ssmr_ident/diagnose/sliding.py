"""Which law of sliding the pulls of a session obey, where its file does not say."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from ssmr_ident.core.parameter import Estimate, ParameterSet
from ssmr_ident.diagnose.baseline import LAST, best_baseline, unsteady
from ssmr_ident.diagnose.polish import calmed
from ssmr_ident.diagnose.race import Progress
from ssmr_ident.diagnose.setup import Setup, set_up
from ssmr_ident.diagnose.weigh import CERTAIN
from ssmr_ident.experiments.campaign import Campaign
from ssmr_ident.identify.fitting.descent import LOUD, descend
from ssmr_ident.identify.fitting.joint import JointFit, differentiate, evaluate
from ssmr_ident.physics.robot import SLIDING_SPEED

KEY = "tire.sliding_speed_m_s"


def with_law_of_sliding(
    campaign: Campaign, known: ParameterSet, progress: Progress | None = None
) -> tuple[Setup, ParameterSet]:
    """A session set up with the relay of each axis (6.4) or with Coulomb's cone, whichever its recordings prefer.

    Under one friction coefficient both are Coulomb's law, and differ where a wheel slides along two axes at once. A
    file that states the speed of sliding, or the law itself, has decided.

    Parameters
    ----------
    campaign : Campaign
    known : ParameterSet
    progress : callable, optional

    Returns
    -------
    (Setup, ParameterSet)
        What is known then holds the law that was chosen, so that exported models are compared under it.
    """
    relay = set_up(campaign, known)
    one = known.number("tire.mu_static", np.nan) == known.number("tire.mu_kinetic", np.nan)
    if KEY in known or known.choices or not one or not any(trial.experiment.drags_everything for trial in relay.fitted):
        return relay, known
    if progress:
        progress("fitting the baseline", 0, 1)
    decided = known.updated({KEY: Estimate(SLIDING_SPEED, None, "m/s", fixed=True)})
    cone = set_up(replace(campaign, parameters=decided), decided)
    laws = ((relay, known), (cone, decided))
    found = [best_baseline(s.fitted, s, p) for s, p in laws]
    fits = crossed([fit for fit, _ in found])
    begun = [(fit, lengths) for fit, (_, lengths) in zip(fits, found, strict=True)]
    turning = {m.name for m in campaign.measurements if m.entry.wheel_rate_rad_s}
    first = _best(fits)
    if first == 1 and unexplained(fits[1], turning):
        first = of_those_that_stand(laws, turning, fits)
    if first == 1:
        note = "contacts slide along both axes together (Coulomb's cone), which fits better than a relay on each"
        return replace(cone, notes=(*cone.notes, note), begun=begun[1]), decided
    return replace(relay, begun=begun[0]), known


def unexplained(fit: JointFit, names: set[str]) -> bool:
    """Whether any of some recordings is left with more than noise."""
    return any(part > LOUD * t.size for t, part in zip(fit.trials, fit.parts, strict=True) if t.name in names)


def of_those_that_stand(
    laws: Sequence[tuple[Setup, ParameterSet]], turning: set[str], whole: Sequence[JointFit]
) -> int:
    """The law of pulls on wheels that stand, where those on wheels that turn obey neither: the relay, unless they are
    certain of the cone, and where none stands.

    The cone takes grip away from a turning wheel by itself. From a relay that lacks ``slip_coupling``, which does so
    too, it is the nearer of two wrong laws, and beside it that effect has nothing to do: 8,457 times the noise against
    18,121 (bank 5337), where the relay with the true values leaves about one.

    ``whole`` are the fits of all pulls: what they make of those that stand may be better than what these find by
    themselves. In bank 5709 that left the relay 36 behind the cone, in a hollow that the fit of all was out of.
    """
    standing = [[t for t in setup.fitted if t.name not in turning] for setup, _ in laws]
    if not all(standing):
        return 0
    alone = [best_baseline(t, *law)[0] for t, law in zip(standing, laws, strict=True)]
    fits = crossed([_better_of(fit, other) for fit, other in zip(alone, whole, strict=True)])
    counted = fits[_best(fits)].counted
    return int(fits[0].cost(counted) - fits[1].cost(counted) > 2.0 * CERTAIN)


def _better_of(fit: JointFit, whole: JointFit) -> JointFit:
    """A fit of some recordings, or one that begins where a fit of more than those has ended."""
    own = {trial.name: nuisance for trial, nuisance in zip(whole.trials, whole.nuisances, strict=True)}
    begun = evaluate(fit.trials, fit.model, whole.point, [own[t.name] for t in fit.trials])
    other = descend(begun, LAST) if np.isfinite(begun.rss) else fit
    return differentiate(other) if other.cost(fit.counted) < fit.cost(fit.counted) else fit


def _best(fits: Sequence[JointFit]) -> int:
    """Which of several fits of the same recordings is the best, samples counted in that which leaves least of them
    depending on each other."""
    finite = [fit for fit in fits if np.isfinite(fit.rss)]
    if not finite:
        return 0
    counted = max(finite, key=lambda fit: fit.independent).counted
    return int(np.argmin([fit.cost(counted) for fit in fits]))


def crossed(fits: Sequence[JointFit]) -> list[JointFit]:
    """Fits under two laws of sliding, the worse one begun from where the better one ended, and the other way round
    where it has overtaken it.

    Both ask for nearly the same robot, and each has hollows of its own. A law that is left in one loses to the wrong
    one, beside which an effect then makes up the difference.
    """
    found = list(fits)
    for _ in found:
        first = _best(found)
        last, best = found[1 - first], found[first]
        if not np.isfinite(best.rss) or not (unsteady(last) or unsteady(best)):
            break
        begun = evaluate(last.trials, last.model, best.point, best.nuisances)
        other = differentiate(calmed(begun)) if np.isfinite(begun.rss) else last
        if _best([last, other]) == 1:
            found[1 - first] = other
        if _best(found) == first:
            break
    return found
