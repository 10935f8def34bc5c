"""Play: a joint or gear without stiffness within a gap."""

from __future__ import annotations

from ssmr_ident.core.kernel import kernel
from ssmr_ident.core.parameter import Parameter
from ssmr_ident.core.simd import where
from ssmr_ident.physics.effect import Effect, Site, Sized


@kernel
def force(s, stiffness, gap, rounding):
    """What the gap takes off the elastic K·s [N].

    Inside ± gap/2 the spring does nothing; the corners are rounded over ``rounding``·gap.
    s, gap : float [m], stiffness : float [N/m].
    """
    half = 0.5 * gap
    width = rounding * gap
    beyond = abs(s) - half
    corner = abs(s) - (beyond + width) * (beyond + width) / (4.0 * width)
    taken = where(beyond <= -width, abs(s), where(beyond >= width, half, corner))
    return -stiffness * where(s >= 0.0, taken, -taken)


EFFECT = Effect(
    id="free_play",
    sentence="A joint has play: within a gap nothing holds it.",
    equation=r"F = K\,\mathrm{dz}(s),\quad \mathrm{dz}(s) = s - \mathrm{sign}(s)\min(|s|, g/2)",
    source="Nayfeh and Mook, Nonlinear Oscillations, Wiley 1979, section 2.1 (piecewise linear springs)",
    signature="natural frequency falls as the amplitude comes down to the gap; a flat middle in the restoring force",
    parameters=(
        Parameter("gap_m", "m", 2e-4, 0.0, 1.0, "full width", off=0.0),
        Parameter("rounding", "1", 0.1, 1e-3, 0.5, "share of the gap over which its corners are rounded"),
        Parameter("share_x", "1", 1.0, 0.0, 1.0, "gap along x as a share of that along y (robot)"),
    ),
    experiments=("free_response", "forced", "pull"),
    acts={Site.ELEMENT: force},
    rig=True,
    probes=(
        {"gap_m": Sized(0.05, "deflection"), "rounding": 0.2},
        {"gap_m": Sized(0.3, "deflection"), "rounding": 0.2},
    ),
    holds={"share_x": (1.0, 0.0)},
    loosens=True,
)
