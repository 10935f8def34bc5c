"""A centre of mass that is not where the file says."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np

from ssmr_ident.core.parameter import Parameter
from ssmr_ident.physics.effect import Effect, Site, Sized

if TYPE_CHECKING:
    from ssmr_ident.physics.robot import Robot


def change(robot: Robot, offset_x_m: float, offset_y_m: float) -> Robot:
    """Everything that is measured from the CoM moves the other way."""
    offset = np.array([offset_x_m, offset_y_m, 0.0])
    sensor = replace(robot.accelerometer, position=robot.accelerometer.position - offset)
    return robot.with_changes(contact_points=robot.contact_points - offset, accelerometer=sensor)


EFFECT = Effect(
    id="com_offset",
    sentence="The centre of mass is not where the parameter file says.",
    equation=r"p_i \to p_i - (d_x, d_y, 0)",
    source="Own formula: shift of the body frame's origin",
    signature="motions mix: roll into pitch and yaw; wheels are unevenly loaded",
    parameters=(
        Parameter("offset_x_m", "m", 0.02, -2.0, 2.0, "forward", off=0.0),
        Parameter("offset_y_m", "m", 0.02, -2.0, 2.0, "to the left", off=0.0),
    ),
    experiments=("free_response", "swivel", "pull"),
    acts={Site.ROBOT: change},
    limits=dict.fromkeys(("offset_x_m", "offset_y_m"), (Sized(-0.65, "height"), Sized(0.65, "height"))),
    probes=({"offset_x_m": Sized(0.043, "height"), "offset_y_m": Sized(0.043, "height")},),
)
