"""Swivel: the robot turns on the spot, its left wheels backward and its right ones forward."""

from __future__ import annotations

import numpy as np

from ssmr_ident.experiments.conditions import Conditions
from ssmr_ident.experiments.experiment import ACCELERATIONS, ROBOT, Drive, Experiment, Likelihood
from ssmr_ident.experiments.scenario import Array, Scenario
from ssmr_ident.physics.motor import wheel_rates as rates_of
from ssmr_ident.physics.robot import Robot


def swivel(wheel_rates: Array, duration: float = 20.0) -> Scenario:
    """Turning on the spot: constant wanted rates of the left and right wheels, (2,) float [rad/s]."""
    return Scenario(SWIVEL.name, duration, wheel_rates=np.atleast_2d(wheel_rates))


def _scenario(robot: Robot, conditions: Conditions, duration: float) -> Scenario:
    return swivel(rates_of(robot, 0.0, float(np.deg2rad(conditions.yaw_rate_deg_s))), duration)


def _effect_checks(robot: Robot, seconds: float) -> tuple[Scenario, ...]:
    return (swivel(rates_of(robot, 0.0, 1.0), 1.0),)


SWIVEL = Experiment(
    name="swivel",
    sentence="Turning on the spot at a constant wanted yaw rate.",
    verb="Turn",
    drive=Drive.WHEELS,
    channels=(ACCELERATIONS,),
    likelihood=Likelihood.SPECTRUM,
    baselines=ROBOT,
    nuisances=("where on the floor it turns", "noise and zeros of the sensors"),
    file_words=("swivel", "turn", "spin", "rotate"),
    duration=20.0,
    wheel_signs=(-1.0, 1.0),
    scenario=_scenario,
    effect_checks=_effect_checks,
)
