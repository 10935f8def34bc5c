"""A rig with one mass that is driven, let go or shaken, and a block that is pulled."""

from __future__ import annotations

import math

import numpy as np

from ssmr_ident.core.errors import InputError
from ssmr_ident.core.parameter import ParameterSet
from ssmr_ident.core.recording import Recording
from ssmr_ident.estimate.foot import foot_motion
from ssmr_ident.experiments.experiment import BASES
from ssmr_ident.experiments.quantities import UNITS
from ssmr_ident.physics.rig import Rig, block_from_parameters, rig_from_parameters
from ssmr_ident.physics.slots import effect_values
from ssmr_ident.physics.voltage_drive import Controller, Course, VoltageDrive, drive_from_parameters
from ssmr_ident.readers import ReadOptions, read_one
from ssmr_ident.simulate.bench import pull_block
from ssmr_ident.simulate.rig import simulate_rig
from ssmr_ident.workflows.simulate.logged import head_of, logged
from ssmr_ident.workflows.simulate.request import Request

STRAIGHT, ROTARY = ("position", "velocity", "acceleration"), ("angle", "angular_rate")
"""Motions that a log of a rig has; an angular acceleration is nothing that loggers know."""


def driven(parameters: ParameterSet, request: Request) -> Recording:
    """Under a measured force, or torque, or by a motor."""
    rig, motor = rig_from_parameters(parameters), drive_from_parameters(parameters)
    conditions = request.conditions
    if motor is not None:
        return _by_motor(parameters, request, rig, motor)
    if conditions.kp_V_rad:
        where = f"{parameters.file or parameters.name}: --kp-V-rad"
        raise InputError(where, "is of a motor's controller, and the file has no drive:", "Leave it out")
    name = "torque" if rig.rotary else "force"
    time, rate, force = drive_of(request, "force", (name,))[:3]
    motion = _motion(parameters, rig, force, rate)
    return logged(request, time, **{name: (force, UNITS[name])}, **_channels(rig, motion))


def _by_motor(parameters: ParameterSet, request: Request, rig: Rig, motor: VoltageDrive) -> Recording:
    """Given a voltage, or a goal and its controller; ``enabled`` is 0 where the motor is open."""
    conditions = request.conditions
    wanted = "position_reference" if conditions.kp_V_rad else "voltage"
    log, name = log_of(request, "force", (wanted,))
    on = log["enabled"] if "enabled" in log else np.ones(len(log.time))
    held = Controller(conditions.kp_V_rad, conditions.limit_V) if conditions.kp_V_rad else None
    course = Course(log[name], on, held)
    effects = effect_values(parameters)
    motion = simulate_rig(rig, np.zeros(len(on)), log.sample_rate, effects=effects, motor=motor, course=course)
    given = {name: (log[name], "rad" if held else "V")} | ({"enabled": (on, "")} if "enabled" in log else {})
    return logged(request, log.time, **given, **_channels(rig, motion))


def let_go(parameters: ParameterSet, request: Request) -> Recording:
    """Let go at rest, deflected."""
    rig, conditions = rig_from_parameters(parameters), request.conditions
    count = round(request.duration * request.rate)
    start = math.radians(conditions.amplitude_deg) if rig.rotary else conditions.amplitude_mm * 1e-3
    if conditions.push_N:
        if rig.rotary or rig.stiffness == 0.0:
            raise InputError("--push-N", "deflects no such rig", "Say where it is let go: --amplitude-deg, -mm")
        start = conditions.push_N / rig.stiffness
    motion = _motion(parameters, rig, np.zeros(count), request.rate, start)
    return logged(request, np.arange(count) / request.rate, **_channels(rig, motion))


def shaken(parameters: ParameterSet, request: Request) -> Recording:
    """On a foot whose motion was measured: what the mass does is absolute."""
    rig = rig_from_parameters(parameters)
    if rig.rotary:
        raise InputError("--experiment", "base_motion shakes a foot along a line", "Drive a rotary rig: forced")
    time, rate, base, name = drive_of(request, "base", BASES[::-1])
    acceleration_alone = {"acceleration": 2}
    foot = foot_motion(base, name, acceleration_alone, rate, request.base)
    motion = foot + _motion(parameters, rig, -rig.mass * foot[:, 2], rate)
    found = _channels(rig, motion)
    if name == "base_acceleration":  # where the foot itself is, is not known
        found = {"acceleration": found["acceleration"]}
    return logged(request, time, **{name: (base, UNITS[name])}, **found)


def pulled_block(parameters: ParameterSet, request: Request) -> Recording:
    """A block whose cable end follows the head of a testing machine."""
    if request.conditions.cable != "steel":
        raise InputError("--cable", "a block's own is in its file", "Write cable: {stiffness_N_m: …} there")
    time, head = head_of(request)
    force = pull_block(block_from_parameters(parameters), head, 1.0 / request.rate, effect_values(parameters))
    return logged(request, time, position=(head, "m"), force=(force, "N"))


def drive_of(request: Request, option: str, names: tuple[str, ...]) -> tuple[np.ndarray, float, np.ndarray, str]:
    """Time, rate, samples and name of the first of the channels that the option's log has."""
    log, name = log_of(request, option, names)
    return log.time, log.sample_rate, log[name], name


def log_of(request: Request, option: str, names: tuple[str, ...]) -> tuple[Recording, str]:
    """The option's log, and the first of the channels that it has."""
    path = {"force": request.force, "base": request.base}[option]
    if not path:
        raise InputError(f"--{option}", "is missing", f"Name a log with columns time and {' or '.join(names)}")
    if request.duration_s is not None or request.rate_hz is not None:
        raise InputError("--duration-s, --rate-hz", f"are those of {path}", "Leave them out")
    log = read_one(path, ReadOptions())
    name = next((name for name in names if name in log), None)
    if name is None:
        unit = "rad" if names[0] == "position_reference" else UNITS[names[0]]
        mend = f"Head the column '{names[0]} ({unit})'"
        raise InputError(path, f"has no {' or '.join(names)}; found {', '.join(log.names)}", mend)
    return log, name


def _motion(parameters: ParameterSet, rig: Rig, force: np.ndarray, rate: float, start: float = 0.0) -> np.ndarray:
    """Position, velocity and acceleration, (n, 3) float."""
    bandwidth, motor = parameters.number("accelerometer.bandwidth_hz", math.inf), drive_from_parameters(parameters)
    effects = effect_values(parameters)
    return simulate_rig(rig, force, rate, start, bandwidth_hz=bandwidth, effects=effects, motor=motor)


def _channels(rig: Rig, motion: np.ndarray) -> dict[str, tuple[np.ndarray, str]]:
    names = ROTARY if rig.rotary else STRAIGHT
    return {name: (column, UNITS[name]) for name, column in zip(names, motion.T, strict=False)}
