"""What recordings tell of the baseline that were made without the puzzling condition."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from ssmr_ident.diagnose.prepared import prepared
from ssmr_ident.diagnose.setup import Setup
from ssmr_ident.doctor.robots.cooled import FURTHER, from_known
from ssmr_ident.identify.fitting.coordinates import Model
from ssmr_ident.identify.fitting.descent import descend
from ssmr_ident.identify.fitting.joint import JointFit, differentiate, evaluate
from ssmr_ident.identify.fitting.roughness import scatter_of
from ssmr_ident.identify.trials import Trial


def baseline_of(trials: Sequence[Trial], model: Model) -> JointFit:
    """A model at its best, mains lines and noise taken from what it leaves."""
    fit = from_known([t.as_it_is() for t in trials], model)
    return descend(evaluate(prepared(fit), fit.model, fit.point, fit.nuisances), FURTHER, plain=True)


def informed(setup: Setup) -> Setup:
    """A setup whose baseline knows what its calibration recordings tell."""
    if not setup.calibration:
        return setup
    fit = baseline_of(setup.calibration, setup.model)
    stds = np.sqrt(np.diag(scatter_of(differentiate(fit))))
    physics = tuple(
        replace(u, prior=u.value(float(p)), prior_std=max(u.std(float(p), float(s)), 1e-12))
        for u, p, s in zip(setup.model.physics, fit.point, stds, strict=True)
    )
    return replace(setup, model=replace(setup.model, physics=physics))
