"""Straight run: the robot drives straight on, all wheels at one speed."""

from __future__ import annotations

import numpy as np

from ssmr_ident.experiments.conditions import Conditions
from ssmr_ident.experiments.experiment import ACCELERATIONS, ROBOT, Drive, Experiment, Likelihood
from ssmr_ident.experiments.scenario import Array, Scenario
from ssmr_ident.physics.motor import wheel_rates as rates_of
from ssmr_ident.physics.robot import Robot


def straight(wheel_rates: Array, duration: float = 10.0) -> Scenario:
    """Driving straight on: constant wanted rates of the left and right wheels, (2,) float [rad/s]."""
    return Scenario(STRAIGHT.name, duration, wheel_rates=np.atleast_2d(wheel_rates))


def _scenario(robot: Robot, conditions: Conditions, duration: float) -> Scenario:
    return straight(rates_of(robot, conditions.speed_m_s, 0.0), duration)


def _effect_checks(robot: Robot, seconds: float) -> tuple[Scenario, ...]:
    return (straight(rates_of(robot, 0.4, 0.0), 1.0),)


STRAIGHT = Experiment(
    name="straight",
    sentence="Driving straight on at a constant wanted speed.",
    verb="Drive",
    drive=Drive.WHEELS,
    channels=(ACCELERATIONS,),
    likelihood=Likelihood.SPECTRUM,
    baselines=ROBOT,
    nuisances=("where on the floor it drives", "noise and zeros of the sensors"),
    file_words=("straight",),
    duration=10.0,
    wheel_signs=(1.0, 1.0),
    scenario=_scenario,
    effect_checks=_effect_checks,
)
