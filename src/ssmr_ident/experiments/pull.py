"""Pull: a cable over a load cell drags the robot, or a block, at constant speed."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np

from ssmr_ident.core.errors import InputError
from ssmr_ident.experiments.conditions import Conditions
from ssmr_ident.experiments.experiment import ROBOT, Drive, Experiment, Likelihood
from ssmr_ident.experiments.scenario import Scenario
from ssmr_ident.physics.robot import Robot

ROPE_STIFFNESS = 6430.0  # N/m; (3.9) with 5 kN/m measured over a rope and 22.5 kN/m of tire
STEEL_STIFFNESS = 1e6  # N/m; thesis section 4
FIXTURE = (1e6, 1e5)  # N/m along x and N m/rad about z of the fixture that holds the robot (robot_kernel.py)


def pull(
    direction: str = "lateral",
    speed_mm_s: float = 1.0,
    duration: float = 16.0,
    cable: str | Mapping[str, float] | None = "steel",
    **fields: Any,
) -> Scenario:
    """Pulled at constant speed by a cable; ``fields`` are those of Scenario."""
    stiffness, damping = cable_properties(cable)
    head = np.array([0.0, speed_mm_s * 1e-3 * duration])
    return Scenario(
        PULL.name,
        duration,
        head=head,
        head_step=duration,
        direction=direction,
        cable_stiffness=stiffness,
        cable_damping=damping,
        **fields,
    )


def fixture_needed(wheels_gripping: tuple[int, ...], wheel_rate: float = 0.0) -> bool:
    """Whether a pull is made in the fixture: spinning wheels drive off, and about one gripping wheel the body turns."""
    return wheel_rate != 0.0 or len(wheels_gripping) == 1


def cable_properties(cable: str | Mapping[str, float] | None) -> tuple[float | None, float | None]:
    """Stiffness [N/m] and damping [N s/m] of a named or described cable; None leaves it to the robot."""
    if cable is None or cable == "steel":
        return None, None
    if cable == "rope":
        return ROPE_STIFFNESS, None
    if isinstance(cable, str):
        raise InputError("cable", f"is {cable!r}", "Give steel, rope or {stiffness_N_m: …}")
    return cable.get("stiffness_N_m"), cable.get("damping_N_s_m")


def _scenario(robot: Robot, conditions: Conditions, duration: float) -> Scenario:
    return pull(
        conditions.direction,
        conditions.speed_mm_s,
        duration,
        conditions.cable,
        angle_deg=conditions.angle_deg,
        height=conditions.height_m,
        wheels_gripping=conditions.wheels_gripping,
        wheel_rates=np.full((1, 2), conditions.wheel_rate_rad_s),
        held=fixture_needed(conditions.wheels_gripping, conditions.wheel_rate_rad_s),
    )


def _effect_checks(robot: Robot, seconds: float) -> tuple[Scenario, ...]:
    spinning = np.full((1, 2), 0.003 / robot.radius)
    return (
        pull("lateral", 1.0, seconds, height=0.2),
        pull("longitudinal", 2.0, seconds),
        pull("lateral", 1.0, seconds, wheel_rates=spinning, held=True),
    )


PULL = Experiment(
    name="pull",
    sentence="Dragged over the floor by a testing machine's cable at constant speed.",
    verb="Pull",
    drive=Drive.HEAD,
    channels=(("force",),),
    likelihood=Likelihood.FORCE,
    baselines=(*ROBOT, "drag"),
    nuisances=("slack of the cable", "zero of the load cell", "moments of the teeth"),
    file_words=("pull", "tug", "tow"),
    duration=16.0,
    sample_rate=100.0,
    scenario=_scenario,
    effect_checks=_effect_checks,
)
