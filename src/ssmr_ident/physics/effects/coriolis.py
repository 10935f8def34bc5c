"""The velocity-product term that section 6.1 drops."""

from __future__ import annotations

from ssmr_ident.core.parameter import Parameter
from ssmr_ident.physics.effect import Effect, Site

EFFECT = Effect(
    id="coriolis",
    sentence="Turning and moving at once asks for forces across the path, which the thesis' model drops.",
    equation=r"M\dot V + M\hat V V = F",
    source="Thesis eq (2.65) against section 6.1",
    signature="grows with yaw rate times speed; sideways forces in fast swivels",
    parameters=(Parameter("share", "1", 1.0, 0.0, 1.0, "of the term", off=0.0),),
    experiments=("swivel",),
    acts={Site.BODY: None},
    probes=({"share": 1.0},),
)
