"""A friction coefficient that falls as the wheel is pressed harder."""

from __future__ import annotations

from ssmr_ident.core.kernel import kernel
from ssmr_ident.core.parameter import Parameter
from ssmr_ident.physics.effect import Effect, Site


@kernel
def coefficient(mu, load, nominal, exponent):
    """mu·(N/N_0)^(-n); load, nominal : float [N], exponent n."""
    if load <= 0.0:
        return mu
    return mu * (load / nominal) ** (-exponent)


EFFECT = Effect(
    id="load_sensitive_friction",
    sentence="Rubber grips relatively less the harder it is pressed.",
    equation=r"\mu(N) = \mu\,(N/N_0)^{-n},\quad N_0 = m g/4",
    source="A. Schallamach, The load dependence of rubber friction, Proc. Phys. Soc. B 65, 1952 (n = 1/3 for spheres)",
    signature="pulls with high cables or few gripping wheels end at another share of the load",
    parameters=(Parameter("exponent", "1", 0.15, -0.5, 0.9, "0 is Coulomb's law, 1/3 Hertz contact", off=0.0),),
    experiments=("pull", "swivel"),
    acts={Site.FRICTION: coefficient},
    probes=({"exponent": 0.15},),
)
