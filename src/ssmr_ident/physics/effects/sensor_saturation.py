"""A sensor that clips."""

from __future__ import annotations

import math
from collections.abc import Mapping

import numpy as np

from ssmr_ident.core.parameter import Parameter
from ssmr_ident.physics.effect import Effect, Site, Sized

ACCELERATIONS = ("ax", "ay", "az", "acceleration", "acceleration_2")


def change(
    time: np.ndarray, channels: Mapping[str, np.ndarray], range_m_s2: float, range_N: float
) -> dict[str, np.ndarray]:
    """Clip accelerations [m/s^2] and the load cell [N] at their ranges; channels : (n,) float."""
    clipped = dict(channels)
    for name in ACCELERATIONS:
        if name in channels:
            clipped[name] = np.clip(channels[name], -range_m_s2, range_m_s2)
    if "force" in channels:
        clipped["force"] = np.clip(channels["force"], -range_N, range_N)
    return clipped


EFFECT = Effect(
    id="sensor_saturation",
    sentence="The sensor clips: what lies beyond its range is cut off.",
    equation=r"y = \max(-r, \min(r, a))",
    source="Data sheet SCA620 (±1.7 g); thesis.md section 7.8",
    signature="flat tops at one and the same level",
    parameters=(
        Parameter("range_m_s2", "m/s^2", 12.0, 1e-4, math.inf, "of the accelerometers", off=math.inf),
        Parameter("range_N", "N", 150.0, 1e-4, math.inf, "of the load cell", off=math.inf),
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
        {"range_N": Sized(0.99, "load")},
    ),
    sudden=True,
)
