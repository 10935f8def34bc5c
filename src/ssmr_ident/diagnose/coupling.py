"""From pure rotations to all six degrees of freedom: the explanation ``translation_coupling``."""

from __future__ import annotations

from dataclasses import replace

from ssmr_ident.compare.recorded import follow
from ssmr_ident.core.parameter import ParameterSet
from ssmr_ident.diagnose.baseline import LAST, best_baseline, prepared
from ssmr_ident.diagnose.setup import COUPLING, Setup
from ssmr_ident.diagnose.weigh import Explanation
from ssmr_ident.experiments.campaign import Measurement
from ssmr_ident.identify.body.builder import RobotBuilder
from ssmr_ident.identify.fitting.descent import descend
from ssmr_ident.identify.fitting.joint import evaluate
from ssmr_ident.identify.trials import Trial
from ssmr_ident.identify.trials.decay import decay_trial


def coupled(setup: Setup, parameters: ParameterSet, kept: tuple[Trial, ...]) -> Explanation:
    """All six degrees of freedom in place of pure rotations, fitted from what is known beforehand.

    Not from where the pure rotations ended: the inertia that they ask for is what gives them away. One channel tells a
    pure rotation, and leaves the twelve numbers of a release in six degrees of freedom undetermined; so the way there
    uses all channels, and only the last steps the one by which the two are compared.

    Parameters
    ----------
    setup : Setup
        With the baseline ``decoupled``.
    parameters : ParameterSet
        What is known beforehand.
    kept : tuple of Trial
        Recordings that are never fitted, as the baseline's explanation holds them.
    """
    model = replace(setup.model, held={**setup.model.held, COUPLING: {"active": 1.0}})
    builder = RobotBuilder.of(parameters)
    logs: dict[str, Measurement] = {m.name: m for m in setup.campaign.measurements}

    def widened(trials: tuple[Trial, ...]) -> list[Trial]:
        free = [t.experiment.free and t.part is None for t in trials]
        return [decay_trial(logs[t.name], builder) if wide else t for t, wide in zip(trials, free, strict=True)]

    wide = best_baseline(widened(setup.fitted), replace(setup, model=model), parameters)[0]
    fit = descend(evaluate(setup.fitted, model, wide.point, wide.nuisances), LAST)
    known = follow(prepared(follow(widened(kept), model, wide.point)), model, wide.point)
    return Explanation(fit, follow(kept, model, fit.point, known.nuisances))
