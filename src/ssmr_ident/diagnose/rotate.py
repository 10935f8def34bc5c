"""What only fitted recordings show, and what only those show that were kept back."""

from __future__ import annotations

import numpy as np
from scipy.stats import chi2
from scipy.stats import f as fisher

from ssmr_ident.compare.recorded import follow
from ssmr_ident.diagnose.accept import CHANCE, certain, harmless
from ssmr_ident.diagnose.weigh import CERTAIN, Explanation, surplus
from ssmr_ident.identify.fitting.descent import descend, slides
from ssmr_ident.identify.fitting.joint import JointFit, evaluate

FEWEST = 3
"""Recordings from which one can be spared."""

STEPS = 8
"""Gauss-Newton steps without it, from where the fit with it ended."""


def shown_in_turn(leader: Explanation, before: Explanation) -> bool:
    """Whether the fitted recording that gains most from an effect gains as well when it is not fitted.

    The loudest recordings are never kept back, and show most of what is missing. Both models are fitted without that
    one and then predict it; its n ln(RSS) must fall by more than that of a recording that was kept back from the start.
    What was kept back must not speak against the effect. Not where contacts slide: no two simulators let go alike, and
    a friction that falls by 0.4 % was shown in turn in two of three pulls of another plant that had none.
    """
    trials = leader.fit.trials
    if len(trials) < FEWEST or slides(leader.fit):
        return False
    if not certain(leader, before) or not harmless(leader, before):
        return False
    gain = leader.fit.counted * np.log(before.fit.parts / leader.fit.parts)
    spared = int(np.argmax(gain))
    left = [_without(e.fit, spared) for e in (before, leader)]
    change = float(np.log(left[1] / left[0]))
    return -float(leader.fit.counted[spared]) * change > chi2.isf(CHANCE, 1)


def left_elsewhere(baseline: Explanation) -> bool:
    """Whether a recording kept back is left with more than the fitted ones are, by more than chance (Fisher's F).

    A wheel may leave the floor in that one alone. No fit of the others asks for it, and a straight line from where
    nothing is missing promises nothing. Not where contacts slide: there no two runs are alike.
    """
    fitted, kept = baseline.fit, baseline.kept
    if slides(fitted):
        return False
    left, other = (e.parts / [t.size for t in e.trials] for e in (fitted, kept))
    most, worst = int(np.argmax(left)), int(np.argmax(other))
    chance = CHANCE / (len(left) + len(other))
    return bool(other[worst] / left[most] > fisher.isf(chance, kept.counted[worst], fitted.counted[most]))


def shown_by_all(leader: Explanation, before: Explanation) -> bool:
    """Whether an effect of pulls that only recordings kept back show is certain as well where all of them are fitted.

    A baseline follows what was kept back with what the others have told, and where a wheel lets go that is sensitive: a
    null session's pull was left at 16.4 times the noise's variance by it and at 3.6 with a loop (193995), at 2.0 and
    2.2 once it was fitted as well, and the other recordings did not tell the two apart.
    """
    if not slides(leader.fit) or _by_fitted(leader.fit, before.fit) > CERTAIN:
        return True
    return _by_fitted(_all_fitted(leader), _all_fitted(before)) > CERTAIN


def _by_fitted(leader: JointFit, before: JointFit) -> float:
    """Log evidence of one fit over another, of the recordings that were fitted alone."""
    one, other = (Explanation(fit, evaluate((), fit.model, fit.point, ())) for fit in (leader, before))
    return surplus(one, other)


def _all_fitted(explanation: Explanation) -> JointFit:
    """A model led on with what was kept back as well."""
    fit, kept = explanation.fit, explanation.kept
    begun = evaluate((*fit.trials, *kept.trials), fit.model, fit.point, (*fit.nuisances, *kept.nuisances))
    led = descend(descend(begun, STEPS, plain=True), STEPS)
    return min((begun, led), key=lambda f: f.cost(led.counted))


def _without(fit: JointFit, spared: int) -> float:
    """What a model that is fitted to all recordings but one leaves in that one."""
    others = [k for k in range(len(fit.trials)) if k != spared]
    few = evaluate([fit.trials[k] for k in others], fit.model, fit.point, [fit.nuisances[k] for k in others])
    refitted = descend(few, STEPS)
    followed = follow([fit.trials[spared]], fit.model, refitted.point, [fit.nuisances[spared]], refitted)
    return float(followed.parts[0])
