"""A force sensor whose zero or gain wanders."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from ssmr_ident.core.parameter import Parameter
from ssmr_ident.physics.effect import Effect, Site, Sized


def change(
    time: np.ndarray, channels: Mapping[str, np.ndarray], zero_drift_N_s: float, gain_drift_1_s: float
) -> dict[str, np.ndarray]:
    """F (1 + g t) + z t; time : (n,) float [s], force : (n,) float [N]."""
    elapsed = time - time[0]
    return {**channels, "force": channels["force"] * (1.0 + gain_drift_1_s * elapsed) + zero_drift_N_s * elapsed}


EFFECT = Effect(
    id="load_cell_drift",
    sentence="The force sensor's zero or gain wanders while it records.",
    equation=r"F_{log} = F\,(1 + g t) + z t",
    source="Own formula: linear drift",
    signature="a slope over time that does not depend on speed or travel",
    parameters=(
        Parameter("zero_drift_N_s", "N/s", 0.5, -1e4, 1e4, "of the zero", off=0.0),
        Parameter("gain_drift_1_s", "1/s", 0.0, -0.1, 0.1, "of the gain", off=0.0),
    ),
    experiments=("pull", "wheel_drag", "vertical_compression"),
    acts={Site.OUTPUT: change},
    probes=({"zero_drift_N_s": Sized(0.2, "load/duration"), "gain_drift_1_s": Sized(0.05, "/duration")},),
)
