"""Free response: the robot, or a rig, is displaced or struck, let go, and swings by itself."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from ssmr_ident.core.errors import InputError
from ssmr_ident.experiments.conditions import Conditions
from ssmr_ident.experiments.experiment import ACCELERATIONS, RIGS, ROBOT, Drive, Experiment, Likelihood
from ssmr_ident.experiments.scenario import Scenario
from ssmr_ident.physics.linear import COORDINATES, linear_robot
from ssmr_ident.physics.robot import Robot
from ssmr_ident.session.entry import MOTIONS

_PUSHING_HEIGHT = 0.5  # m above the CoM: the top of the frame
_TURNING_ARM = 0.5  # m


def free_response(motion: str, amplitude: float = 0.001, duration: float = 4.096) -> Scenario:
    """Let go from a tilt or a turn and left to swing.

    Parameters
    ----------
    motion : str
        ``roll``: left tires pressed and right ones relieved by ``amplitude`` (thesis (6.5)); ``pitch``: rear
        and front; ``yaw``: the contact points turned sideways by ``amplitude``.
    amplitude : float [m]
        At the wheels.
    duration : float [s]
    """
    lever = {"roll": 0.18, "pitch": 0.14, "yaw": 0.18}  # Table 5.1: c, mean of a and b, c
    if motion not in lever:
        raise InputError("motion", f"is {motion!r}", "Give roll, pitch or yaw")
    return Scenario(FREE_RESPONSE.name, duration, offset={motion: amplitude / lever[motion]})


def pressed(robot: Robot, motion: str, amplitude: float = 0.001, duration: float = 4.096) -> Scenario:
    """Let go as the thesis does (6.5): only the vertical springs of two wheels are pressed and of two relieved.

    The contact points stay where they are, so the body tilts about the floor and not about its CoM. Springs along the
    floor that a tilt about the CoM strains as well would put most of a pitch into its second mode, near 11 Hz.

    Parameters
    ----------
    robot : Robot
    motion : str
        ``roll``, ``pitch``; ``yaw`` has no vertical springs and is that of ``free_response``.
    amplitude : float [m]
        At the wheels.
    """
    tilted = free_response(motion, amplitude, duration)
    if motion == "yaw":
        return tilted
    lever = robot.half_track if motion == "roll" else float(np.abs(robot.contact_points[:, 0]).mean())
    angle = amplitude / lever
    along, sign = ("y", -1.0) if motion == "roll" else ("x", 1.0)
    return replace(tilted, offset={motion: angle, along: sign * robot.height * float(np.sin(angle))})


def released(robot: Robot, motion: str, force: float, duration: float = 4.096) -> Scenario:
    """Pushed or turned by a steady force and let go: the start is the robot's own static deflection.

    Parameters
    ----------
    robot : Robot
    motion : str
        ``roll`` pushes sideways and ``pitch`` lengthwise at the height of the frame's top; ``yaw`` turns by the
        same force at half a metre.
    force : float [N]
    duration : float [s]
    """
    directions = {"roll": (0.0, 1.0), "pitch": (1.0, 0.0), "yaw": (0.0, 0.0)}
    if motion not in directions:
        raise InputError("motion", f"is {motion!r}", "Give roll, pitch or yaw")
    along, across = (force * share for share in directions[motion])
    turning = force * _TURNING_ARM if motion == "yaw" else 0.0
    wrench = np.array([along, across, 0.0, -across * _PUSHING_HEIGHT, along * _PUSHING_HEIGHT, turning])
    offset = np.linalg.solve(linear_robot(robot).stiffness, wrench)
    return Scenario(FREE_RESPONSE.name, duration, offset=dict(zip(COORDINATES, map(float, offset), strict=True)))


def _scenario(robot: Robot, conditions: Conditions, duration: float) -> Scenario:
    if conditions.push_N:
        return released(robot, conditions.motion, conditions.push_N, duration)
    if conditions.start == "vertical":
        return pressed(robot, conditions.motion, conditions.amplitude_mm * 1e-3, duration)
    return free_response(conditions.motion, conditions.amplitude_mm * 1e-3, duration)


def _effect_checks(robot: Robot, seconds: float) -> tuple[Scenario, ...]:
    tilted = Scenario("free_response", 0.5, offset={"roll": 2e-3, "pitch": 1e-3, "yaw": 2e-3})
    return tilted, free_response("roll", 4e-3, 0.5)


FREE_RESPONSE = Experiment(
    name="free_response",
    sentence="Displaced or struck, let go, and left to swing.",
    verb="Release",
    drive=Drive.NOTHING,
    channels=((*ACCELERATIONS, *MOTIONS),),
    likelihood=Likelihood.WAVEFORM,
    baselines=(*ROBOT, *RIGS),
    nuisances=("the state at the release", "zeros of the sensors", "mains lines"),
    file_words=("free", "release", "decay", "ring", "ringdown", "hammer", "tap"),
    duration=4.096,
    scenario=_scenario,
    effect_checks=_effect_checks,
)
