"""A diagnosis of force logs, and of decays beside them, from their campaign: search, table, decision, answer."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import numpy as np

from ssmr_ident.compare.recorded import follow
from ssmr_ident.core.parameter import Estimate, ParameterSet
from ssmr_ident.diagnose.arranged import arranged
from ssmr_ident.diagnose.diagnosis import Diagnosis
from ssmr_ident.diagnose.prepared import prepared
from ssmr_ident.diagnose.setup import Setup, set_up
from ssmr_ident.doctor.decide import decide
from ssmr_ident.doctor.robots.answer import answered, table
from ssmr_ident.doctor.robots.calibrated import informed
from ssmr_ident.doctor.robots.search import searched
from ssmr_ident.experiments.campaign import Campaign
from ssmr_ident.physics.robot import SLIDING_SPEED

Progress = Callable[[str, int, int], None]

SLIDES = "tire.sliding_speed_m_s"


def diagnose(
    campaign: Campaign, parameters: ParameterSet | None = None, seed: int = 0, progress: Progress | None = None
) -> Diagnosis:
    """Locate, name and prove what the baseline of a robot's force logs leaves out.

    Parameters
    ----------
    campaign : Campaign
        Pulls, drags of a wheel and compressions, or these and free responses.
    parameters : ParameterSet, optional
        What is known beforehand, in place of the session's own file.
    seed : int
        Of permutations.
    progress : callable, optional
    """
    known = campaign.parameters if parameters is None else parameters
    setups = under_laws_of_sliding(arranged(campaign), known)
    found = searched([setup for setup, _ in setups], progress)
    at = next(k for k, (setup, _) in enumerate(setups) if setup.known is found.setup.known)
    setup, known = found.setup, setups[at][1]
    base = found.search.baseline
    kept = [t.as_it_is() for t in setup.kept]
    setup = replace(setup, kept=tuple(prepared(follow(kept, base.model, base.point))))
    rows = table(found.search)
    return answered(setup, found.search, rows, decide([row for row, _ in rows]), known, seed)


def under_laws_of_sliding(campaign: Campaign, known: ParameterSet) -> list[tuple[Setup, ParameterSet]]:
    """The session with the relay of each axis (6.4), and with Coulomb's cone where its file leaves that open.

    Under one friction coefficient both are Coulomb's law, and differ where a wheel slides along two axes at once. A
    file that states the speed of sliding, or the law itself, has decided.

    Returns
    -------
    list of (Setup, ParameterSet)
        What is known then holds the law, so that exported models are compared under it.
    """
    relay = informed(set_up(campaign, known))
    one = known.number("tire.mu_static", np.nan) == known.number("tire.mu_kinetic", np.nan)
    if SLIDES in known or known.choices or not one or not any(t.experiment.drags_everything for t in relay.fitted):
        return [(relay, known)]
    decided = known.updated({SLIDES: Estimate(SLIDING_SPEED, None, "m/s", fixed=True)})
    cone = informed(set_up(replace(campaign, parameters=decided), decided))
    note = "contacts slide along both axes together (Coulomb's cone), which fits better than a relay on each"
    return [(relay, known), (replace(cone, notes=(*cone.notes, note)), decided)]
