"""Play in pulls, begun at sizes far apart: a straight line points from none of the hollows to another."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from functools import partial

import numpy as np

from ssmr_ident.diagnose.explain import with_suspect
from ssmr_ident.diagnose.scan import Suspect, probes, smaller
from ssmr_ident.identify.fitting.descent import descend
from ssmr_ident.identify.fitting.joint import JointFit, evaluate
from ssmr_ident.physics.effect import Effect
from ssmr_ident.physics.effects import CATALOGUE

SHARES = tuple(float(share) for share in np.geomspace(0.5, 8.0, 5))
"""Of the smallest probe, which is a twentieth of how far the tires deflect. A descent reaches what lies within half as
much again: play of 0.35 mm (bank 5741) was found from 0.31 mm, 115 units ahead of none, and not from 0.16 or 0.97."""

STEPS = 2


def begun_loose(base: JointFit, effects: Sequence[Effect]) -> list[partial[JointFit]]:
    """Starts of what leaves a joint loose, beside a fit of pulls.

    Parameters
    ----------
    base : JointFit
    effects : sequence of Effect
        Those that are asked.

    Returns
    -------
    list of callable () -> JointFit
        Each leads one start on by a few steps.
    """
    found: dict[tuple[str, tuple[float, ...]], Suspect] = {}
    for effect, at, held in probes(base, [effect for effect in effects if effect.loosens]):
        found.setdefault((effect.id, tuple(held.values())), Suspect(effect.id, at, held, {}, 0.0))
    return [
        partial(_begun, base, replace(suspect, at=smaller(CATALOGUE[suspect.effect], suspect.at, share)))
        for suspect in found.values()
        for share in SHARES
    ]


def _begun(fit: JointFit, suspect: Suspect) -> JointFit:
    return descend(evaluate(fit.trials, *with_suspect(fit, suspect), fit.nuisances), STEPS)
