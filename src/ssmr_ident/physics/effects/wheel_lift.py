"""Wheels that leave the floor."""

from __future__ import annotations

from ssmr_ident.core.kernel import kernel
from ssmr_ident.core.parameter import Parameter
from ssmr_ident.core.simd import where
from ssmr_ident.physics.effect import Effect, Site


@kernel
def load(force, depth):
    """max(0, N) and none in the air (4.15); force : float [N], depth of the tire below the floor : float [m]."""
    return where((force > 0.0) & (depth > 0.0), force, 0.0)


EFFECT = Effect(
    id="wheel_lift",
    sentence="A wheel can leave the floor, loses its grip there, and lands.",
    equation=r"N = \max(0,\,K_z s_z + D_z \dot s_z)",
    source="Thesis eq (4.15)",
    signature="loads cut off at zero in large motions; impacts at landing",
    parameters=(Parameter("active", "1", 1.0, 0.0, 1.0, "0 or 1", off=0.0),),
    experiments=("free_response", "swivel"),
    acts={Site.BODY: load},
    probes=({},),
    holds={"active": (1.0,)},
    sudden=True,
)
