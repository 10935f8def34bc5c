"""Effects begun beside all else as it is known, at sizes far apart: where none beside a bent baseline has led home.

A baseline that leaves a thousand times the noise is bent round nothing that is there, and its slopes are those of
another robot. Tires that harden by so much that their releases lie whole swings off (bank 5563) ended as a loop
that left up to 285 times the noise's variance; of six sizes of hardening beside what is known two end at the noise.
"""

from __future__ import annotations

import numpy as np

from ssmr_ident.core.threads import side_by_side
from ssmr_ident.diagnose.explain import with_suspect
from ssmr_ident.diagnose.race import Progress, ranked
from ssmr_ident.diagnose.scan import Suspect, candidates, probes, smaller
from ssmr_ident.identify.fitting.descent import descend
from ssmr_ident.identify.fitting.horizons import STEPS
from ssmr_ident.identify.fitting.joint import JointFit, evaluate
from ssmr_ident.physics.effects import CATALOGUE

SHARES = tuple(float(share) for share in np.geomspace(0.03, 30.0, 6))
"""Of a probe, by factors of four: from what is hardly seen to what nothing known could have been."""

FIRST_STEPS, GO_ON = 2, 2
"""Gauss-Newton steps from every size, and how many sizes of a formula go on."""


def begun_from_known(base: JointFit, baseline: str, length: float, progress: Progress | None = None) -> list[JointFit]:
    """Every effect at its best on the first horizon, from what is known; the most likely first.

    Parameters
    ----------
    base : JointFit
        The baseline; of its point only the number of coordinates counts.
    baseline : str
        The session's.
    length : float [s]
        The first horizon.
    progress : callable, optional
    """
    known = evaluate([t.until(length) for t in base.trials], base.model, np.zeros_like(base.point), base.nuisances)
    found = [(e.id, at, held, share) for e, at, held in probes(base, candidates(base, baseline)) for share in SHARES]
    begun: dict[tuple[object, ...], list[JointFit]] = {}
    fits = side_by_side(lambda one: _begun(known, *one), found)
    for index, ((effect, at, held, _), fit) in enumerate(zip(found, fits, strict=True)):
        if progress:
            progress("starting from what is known", index, len(found))
        begun.setdefault((effect, *at, *held.items()), []).append(fit)
    best = [fit for same in begun.values() for fit in ranked(same)[:GO_ON]]
    return ranked(list(side_by_side(lambda fit: descend(fit, STEPS), best)))


def _begun(known: JointFit, effect: str, at: dict[str, float], held: dict[str, float], share: float) -> JointFit:
    one = smaller(CATALOGUE[effect], at, share)
    natural = {p.name: abs(one[p.name]) for p in CATALOGUE[effect].amplitudes if p.name in one and p.lower < 0.0}
    model, point = with_suspect(known, Suspect(effect, one, held, natural, 0.0))
    values, effects = model.split(point)
    fit = evaluate(known.trials, model, point, [t.begin(values, effects) for t in known.trials])
    return descend(fit, FIRST_STEPS) if np.isfinite(fit.rss) else fit
