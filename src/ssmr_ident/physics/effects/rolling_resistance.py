"""A force against rolling."""

from __future__ import annotations

import math

from ssmr_ident.core.kernel import kernel
from ssmr_ident.core.parameter import Parameter
from ssmr_ident.physics.effect import Effect, Site

ROUNDING = 1e-3  # m/s over which the sign of the speed is rounded


@kernel
def force(load, speed, coefficient):
    """-c_rr·N·tanh(v/v_0) [N] on the hub along x; load : float [N], speed : float [m/s]."""
    return -coefficient * load * math.tanh(speed / ROUNDING)


EFFECT = Effect(
    id="rolling_resistance",
    sentence="Rolling itself costs force: the tire's flattening brakes every wheel.",
    equation=r"F_x = -c_{rr} N\,\mathrm{sign}(v_x)",
    source="Thesis chapter 2, Assumption 3; J. Y. Wong, Theory of Ground Vehicles, Wiley 2008, section 1.2",
    signature="a constant force against motion along x, proportional to the load; slower turns",
    parameters=(Parameter("c_rr", "1", 0.03, 0.0, 0.5, "rolling resistance coefficient", off=0.0),),
    experiments=("pull", "swivel", "straight"),
    acts={Site.BODY: force},
    probes=({"c_rr": 0.03},),
)
