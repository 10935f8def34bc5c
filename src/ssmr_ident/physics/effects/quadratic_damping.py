"""Damping that grows with the square of the speed."""

from __future__ import annotations

from ssmr_ident.core.kernel import kernel
from ssmr_ident.core.parameter import Parameter
from ssmr_ident.physics.effect import Effect, Site, Sized


@kernel
def force(v, d2):
    """d2·v·|v| [N]; v : float [m/s], d2 : float [N s^2/m^2]."""
    return d2 * v * abs(v)


EFFECT = Effect(
    id="quadratic_damping",
    sentence="The damping force grows with the square of the speed, as in a fluid.",
    equation=r"F = D v + d_2 v |v|",
    source="Nayfeh and Mook, Nonlinear Oscillations, Wiley 1979, section 3.3",
    signature="damping ratio falls in proportion to the amplitude as a decay dies down",
    parameters=(Parameter("d2_N_s2_m2", "N s^2/m^2", 500.0, 0.0, 1e12, "of one tire or damper", off=0.0),),
    experiments=("free_response", "forced"),
    acts={Site.ELEMENT: force},
    rig=True,
    probes=({"d2_N_s2_m2": Sized(0.03, "force/speed^2")},),
)
