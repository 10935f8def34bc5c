"""Which kind of trial a recording is under a session's baseline."""

from __future__ import annotations

from ssmr_ident.core.errors import InputError
from ssmr_ident.core.parameter import ParameterSet
from ssmr_ident.experiments import Likelihood
from ssmr_ident.experiments.campaign import Measurement
from ssmr_ident.identify.body.builder import RobotBuilder
from ssmr_ident.identify.trials.decay import decay_trial
from ssmr_ident.identify.trials.forced import forced_trial
from ssmr_ident.identify.trials.pull import pull_trial
from ssmr_ident.identify.trials.trial import Trial


def trial_of(baseline: str, measurement: Measurement, parameters: ParameterSet) -> Trial:
    """A recording as an inverse problem.

    Parameters
    ----------
    baseline : str
        The session's: ``rigid6``, ``decoupled``, ``sdof`` or ``drag``.
    measurement : Measurement
    parameters : ParameterSet

    Raises
    ------
    InputError
        The model and the experiment do not go together, or a parameter or channel is missing.
    """
    experiment = measurement.experiment
    if not experiment.fitted_under(baseline):
        raise InputError(
            f"session.yaml: {measurement.name}",
            f"baseline {baseline} has no model of {experiment.name}",
            "A robot is rigid6 or decoupled, a rig is sdof, a dragged block is drag",
        )
    if baseline == "sdof":
        return forced_trial(measurement, parameters)
    if experiment.likelihood is Likelihood.FORCE:
        return pull_trial(measurement, parameters)
    return decay_trial(measurement, RobotBuilder.of(parameters), baseline == "decoupled")
