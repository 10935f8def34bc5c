"""A pulling cable that stretches."""

from __future__ import annotations

import math

from ssmr_ident.core.parameter import Parameter
from ssmr_ident.physics.effect import Effect, Site, Sized


def change(stiffness: float, K_cable_N_m: float) -> float:
    """Two springs in series (3.9); [N/m]."""
    if math.isinf(K_cable_N_m):
        return stiffness
    return K_cable_N_m if math.isinf(stiffness) else stiffness * K_cable_N_m / (stiffness + K_cable_N_m)


EFFECT = Effect(
    id="cable_compliance",
    sentence="The pulling cable stretches.",
    equation=r"K = \frac{K_{cable} K_0}{K_{cable} + K_0}",
    source="Thesis eq (3.9)",
    signature="all ramps of the pulls are flatter by the same added compliance, whatever the wheels that grip",
    parameters=(Parameter("K_cable_N_m", "N/m", 5e4, 1.0, math.inf, "in series with the cable", off=math.inf),),
    experiments=("pull", "wheel_drag"),
    acts={Site.PULL: change},
    # it stretches by no more than the head goes
    limits={"K_cable_N_m": (Sized(0.8, "rise"), Sized(math.inf, "stiffness"))},
    probes=(
        {"K_cable_N_m": Sized(2.0, "stiffness")},
        {"K_cable_N_m": Sized(10.0, "stiffness")},
        {"K_cable_N_m": Sized(60.0, "stiffness")},
    ),
)
