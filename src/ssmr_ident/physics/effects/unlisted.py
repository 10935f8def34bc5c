"""A force that no listed effect makes: smooth or angular in displacement and velocity."""

from __future__ import annotations

from collections.abc import Mapping

from ssmr_ident.core.kernel import kernel
from ssmr_ident.core.parameter import Parameter
from ssmr_ident.physics.effect import Effect, Site, Sized

TERMS = {
    "c_abs_v_N_s_m": "|v|",
    "c_abs_s_N_m": "|s|",
    "c_s2_N_m2": "s^2",
    "c_v2_N_s2_m2": "v^2",
    "c_sv_N_s_m2": "s v",
    "c_s2v_N_s_m3": "s^2 v",
    "c_v3_N_s3_m3": "v^3",
    "c_s_abs_v_N_s_m2": "s |v|",
    "c_root_v_N_s05_m05": "sign(v) sqrt|v|",
}
"""Terms by parameter. What is odd in s alone or |v| v is hardening or quadratic damping, which are listed."""

_SLOW = 1e-3
"""m/s; below it the root is a straight line, so that its slope stays finite."""


@kernel
def force(s, v, c):
    """Σ c_i f_i(s, v) [N]; s : float [m], v : float [m/s]; c : (9,) float or tuple in the order of ``TERMS``."""
    return (
        c[0] * abs(v) + c[1] * abs(s) + c[2] * s * s + c[3] * v * v
        + c[4] * s * v + c[5] * s * s * v + c[6] * v * v * v + c[7] * s * abs(v)
        + (c[8] * v * (v * v + _SLOW * _SLOW) ** -0.25 if c[8] != 0.0 else 0.0)
    )  # fmt: skip


def law(values: Mapping[str, float]) -> str:
    """The terms that are there, as plain text."""
    parts = [f"{name.split('_N')[0]} {term}" for name, term in TERMS.items() if values.get(name, 0.0) != 0.0]
    return "F = K s + D v + " + " + ".join(parts or ["0"])


_UNITS = ("N s/m", "N/m", "N/m^2", "N s^2/m^2", "N s/m^2", "N s/m^3", "N s^3/m^3", "N s/m^2", "N s^0.5/m^0.5")
_SIZES = (
    "force/speed", "force/deflection", "force/deflection^2", "force/speed^2", "force/deflection*speed",
    "force/deflection^2*speed", "force/speed^3", "force/deflection*speed",
    "force/speed^0.5",
)  # fmt: skip

EFFECT = Effect(
    id="unlisted",
    sentence="A force acts beside spring and damper that none of the listed effects makes.",
    equation=r"F = K s + D v + \sum_i c_i f_i(s, v)",
    source="Masri and Caughey, J. Appl. Mech. 46 (1979), restoring-force surfaces",
    signature="the force left over is ordered by displacement and velocity, and no listed law follows it",
    parameters=tuple(
        Parameter(name, unit, 0.0, -1e12, 1e12, f"of {term}", off=0.0)
        for (name, term), unit in zip(TERMS.items(), _UNITS, strict=True)
    ),
    experiments=("free_response", "forced"),
    acts={Site.ELEMENT: force},
    rig=True,
    probes=tuple({name: Sized(0.05, size)} for name, size in zip(TERMS, _SIZES, strict=True)),
)
