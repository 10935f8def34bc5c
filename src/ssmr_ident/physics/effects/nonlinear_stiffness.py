"""Stiffness that changes with deflection: hardening or softening."""

from __future__ import annotations

from ssmr_ident.core.kernel import kernel
from ssmr_ident.core.lanes import where
from ssmr_ident.core.parameter import Parameter
from ssmr_ident.physics.effect import Effect, Site, Sized


@kernel
def force(s, k3):
    """k3·s³ [N]; s : float [m], k3 : float [N/m^3]. Duffing's spring, thesis section 3.3 (15 to 21 kN/m)."""
    return k3 * s * s * s


@kernel
def beyond(s, stiffness, share, knee):
    """Further force [N] of a spring of slope (1 + share)·K beyond a knee; s, knee : float [m], stiffness K [N/m]."""
    further = where(s > knee, s - knee, where(s < -knee, s + knee, 0.0))
    return share * stiffness * further


EFFECT = Effect(
    id="nonlinear_stiffness",
    sentence="The tires (or the rig's spring) stiffen or soften as they are pressed.",
    equation=r"F = K s + k_3 s^3 + a K\,\mathrm{sign}(s)\,\max(|s| - s_k, 0)",
    source="Thesis section 3.3; Kovacic and Brennan, The Duffing Equation, Wiley 2011",
    signature="natural frequency rises (hardening) or falls (softening) with amplitude; third harmonic",
    parameters=(
        Parameter("k3_N_m3", "N/m^3", 5e8, -1e10, 1e11, "cubic stiffness of one spring", off=0.0),
        Parameter("knee_share", "1", 0.0, -0.95, 20.0, "a: slope beyond the knee over K, less one", off=0.0),
        Parameter("knee_m", "m", 5e-4, 1e-7, 10.0, "deflection at which the slope changes"),
    ),
    experiments=("free_response", "pull", "wheel_drag", "vertical_compression", "forced"),
    acts={Site.ELEMENT: force},
    rig=True,
    probes=(
        {"k3_N_m3": Sized(0.1, "slope/reach^2")},
        {"k3_N_m3": Sized(-0.1, "slope/reach^2")},
        {"knee_share": 0.2, "knee_m": Sized(0.4, "deflection")},
        {"knee_share": -0.2, "knee_m": Sized(0.4, "deflection")},
    ),
    # a spring that softens as a tanh does, or hardens towards a stop, is neither a cubic nor two straight lines
    forms=(
        {"k3_N_m3": Sized(0.1, "slope/reach^2"), "knee_share": Sized(0.1, ""), "knee_m": Sized(0.4, "deflection")},
        {"k3_N_m3": Sized(-0.1, "slope/reach^2"), "knee_share": Sized(-0.1, ""), "knee_m": Sized(0.4, "deflection")},
    ),
)
