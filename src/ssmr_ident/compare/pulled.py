"""Pulls and bench tests: where the head was when the cable tightened, and the load cell's zero, are fitted."""

from __future__ import annotations

from ssmr_ident.campaign import Measurement
from ssmr_ident.compare.outcome import Prediction
from ssmr_ident.core.parameter import ParameterSet
from ssmr_ident.identify.trials.pull import pull_trial
from ssmr_ident.physics.slots import effect_values


def predict(parameters: ParameterSet, measurement: Measurement) -> Prediction:
    """A robot or a block pulled by a cable, one wheel dragged sideways or pressed down."""
    trial, effects = pull_trial(measurement, parameters), effect_values(parameters)
    slack = trial.begin({}, effects)
    simulated = trial.run({}, effects, slack)
    zero = float((trial.target - simulated).mean())
    return Prediction(
        trial.times,
        trial.channels,
        ("N",),
        trial.target,
        simulated + zero,
        low_pass_hz=None,
        nuisances={"slack_m": float(slack[0]) * trial.facts["travel_m"], "zero_N": zero},
    )
