"""Without calibration: explanations that the recordings, taken one by one, do not tell from the best."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from scipy.stats import t

from ssmr_ident.diagnose.diagnosis import MISSING, UNDETERMINED
from ssmr_ident.diagnose.turning.candidates import UNLISTED
from ssmr_ident.diagnose.turning.engine import FINAL_SEEDS, Outcome
from ssmr_ident.diagnose.turning.search import Explained
from ssmr_ident.diagnose.turning.spectral_distance import against_simulation, repeatability_db
from ssmr_ident.diagnose.turning.verdict import GAIN, MOST, Decision

LEVEL = 0.95  # of the one-sided test by which the best has to lie nearer
FEWEST = 4  # recordings for such a test
NEARER, WITHIN = 0.95, 1.25
"""Share of a distance to recordings kept back below which another one is nearer, and how many times what runs differ
by counts as reached."""
ONE_SIDED = float(np.sqrt(0.5 * (1.0 + 1.0 / len(FINAL_SEEDS))))
"""Distance of a run from the mean of several, over that of two runs from each other."""


def with_rivals(outcome: Outcome, decision: Decision) -> Decision:
    """A decision, with the explanations that lie as near the recordings as the best: three names at most.

    Evidence counts the bins of a spectrum as if a model erred in each of them anew. Where no calibration takes its
    errors away, they are the same from bin to bin, and only recordings are independent: the best has to lie nearer by
    the paired t-test over them. And where the best is itself off by more than two runs differ, its law is not quite the
    world's; a rival that is off by no more than that again is as near. Whatever predicts the recordings kept back
    better than a best that does not reach them is no worse either, evidence or not: what was not followed to the end
    lacks evidence for that alone. More than three that are alike are no answer.
    """
    if outcome.calibrated or decision.verdict != MISSING or not outcome.explanations:
        return decision
    found = {one.id: one for one in outcome.explanations}
    if decision.named[0] not in found:
        return decision
    best = _distances(outcome, found[decision.named[0]])
    repeats = repeatability_db((*outcome.targets, *outcome.heldout)) * ONE_SIDED
    own_error = float(np.mean(list(best.values()))) - repeats
    named = list(decision.named)
    for one in outcome.explanations:
        if one.id in (*named, UNLISTED) or one.evidence - outcome.baseline.evidence <= GAIN[1]:
            continue
        rival = _distances(outcome, one)
        nearer = np.array([rival[name] - best[name] for name in best if name in rival])
        if len(nearer) and ((len(nearer) >= FEWEST and not _clear(nearer)) or float(nearer.mean()) < own_error):
            named.append(one.id)
    named += [name for name in _better_predictions(outcome, found[decision.named[0]]) if name not in named]
    if len(named) == len(decision.named):
        return decision
    if len(named) > MOST:
        return Decision(UNDETERMINED, (), 0.0, f"{', '.join(named)} come equally near, none of them near enough")
    return replace(decision, named=tuple(named), confidence=min(decision.confidence, 1.0 / len(named)))


def _better_predictions(outcome: Outcome, best: Explained) -> list[str]:
    """Explanations nearer to the recordings kept back than the best one, where that is further off than runs differ."""
    if not outcome.heldout:
        return []

    def off(one: Explained) -> float:
        found = against_simulation(outcome.bench, outcome.heldout, one.anchor.values, one.effects, FINAL_SEEDS)
        return float(np.mean(list(found.values()))) if found else np.inf

    reached = off(best)
    if reached < WITHIN * ONE_SIDED * repeatability_db((*outcome.targets, *outcome.heldout)):
        return []
    others = {one.id: one for one in (*outcome.screened[::-1], *outcome.explanations[::-1])}
    return [name for name, one in others.items() if name not in (best.id, UNLISTED) and off(one) < NEARER * reached]


def _distances(outcome: Outcome, one: Explained) -> dict[str, float]:
    conditions = (*outcome.targets, *outcome.heldout)
    return against_simulation(outcome.bench, conditions, one.anchor.values, one.effects, FINAL_SEEDS)


def _clear(nearer: np.ndarray) -> bool:
    """Whether the mean of (n,) differences is above 0 beyond chance.

    >>> _clear(np.array([0.5, 0.4, 0.6, 0.5])), _clear(np.array([0.5, -0.4, 0.6, 0.0]))
    (True, False)
    """
    error = nearer.std(ddof=1) / np.sqrt(len(nearer))
    return bool(nearer.mean() > t.ppf(LEVEL, len(nearer) - 1) * error)
