"""What a model says a recording should hold, with the recording's own nuisances refitted and no physics."""

from __future__ import annotations

from ssmr_ident.campaign import Campaign, Measurement
from ssmr_ident.compare import decay, forced, pulled, turning
from ssmr_ident.compare.outcome import Prediction
from ssmr_ident.core.errors import InputError
from ssmr_ident.core.parameter import ParameterSet

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
    """
    baseline, experiment = campaign.session.baseline, measurement.entry.experiment
    if baseline == "sdof" and experiment in ("forced", "free_response"):
        return forced.predict(parameters, measurement)
    if baseline == "drag" and experiment in ("wheel_drag", "pull"):
        return pulled.predict(parameters, measurement)
    if baseline in ("rigid6", "decoupled"):
        if experiment == "free_response":
            return decay.predict(parameters, measurement, decoupled=baseline == "decoupled")
        if experiment == "pull":
            return pulled.predict(parameters, measurement)
        if experiment in ("wheel_drag", "vertical_compression"):
            return pulled.predict(parameters, measurement)
        if experiment in ("swivel", "straight"):
            return turning.predict(parameters, measurement)
    raise InputError(
        f"{campaign.session.folder / 'session.yaml'}: {measurement.name}",
        f"baseline {baseline} has no model of {experiment}",
        "A robot is rigid6 or decoupled, a rig is sdof, a dragged block is drag",
    )
