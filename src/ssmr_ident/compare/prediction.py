"""What a model says a recording should hold, with the recording's own nuisances refitted and no physics."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from ssmr_ident.compare import block, network, turning
from ssmr_ident.compare.outcome import Prediction
from ssmr_ident.compare.recorded import follow, predicted
from ssmr_ident.core.errors import SimulationError
from ssmr_ident.core.parameter import ParameterSet
from ssmr_ident.experiments.campaign import Campaign, Measurement
from ssmr_ident.identify.fitting.coordinates import Model
from ssmr_ident.identify.trials import trial_of
from ssmr_ident.physics.network import NETWORK
from ssmr_ident.physics.slots import effect_values
from ssmr_ident.physics.voltage_drive import drive_from_parameters
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
    if baseline == NETWORK or drive_from_parameters(parameters) is not None:
        return network.predict(parameters, measurement)
    trial = trial_of(baseline, measurement, parameters)
    model = Model((), (), effect_values(parameters))
    fit = follow([trial], model, np.zeros(0))
    if not np.isfinite(fit.rss):
        effects = ", ".join(model.held) or "none"
        raise SimulationError(
            f"what the model says of {measurement.name} left the finite numbers, with effects {effects}. "
            "Compare the size of what was measured with that of the parameters"
        )
    found = predicted(trial, *model.split(fit.point), fit.nuisances[0])
    if baseline not in BANDED:
        return found
    low, high = network.band_of(parameters, measurement.entry.band_hz)
    return replace(found, low_pass_hz=high, high_pass_hz=low)
