"""What a model says a recording should hold, with the recording's own nuisances refitted and no physics."""

from __future__ import annotations

import numpy as np

from ssmr_ident.compare import block, network, turning
from ssmr_ident.compare.outcome import Prediction, left_the_numbers
from ssmr_ident.compare.recorded import follow, predicted
from ssmr_ident.core.parameter import ParameterSet
from ssmr_ident.experiments.campaign import Campaign, Measurement
from ssmr_ident.identify.fitting.coordinates import Model
from ssmr_ident.identify.trials import trial_of
from ssmr_ident.physics.slots import effect_values
from ssmr_ident.session.entry import BANDED

__all__ = ["Prediction", "predict"]


def predict(campaign: Campaign, measurement: Measurement, parameters: ParameterSet) -> Prediction:
    """Simulate one recording of a campaign.

    Nuisances are what differs from trial to trial and says nothing about the physics: the state at the release,
    the moment and slack at which a pull begins, the zero of a sensor.

    Parameters
    ----------
    campaign : Campaign
        Its baseline says which model.
    measurement : Measurement
    parameters : ParameterSet

    Raises
    ------
    InputError
        The model and the experiment do not go together, or a parameter is missing.
    SimulationError
        The model's answer is no number.
    """
    experiment, baseline = measurement.experiment, campaign.session.baseline
    if not experiment.repeats and baseline in experiment.baselines:
        return turning.predict(parameters, measurement)
    if baseline == "drag" and block.FOLDED.issuperset(parameters.effects):
        return block.predict(parameters, measurement)
    if baseline in BANDED:
        return network.predict(parameters, measurement)
    trial = trial_of(baseline, measurement, parameters)
    model = Model((), (), effect_values(parameters))
    fit = follow([trial], model, np.zeros(0))
    if not np.isfinite(fit.rss):
        raise left_the_numbers(measurement.name, model.held)
    return predicted(trial, *model.split(fit.point), fit.nuisances[0])
