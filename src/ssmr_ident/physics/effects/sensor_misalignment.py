"""Sensor axes turned against the robot's."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from ssmr_ident.core.parameter import Parameter
from ssmr_ident.physics.effect import Effect, Site

AXES = ("ax", "ay", "az")


def change(
    time: np.ndarray,
    channels: Mapping[str, np.ndarray],
    angle_x_rad: float,
    angle_y_rad: float,
    angle_z_rad: float,
) -> dict[str, np.ndarray]:
    """What turned axes read: R^T a with R = Rz·Ry·Rx; ax, ay, az : (n,) float [m/s^2]."""
    cx, sx, cy, sy = np.cos(angle_x_rad), np.sin(angle_x_rad), np.cos(angle_y_rad), np.sin(angle_y_rad)
    cz, sz = np.cos(angle_z_rad), np.sin(angle_z_rad)
    turn = np.array([[cz, -sz, 0], [sz, cz, 0], [0, 0, 1]]) @ np.array([[cy, 0, sy], [0, 1, 0], [-sy, 0, cy]])
    turn = turn @ np.array([[1, 0, 0], [0, cx, -sx], [0, sx, cx]])
    read = np.column_stack([channels[name] for name in AXES]) @ turn
    return {**channels, **{name: read[:, index] for index, name in enumerate(AXES)}}


EFFECT = Effect(
    id="sensor_misalignment",
    sentence="The sensor sits askew: its axes are turned against the robot's, and gravity leaks in.",
    equation=r"a_{log} = R_z R_y R_x{}^{\!T}\, a",
    source="Own formula: rotation of the sensor cube",
    signature="every channel holds a fixed share of the others, in all motions alike",
    parameters=tuple(
        Parameter(f"angle_{axis}_rad", "rad", 0.05, -0.5, 0.5, f"about {axis}", off=0.0) for axis in "xyz"
    ),
    experiments=("free_response", "swivel"),
    acts={Site.OUTPUT: change},
    probes=({"angle_x_rad": 0.05, "angle_y_rad": 0.05, "angle_z_rad": 0.05},),
)
