"""Roll drags lateral motion along, and pitch longitudinal motion."""

from __future__ import annotations

from ssmr_ident.core.parameter import Parameter
from ssmr_ident.physics.effect import Effect, Site

EFFECT = Effect(
    id="translation_coupling",
    sentence="Roll drags sideways motion along, and pitch forward motion, because the tires hold at the floor.",
    equation=r"\det\begin{pmatrix} m s^2 + 4D_y s + 4K_y & 4h(D_y s + K_y) \\ 4h(D_y s + K_y) & "
    r"I_x s^2 + 4(h^2D_y + c^2D_z)s + 4(h^2K_y + c^2K_z) - m g h \end{pmatrix} = 0",
    source="Derived from (2.65); what (5.11) must say (thesis.md sections 5 and 7.2)",
    signature="frequencies far below those of pure rotations; pure rotations ask for inertias 8 to 14 times too large",
    parameters=(Parameter("active", "1", 1.0, 0.0, 1.0, "0 or 1", off=0.0),),
    experiments=("free_response",),
    acts={Site.BODY: None},
    probes=({},),
    holds={"active": (1.0,)},
)
