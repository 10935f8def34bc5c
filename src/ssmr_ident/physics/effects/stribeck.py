"""Friction that falls with sliding speed."""

from __future__ import annotations

from ssmr_ident.core.exponential import exp
from ssmr_ident.core.kernel import kernel
from ssmr_ident.core.parameter import Parameter
from ssmr_ident.core.simd import anywhere, lanewise
from ssmr_ident.physics.effect import Effect, Site


@lanewise
@kernel
def _power(ratio, exponent):
    return ratio * ratio if exponent == 2.0 else ratio**exponent


@kernel
def coefficient(mu_static, share, speed, width, exponent):
    """mu_s·(r + (1 - r)·exp(-(u/v_s)^δ)); speed u, width v_s : float [m/s], share r = mu_k/mu_s, exponent δ : float."""
    if not anywhere(speed != 0.0):
        return mu_static * (share + (1.0 - share))
    return mu_static * (share + (1.0 - share) * exp(-_power(speed / width, exponent)))


EFFECT = Effect(
    id="stribeck",
    sentence="Once a contact slides, its friction falls with the sliding speed.",
    equation=r"\mu(u) = \mu_k + (\mu_s - \mu_k)\,e^{-(u/v_s)^\delta}",
    source="R. Stribeck, VDI-Zeitschrift 46, 1902; L. C. Bo and D. Pavelescu, Wear 82, 1982 (the exponent); "
    "Armstrong-Helouvry et al., Automatica 30(7), 1994",
    signature="a saw-tooth in a pull where the friction would be constant; a swivel that excites itself",
    parameters=(
        Parameter("kinetic_share", "1", 0.8, 0.05, 1.0, "mu_k/mu_s at high speed", off=1.0),
        Parameter("stribeck_velocity_m_s", "m/s", 3e-3, 1e-5, 1.0, "speed at which most of the fall is done"),
        Parameter("exponent", "1", 2.0, 0.5, 20.0, "delta: the larger, the less friction falls at speeds below v_s"),
    ),
    experiments=("pull", "wheel_drag", "swivel"),
    acts={Site.FRICTION: coefficient},
    probes=(
        {"kinetic_share": 0.8, "stribeck_velocity_m_s": 0.001},
        {"kinetic_share": 0.8, "stribeck_velocity_m_s": 0.01},
        {"kinetic_share": 0.8, "stribeck_velocity_m_s": 0.002, "exponent": 6.0},
    ),
    spans={
        "kinetic_share": (0.6, 0.7, 0.8, 0.9, 0.95),
        "stribeck_velocity_m_s": (0.001, 0.003, 0.01),
        # a constant friction goes through the middle of saw-teeth: their tops are up to 2/(1 + r) above it
        "baseline.mu_static": (1.0, 1.03, 1.06, 1.12, 1.2),
    },
)
