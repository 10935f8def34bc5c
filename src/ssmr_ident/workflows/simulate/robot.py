"""A robot, or one of its wheels on a bench, in the experiments that are done with it."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace

import numpy as np

from ssmr_ident.compare.turning import SETTLING, turning_robot, with_floor
from ssmr_ident.core.errors import InputError
from ssmr_ident.core.parameter import ParameterSet
from ssmr_ident.core.recording import Recording
from ssmr_ident.experiments.experiment import ACCELERATIONS
from ssmr_ident.identify.body.output_error import START_SCALES
from ssmr_ident.identify.trials.pure_rotation import PureRotation, axis_of
from ssmr_ident.physics.linear import COORDINATES
from ssmr_ident.physics.robot import Robot, robot_from_parameters
from ssmr_ident.physics.slots import Effects, effect_values
from ssmr_ident.simulate.bench import load_wheel
from ssmr_ident.simulate.simulation import Simulation, simulate
from ssmr_ident.workflows.simulate.logged import head_of, logged
from ssmr_ident.workflows.simulate.request import Request


def whole(parameters: ParameterSet, request: Request) -> Recording:
    """Released, pulled, or driving by itself."""
    robot, effects = robot_from_parameters(parameters), effect_values(parameters)
    if not request.experiment.repeats:
        return _running(parameters, request)
    result = run_robot(robot, effects, request)
    if result.scenario.pulled:
        return logged(request, result.time, position=(result["head"], "m"), force=(result["force"], "N"))
    return result.recording(*ACCELERATIONS)


def _running(parameters: ParameterSet, request: Request) -> Recording:
    """Driving by itself, as it is compared: contacts that slide together, a floor with its grain, a steady course."""
    robot = turning_robot(parameters)
    effects = with_floor(effect_values(parameters), parameters, float(request.seed + 1))
    longer = replace(request, duration_s=request.duration + SETTLING)
    course = run_robot(robot, effects, longer).recording(*ACCELERATIONS)
    begun = round(SETTLING * request.rate)
    kept = [replace(channel, samples=channel.samples[begun:]) for channel in course.channels]
    return replace(course, time=course.time[begun:] - course.time[begun], channels=tuple(kept))


def one_wheel(parameters: ParameterSet, request: Request) -> Recording:
    """Dragged or pressed on a bench."""
    robot, effects, conditions = robot_from_parameters(parameters), effect_values(parameters), request.conditions
    time, head = head_of(request)
    step = 1.0 / request.rate
    force = load_wheel(robot, request.experiment, head, step, conditions.free_normal, effects)
    return logged(request, time, position=(head, "m"), force=(force, "N"))


def turning_purely(parameters: ParameterSet, request: Request) -> Recording:
    """Released, and swinging about its centre of mass as (5.3) has it: one axis of the accelerometer sees it."""
    if parameters.effects:
        problem = f"{', '.join(parameters.effects)} are no part of pure rotations"
        raise InputError("--baseline decoupled", problem, "Simulate them with --baseline rigid6")
    robot = robot_from_parameters(parameters)
    scenario = request.experiment.scenario
    assert scenario is not None
    offset = scenario(robot, request.conditions, request.duration).offset
    state = np.zeros(len(START_SCALES))
    turned = request.conditions.motion
    state[COORDINATES.index(turned)] = offset[turned]
    axis, count = axis_of(turned), round(request.duration * request.rate)
    course = PureRotation(axis).responses(robot, count, 1.0 / request.rate)[:, 0] @ (state / START_SCALES)
    return logged(request, np.arange(count) / request.rate, **{axis: (course, "m/s^2")})


def run_robot(
    robot: Robot, effects: Effects, request: Request, offset: Mapping[str, float] | None = None
) -> Simulation:
    """The whole robot in one of the experiments that are done with it, begun ``offset`` further away.

    N >= 0 (4.15) is part of the baseline of pulls; on wheels of its own and let go a robot has it by the effect
    ``wheel_lift``, which recordings tell.
    """
    experiment = request.experiment
    if experiment.scenario is None:
        raise InputError("--experiment", f"{experiment.name} is not done with a whole robot")
    if experiment.on_a_testing_machine:
        effects = {"wheel_lift": {"active": 1.0}, **effects}
    scenario = experiment.scenario(robot, request.conditions, request.duration)
    if offset:
        scenario = replace(scenario, offset={**scenario.offset, **offset})
    return simulate(robot, scenario, request.rate, effects=effects)
