"""Stiffness that changes with deflection: hardening or softening.

A robot's axes have springs of their own, and what a cubic is on one of them says nothing of the others: ``k3_N_m3`` is
the same on all, ``k3_share_1_m2`` in proportion to K. What turns under its own weight is a pendulum, whose moment is a
sine.
"""

from __future__ import annotations

import math

from ssmr_ident.core.kernel import kernel
from ssmr_ident.core.parameter import Parameter
from ssmr_ident.core.simd import where
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


@kernel
def pendulum(s, stiffness, share):
    """Further moment [N m] of a spring of which ``share`` is a weight on an arm: K (sin s - s); s : float [rad]."""
    return share * stiffness * (math.sin(s) - s)


EFFECT = Effect(
    id="nonlinear_stiffness",
    sentence="A spring (the rig's, or the tires) stiffens or softens with deflection.",
    equation=r"F = K s + k_3 s^3 + a K\,\mathrm{sign}(s)\,\max(|s| - s_k, 0) + b K s^3"
    r" + p K (\sin s - s)",
    source="Thesis section 3.3; Kovacic and Brennan, The Duffing Equation, Wiley 2011",
    signature="natural frequency rises (hardening) or falls (softening) with amplitude; third harmonic",
    parameters=(
        Parameter("k3_N_m3", "N/m^3", 5e8, -1e18, 1e18, "cubic stiffness of one spring", off=0.0),
        Parameter("knee_share", "1", 0.0, -0.95, 20.0, "a: slope beyond the knee over K, less one", off=0.0),
        Parameter("knee_m", "m", 5e-4, 1e-10, 10.0, "deflection at which the slope changes"),
        Parameter("k3_share_1_m2", "1/m^2", 0.0, -1e14, 1e14, "b: cubic stiffness over K, on every axis", off=0.0),
        Parameter("sine_share", "1", 0.0, -2.0, 2.0, "p: share of K that is a pendulum's; rotary rigs", off=0.0),
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
    # rubber that is strained alike hardens in proportion to what it was, along as across and upright; where that is
    # more than a cubic's, a knee begun near the end of the travel finds it, and one in its middle does not
    robot_forms=(
        {"k3_share_1_m2": Sized(0.1, "/deflection^2"), "k3_N_m3": 0.0, "knee_share": 0.0},
        {"k3_share_1_m2": Sized(-0.1, "/deflection^2"), "k3_N_m3": 0.0, "knee_share": 0.0},
        {"k3_N_m3": Sized(0.1, "slope/reach^2"), "knee_share": Sized(0.1, ""), "knee_m": Sized(0.8, "deflection")},
    ),
)
