"""The baseline within its priors: what an answer is measured against that the priors gave, not the recordings."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from ssmr_ident.compare.recorded import follow
from ssmr_ident.diagnose.weigh import CERTAIN, Explanation, from_recordings
from ssmr_ident.identify.fitting.descent import descend
from ssmr_ident.identify.fitting.joint import differentiate

REACH = 3.0
"""Standard deviations of what is known of a parameter within which a baseline is still the robot of the file."""

BEGUN = 0.9
"""Share of the reach at which a parameter begins that a free baseline drew further: at the end nothing moves it."""

STEPS = 8
"""Gauss-Newton steps."""


def measure_of(chosen: Explanation, baseline: Explanation) -> Explanation:
    """The baseline that an answer is measured against.

    The free one, unless the recordings alone would not have named the effect: that baseline follows them as well, as
    another robot than the file's. A centre of mass that is elsewhere is the same as contacts and a sensor that are
    elsewhere by many deviations.
    """
    told = from_recordings(chosen, chosen) - from_recordings(baseline, chosen)
    known = [abs(p) for u, p in zip(baseline.fit.model.physics, baseline.fit.point, strict=False) if u.prior_std]
    return within_priors(baseline) if told < CERTAIN and max(known, default=0.0) > REACH else baseline


def within_priors(baseline: Explanation) -> Explanation:
    """The baseline at its best with no parameter further than ``REACH`` deviations from what is known of it.

    It is fitted once more, from where the free one ended and as far towards it as that allows. By plain squares as
    well: where a misfit is left that nothing within the reach removes, its own size as the measure lets priors outweigh
    it. The fit that leaves less is taken.
    """
    fit = baseline.fit
    bound = tuple(u if u.prior_std is None else replace(u, reach=min(u.reach, REACH)) for u in fit.model.physics)
    near = np.clip(fit.point, -BEGUN * REACH, BEGUN * REACH)
    free = zip(bound, fit.model.physics, fit.point, near, strict=True)
    point = np.array([b.scaled(u.value(float(p if u.prior_std is None else n))) for b, u, p, n in free])
    model = replace(fit.model, physics=bound)
    begun = follow(fit.trials, model, point, fit.nuisances)
    ends = [descend(begun, STEPS, plain=plain) for plain in (False, True)]
    held = differentiate(min(ends, key=lambda f: float(np.sum(np.log(f.parts)))))
    return Explanation(held, follow(baseline.kept.trials, model, held.point, None, held))
