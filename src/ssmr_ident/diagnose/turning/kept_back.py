"""Whether recordings kept back speak for an explanation, or at least not against it."""

from __future__ import annotations

import numpy as np

from ssmr_ident.diagnose.turning.anchor import Anchor
from ssmr_ident.diagnose.turning.engine import CLOSE, FINAL_SEEDS, Outcome
from ssmr_ident.diagnose.turning.ensemble import TAU_DB
from ssmr_ident.diagnose.turning.rivals import NEARER, ONE_SIDED, WITHIN
from ssmr_ident.diagnose.turning.search import Explained
from ssmr_ident.diagnose.turning.spectral_distance import against_simulation
from ssmr_ident.physics.slots import Effects

NO_WORSE = 1.02
"""Of distances to the mean of four runs: they scatter by about as much."""


def predicts(outcome: Outcome, best: Explained | None, floor: float) -> bool:
    """Whether there was anything to explain beyond repeatability, and the explanation brings the spectra nearer.

    Against the mean of several runs: one run's chance is as large as what a small effect changes. Kept-back recordings
    that show nothing of an effect, at speeds where it does nothing, do not speak against it where targets differ from
    their calibration far beyond the alarm (three of 200 null sessions were above that, two of them by little), or where
    it leaves nothing in targets of which the baseline leaves much. In that case neither do
    those that the baseline itself is far from, at a speed that nothing calibrates, unless the effect makes them worse.
    And a robot that shakes in more than one way there is predicted by any of its runs: beside an effect that leaves
    nothing in the targets the nearest run counts, of four with it and of four without.
    """
    conditions = outcome.heldout or outcome.targets
    anchor, effects = (outcome.anchor, {}) if best is None else (best.anchor, best.effects)
    distances = [
        float(np.mean(list(found.values()))) if (found := against_simulation(
            outcome.bench, conditions, values, active, FINAL_SEEDS)) else np.inf
        for values, active in ((outcome.anchor.values, {}), (anchor.values, effects))
    ]  # fmt: skip
    reached = WITHIN * floor * ONE_SIDED
    if distances[0] > reached and distances[1] < NEARER * distances[0]:
        return True
    clear = best is not None and answers(outcome, best)
    if best is not None and clear:
        alone, beside = _nearest(outcome, outcome.anchor, {}), _nearest(outcome, best.anchor, best.effects)
        if alone > WITHIN * floor and beside < NEARER * alone:
            return True
    if max(distances) <= reached:
        return clear or (outcome.calibrated and outcome.baseline.target.left > CLOSE)
    return clear and outcome.calibrated and distances[1] < NO_WORSE * distances[0]


def _nearest(outcome: Outcome, anchor: Anchor, effects: Effects) -> float:
    """Distance of recordings kept back from the nearest of several runs, mean over recordings [dB]."""
    conditions = outcome.heldout or outcome.targets
    runs = [against_simulation(outcome.bench, conditions, anchor.values, effects, (seed,)) for seed in FINAL_SEEDS]
    names = set.intersection(*(set(run) for run in runs))
    return float(np.mean([min(run[name] for run in runs) for name in names])) if names else np.inf


def answers(outcome: Outcome, best: Explained) -> bool:
    """Whether an explanation leaves no more in the targets than simulations are off anyway, and the baseline much more.

    By more than ensembles were seen to add to a fit, so that no better fitted baseline would do the same.
    """
    return best.target.tau_db <= TAU_DB[0] and best.evidence - outcome.baseline.evidence > CLOSE
