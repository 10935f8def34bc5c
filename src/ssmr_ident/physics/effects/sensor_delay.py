"""A motion channel that comes later than what drives it, by a constant time: two clocks, or a converter's pipeline."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from ssmr_ident.core.parameter import Parameter
from ssmr_ident.physics.effect import Effect, Site

LATE = (
    *("ax", "ay", "az", "wx", "wy", "wz", "acceleration", "acceleration_2"),
    *("velocity", "position", "angle", "angular_rate"),
)
"""What sensors of the motion give."""


def change(time: np.ndarray, channels: Mapping[str, np.ndarray], delay_s: float) -> dict[str, np.ndarray]:
    """Every sensor of the motion ``delay_s`` later; channels : (n,) float, straight lines between samples."""
    late = {name: np.interp(time - delay_s, time, s) for name, s in channels.items() if name in LATE}
    return {**channels, **late}


EFFECT = Effect(
    id="sensor_delay",
    sentence="The motion is logged later than the force, by the same time throughout.",
    equation=r"y(t) = x(t - \tau)",
    source="L. Ljung, System Identification, Prentice Hall 1999, section 14.2 (time delays)",
    signature="phase that grows in proportion to frequency, with amplitudes unchanged",
    parameters=(Parameter("delay_s", "s", 0.001, -1e3, 1e3, "of the motion against what drives it", off=0.0),),
    experiments=("forced",),
    acts={Site.OUTPUT: change},
    rig=True,
)
