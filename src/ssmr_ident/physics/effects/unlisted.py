"""What no listed effect does: a force of displacement, velocity and time, or on a rig a mass that rides along."""

from __future__ import annotations

import math
from collections.abc import Mapping

import numpy as np

from ssmr_ident.core.kernel import kernel
from ssmr_ident.core.parameter import Parameter
from ssmr_ident.core.simd import first, lanewise
from ssmr_ident.physics.effect import Effect, Site, Sized

TERMS = {
    "c_abs_v_N_s_m": "|v|",
    "c_abs_s_N_m": "(|s - place| - |place|)",
    "c_s2_N_m2": "s^2",
    "c_v2_N_s2_m2": "v^2",
    "c_sv_N_s_m2": "s v",
    "c_s2v_N_s_m3": "s^2 v",
    "c_v3_N_s3_m3": "v^3",
    "c_s_abs_v_N_s_m2": "s |v|",
    "c_root_v_N_s05_m05": "sign(v) sqrt|v|",
    "c_ts_N_m_s": "t s",
    "c_tv_N_m": "t v",
    "c_sin_s_N_m": "s sin(2 pi pulse_Hz t)",
    "c_cos_s_N_m": "s cos(2 pi pulse_Hz t)",
}
"""Terms by parameter, t from where a recording begins. What is odd in s alone or |v| v is hardening or quadratic
damping, which are listed. |s - place| less a straight line, which is in K, is a spring that touches on one side."""

PULSE_HZ = len(TERMS)
RIDER_SHARE, RIDER_HZ, RIDER_RATIO, PLACE = range(PULSE_HZ + 1, PULSE_HZ + 5)
"""Places behind the terms' coefficients."""

_SLOW = 1e-3
"""m/s; below it the root is a straight line, so that its slope stays finite."""

_TURN = 2.0 * math.pi


@lanewise
@kernel
def _slowness(v):
    """1/sqrt|v|, and finite at rest; v : float [m/s]."""
    return (v * v + _SLOW * _SLOW) ** -0.25


@kernel
def force(s, v, t, ratio, c):
    """Σ c_i f_i(s, v, t) [N], what is in proportion to s alone times ``ratio``.

    s : float [m], v : float [m/s], t : float [s]; ratio : float, stiffness of this axis over the reference axis's,
    since a spring is uneven by a share of its stiffness; c : (n,) float in the order of the parameters.
    """
    spring = c[1] * (abs(s - c[PLACE]) - abs(c[PLACE])) + c[2] * s * s + t * c[9] * s
    if first(c[11]) != 0.0 or first(c[12]) != 0.0:
        phase = _TURN * c[PULSE_HZ] * t
        spring += s * (c[11] * math.sin(phase) + c[12] * math.cos(phase))
    return (
        ratio * spring
        + c[0] * abs(v) + c[3] * v * v + c[4] * s * v + c[5] * s * s * v + c[6] * v * v * v + c[7] * s * abs(v)
        + (c[8] * v * _slowness(v) if first(c[8]) != 0.0 else 0.0) + t * c[10] * v
    )  # fmt: skip


def law(values: Mapping[str, float]) -> str:
    """The terms that are there, as plain text."""
    parts = [f"{name.split('_N')[0]} {term}" for name, term in TERMS.items() if values.get(name, 0.0) != 0.0]
    text = "F = K s + D v" + "".join(f" + {part}" for part in parts)
    if values.get("c_abs_s_N_m", 0.0) != 0.0:
        text += f"; place = {values.get('place_m', 0.0):.3g} m"
    if values.get("rider_share", 0.0) != 0.0:
        text += "; rider_share of the mass rides on a spring of its own, at rider_Hz with the damping rider_ratio"
    return text


_UNITS = ("N s/m", "N/m", "N/m^2", "N s^2/m^2", "N s/m^2", "N s/m^3", "N s^3/m^3", "N s/m^2", "N s^0.5/m^0.5",
          "N/(m s)", "N/m", "N/m", "N/m")  # fmt: skip
_SIZES = (
    "force/speed", "force/deflection", "force/deflection^2", "force/speed^2", "force/deflection*speed",
    "force/deflection^2*speed", "force/speed^3", "force/deflection*speed",
    "force/speed^0.5", "force/deflection*duration", "force/speed*duration", "stiffness", "stiffness",
)  # fmt: skip

_PULSES: tuple[Mapping[str, float | Sized], ...] = tuple(
    {"c_sin_s_N_m": Sized(0.05, "stiffness"), "c_cos_s_N_m": Sized(0.05, "stiffness"),
     "pulse_Hz": Sized(turns, "/duration")}
    for turns in np.arange(1.0, 16.5, 0.5)
)  # fmt: skip
"""Every half turn within the longest recording: what lies between is half seen from either side. Slower is a stiffness
that drifts."""

_RIDERS: tuple[Mapping[str, float | Sized], ...] = tuple(
    {"rider_share": 0.01, "rider_Hz": Sized(float(turns) / _TURN, "/time"), "rider_ratio": 0.03}
    for turns in np.geomspace(0.1, 2.5, 30)
)
"""A ninth between one and the next: the descent finds what is left of that. So small a share, because a straight line
must tell which frequency it is. Where noise is fast, a recording's motion seems faster than it is: down to a tenth."""

_OFF = 0.4
"""Share of the largest deflection by which a bend may well be off the middle."""

_TOUCHES: tuple[Mapping[str, float | Sized], ...] = tuple(
    {"c_abs_s_N_m": Sized(0.05, "stiffness"), "place_m": Sized(share, "deflection")} for share in (-_OFF, _OFF)
)

EFFECT = Effect(
    id="unlisted",
    sentence="A force acts beside spring and damper that none of the listed effects makes.",
    equation=r"F = K s + D v + \sum_i c_i f_i(s, v, t)",
    source="Masri and Caughey, J. Appl. Mech. 46 (1979), restoring-force surfaces",
    signature="the force left over is ordered by displacement and velocity, and no listed law follows it",
    parameters=(
        *(
            Parameter(name, unit, 0.0, -1e18, 1e18, f"of {term}", off=0.0)
            for (name, term), unit in zip(TERMS.items(), _UNITS, strict=True)
        ),
        Parameter("pulse_Hz", "Hz", 1.0, 1e-4, 1e5, "of the stiffness that goes up and down"),
        Parameter("rider_share", "1", 0.0, 0.0, 0.9, "of a rig's mass, on a spring of its own", off=0.0),
        Parameter("rider_Hz", "Hz", 10.0, 1e-3, 1e5, "its frequency where the rest is held"),
        Parameter(
            "rider_ratio",
            "1",
            0.03,
            1e-4,
            0.1,
            "its damping ratio; with more it is as relaxation",
        ),
        Parameter("place_m", "m", 0.0, -100.0, 100.0, "where |s - place| bends"),
    ),
    experiments=("free_response", "forced"),
    acts={Site.ELEMENT: force},
    rig=True,
    probes=tuple(
        {name: Sized(0.05, size), **({"place_m": 0.0} if name == "c_abs_s_N_m" else {})}
        for name, size in list(zip(TERMS, _SIZES, strict=True))[: PULSE_HZ - 2]
    ),
    rig_probes=(*_PULSES, *_RIDERS, *_TOUCHES),
    sizes={"place_m": Sized(_OFF, "deflection")},
)
