"""A sensor slower than its sheet says."""

from __future__ import annotations

import math
from dataclasses import replace
from typing import TYPE_CHECKING

from ssmr_ident.core.parameter import Parameter
from ssmr_ident.physics.effect import Effect, Site, Sized

if TYPE_CHECKING:
    from ssmr_ident.physics.robot import Robot


def change(robot: Robot, bandwidth_hz: float, order: float) -> Robot:
    """The slower of two sensors decides; a robot's is of second order."""
    sensor = robot.accelerometer
    return robot.with_changes(accelerometer=replace(sensor, bandwidth_hz=min(sensor.bandwidth_hz, bandwidth_hz)))


EFFECT = Effect(
    id="sensor_bandwidth",
    sentence="The accelerometer is slower than its data sheet says.",
    equation=r"H(s) = \frac{1}{1 + \sqrt{2}\,s/\omega_b + (s/\omega_b)^2}"
    r"\text{, or of first order}\ \frac{1}{1 + s/\omega_b}",
    source="Data sheet SCA620 (80 Hz); second-order Butterworth; RC filter",
    signature="high frequencies smaller and late: phase and amplitude fall together",
    parameters=(
        Parameter("bandwidth_hz", "Hz", 40.0, 1e-3, math.inf, "-3 dB point", off=math.inf),
        Parameter("order", "1", 2.0, 1.0, 2.0, "2: Butterworth; 1: an RC filter's, of rigs alone"),
    ),
    experiments=("free_response", "swivel", "forced"),
    acts={Site.SENSOR: change},
    rig=True,
    # on the thesis' robot 1 Hz at least, from 50, 25 and 14 Hz
    limits={"bandwidth_hz": (Sized(0.02, "/swing"), Sized(math.inf, "/swing"))},
    probes=tuple({"bandwidth_hz": Sized(turns, "/swing")} for turns in (1.0, 0.5, 0.28)),
    sudden=True,  # nothing changes down to the bandwidth that the sheet gives
)
