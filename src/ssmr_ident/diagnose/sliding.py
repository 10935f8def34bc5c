"""Which law of sliding the pulls of a session obey, where its file does not say."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from ssmr_ident.campaign import Campaign
from ssmr_ident.core.parameter import Estimate, ParameterSet
from ssmr_ident.diagnose.explore import best_baseline
from ssmr_ident.diagnose.race import Progress
from ssmr_ident.diagnose.setup import Setup, set_up
from ssmr_ident.physics.robot import SLIDING_SPEED

KEY = "tire.sliding_speed_m_s"


def with_law_of_sliding(
    campaign: Campaign, known: ParameterSet, progress: Progress | None = None
) -> tuple[Setup, ParameterSet]:
    """A session set up with the relay of each axis (6.4) or with Coulomb's cone, whichever its recordings prefer.

    Under one friction coefficient both are Coulomb's law, and differ where a wheel slides along two axes at once. A
    file that states the speed of sliding has decided.

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
    if KEY in known or not one or all(trial.experiment != "pull" for trial in relay.fitted):
        return relay, known
    if progress:
        progress("fitting the baseline", 0, 1)
    decided = known.updated({KEY: Estimate(SLIDING_SPEED, None, "m/s", fixed=True)})
    cone = set_up(replace(campaign, parameters=decided), decided)
    begun = [best_baseline(s.fitted, s, p) for s, p in ((relay, known), (cone, decided))]
    fits = [fit for fit, _ in begun]
    finite = [fit for fit in fits if np.isfinite(fit.rss)]
    if finite and min(finite, key=lambda fit: fit.cost(finite[-1].counted)) is fits[1]:
        note = "contacts slide along both axes together (Coulomb's cone), which fits better than a relay on each"
        return replace(cone, notes=(*cone.notes, note), begun=begun[1]), decided
    return replace(relay, begun=begun[0]), known
