"""A sensor that clips."""

from __future__ import annotations

import math
from collections.abc import Mapping

import numpy as np

from ssmr_ident.core.parameter import Parameter
from ssmr_ident.physics.effect import Effect, Site, Sized

ACCELERATIONS = ("ax", "ay", "az", "acceleration", "acceleration_2")
RANGES = {
    "range_m_s2": ACCELERATIONS,
    "range_N": ("force",),
    "range_m": ("position",),
    "range_m_s": ("velocity",),
    "range_rad": ("angle",),
    "range_rad_s": ("angular_rate", "wx", "wy", "wz"),
}
"""Channels by the range that they have."""


def change(
    time: np.ndarray,
    channels: Mapping[str, np.ndarray],
    range_m_s2: float,
    range_N: float,
    range_m: float,
    range_m_s: float,
    range_rad: float,
    range_rad_s: float,
) -> dict[str, np.ndarray]:
    """Clip each channel at the range of its quantity; channels : (n,) float [SI].

    An accelerometer's axis that reads more than the range for half of the time, as one that carries gravity does, has
    another range.
    """
    ranges = (range_m_s2, range_N, range_m, range_m_s, range_rad, range_rad_s)
    limits = {name: limit for names, limit in zip(RANGES.values(), ranges, strict=True) for name in names}
    for name, samples in channels.items():
        if name in ACCELERATIONS and np.median(np.abs(samples)) > limits[name]:
            limits[name] = math.inf
    return {name: np.clip(s, -limits[name], limits[name]) if name in limits else s for name, s in channels.items()}


EFFECT = Effect(
    id="sensor_saturation",
    sentence="The sensor clips: what lies beyond its range is cut off.",
    equation=r"y = \max(-r, \min(r, a))",
    source="Data sheet SCA620 (±1.7 g); thesis.md section 7.8",
    signature="flat tops at one and the same level",
    parameters=(
        Parameter("range_m_s2", "m/s^2", 12.0, 1e-4, math.inf, "of the accelerometers", off=math.inf),
        Parameter("range_N", "N", 150.0, 1e-4, math.inf, "of the load cell", off=math.inf),
        Parameter("range_m", "m", 0.01, 1e-12, math.inf, "of a position sensor", off=math.inf),
        Parameter("range_m_s", "m/s", 1.0, 1e-12, math.inf, "of a velocity sensor", off=math.inf),
        Parameter("range_rad", "rad", 1.0, 1e-12, math.inf, "of an angle sensor", off=math.inf),
        Parameter("range_rad_s", "rad/s", 10.0, 1e-12, math.inf, "of a rate sensor", off=math.inf),
    ),
    experiments=("free_response", "pull", "wheel_drag", "vertical_compression", "swivel", "straight", "forced"),
    acts={Site.OUTPUT: change},
    rig=True,
    probes=(
        {"range_m_s2": Sized(0.99, "reading")},
        {"range_m_s2": Sized(0.9, "reading")},
        # an axis that carries gravity clips beside it, and what clips below that reads one number all the time
        {"range_m_s2": Sized(0.8, "beyond_weight", above="weight")},
        {"range_m_s2": Sized(0.4, "beyond_weight", above="weight")},
        {"range_m_s2": Sized(0.99, "level_reading")},
        {"range_m_s2": Sized(0.9, "level_reading")},
        {"range_N": Sized(0.99, "load")},
    ),
    sudden=True,
)
