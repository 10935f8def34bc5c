"""Pure rotations against all six degrees of freedom: the explanation ``translation_coupling``."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from ssmr_ident.core.parameter import ParameterSet
from ssmr_ident.diagnose.arranged import arranged
from ssmr_ident.diagnose.diagnosis import Diagnosis
from ssmr_ident.diagnose.prepared import prepared
from ssmr_ident.diagnose.setup import COUPLING, Setup, set_up
from ssmr_ident.doctor.decays.recordings import decay_of
from ssmr_ident.doctor.decays.search import begun
from ssmr_ident.doctor.decide import decide
from ssmr_ident.doctor.robots.answer import answered, table
from ssmr_ident.doctor.robots.calibrated import informed
from ssmr_ident.doctor.robots.cooled import FURTHER, Progress, from_known, to_the_end
from ssmr_ident.doctor.robots.found import Found, Search
from ssmr_ident.doctor.robots.members import BY_KIND, Member
from ssmr_ident.experiments.campaign import Campaign
from ssmr_ident.identify.body.builder import RobotBuilder
from ssmr_ident.identify.fitting.coordinates import Model
from ssmr_ident.identify.fitting.descent import descend
from ssmr_ident.identify.fitting.joint import JointFit, evaluate
from ssmr_ident.identify.trials.decay import decay_trial


def diagnose(campaign: Campaign, known: ParameterSet, seed: int = 0, progress: Progress | None = None) -> Diagnosis:
    """Whether a robot whose baseline turns about its axes alone moves along them as well.

    Parameters
    ----------
    campaign : Campaign
        With ``baseline: decoupled``.
    known : ParameterSet
    seed : int
        Of permutations.
    progress : callable, optional
    """
    say = progress or (lambda stage, done, total: None)
    setup = informed(set_up(arranged(campaign), known))
    say("fitting the baseline", 0, 2)
    fit = from_known(setup.fitted, setup.model)
    trials = prepared(fit)
    setup = replace(setup, fitted=tuple(trials))
    search = Search(Found((), None, to_the_end(evaluate(trials, fit.model, fit.point, fit.nuisances))))
    say("fitting the baseline", 1, 2)
    search.add(_coupled(setup, known))
    rows = table(search)
    return answered(setup, search, rows, decide([row for row, _ in rows]), known, seed)


def _coupled(setup: Setup, known: ParameterSet) -> Found:
    """All six degrees of freedom in place of pure rotations, fitted from what is known beforehand.

    Not from where the pure rotations ended: the inertia that they ask for is what gives them away. One channel tells a
    pure rotation, and leaves the twelve numbers of a release in six degrees of freedom undetermined; so the way there
    uses all channels, and only the last steps the one by which the two are compared.
    """
    model = replace(setup.model, held={**setup.model.held, COUPLING: {"active": 1.0}})
    wide = _wide(setup, known, model)
    fit = descend(evaluate(setup.fitted, model, wide.point, wide.nuisances), 2 * FURTHER, plain=True)
    return Found((Member(COUPLING, BY_KIND[COUPLING], "active", model, np.zeros(0)),), None, fit)


def _wide(setup: Setup, known: ParameterSet, model: Model) -> JointFit:
    """All six degrees of freedom on all channels; in closed form where nothing but whole decays was logged."""
    builder = RobotBuilder.of(known)
    logs = {m.name: m for m in setup.campaign.measurements}
    free = [t.experiment.free and t.part is None for t in setup.fitted]
    trials = [decay_trial(logs[t.name], builder) if wide else t for t, wide in zip(setup.fitted, free, strict=True)]
    if not all(free):
        return from_known(trials, model)
    fit = begun([decay_of(trial, builder) for trial in trials], setup.model).baseline.fit
    assert fit is not None
    return fit
