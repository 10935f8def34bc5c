"""Sliding along x takes lateral grip away."""

from __future__ import annotations

from typing import TYPE_CHECKING

from ssmr_ident.core.parameter import Parameter
from ssmr_ident.physics.effect import Effect, Site

if TYPE_CHECKING:
    from ssmr_ident.physics.robot import Robot


def change(robot: Robot, weight: float, lambda_max: float) -> Robot:
    """Switch (4.10)-(4.12) on for a robot whose file has no lambda_max."""
    return robot.with_changes(slip_coupling=max(robot.slip_coupling, weight), lambda_max=lambda_max)


EFFECT = Effect(
    id="slip_coupling",
    sentence="A wheel that slips along its rolling direction loses its grip sideways.",
    equation=r"\mu_{ix} = \min(|\lambda_i|/\lambda_{max}, 1),\quad \mu_{iy} = \min(|\tan\theta_i|\mu_{ix}, 1)",
    source="Thesis eq (4.10)-(4.12)",
    signature="pulls get easier while the wheels spin; the robot turns slower than its wheels ask for",
    parameters=(
        Parameter("weight", "1", 1.0, 0.0, 1.0, "0 leaves both axes their full grip", off=0.0),
        Parameter("lambda_max", "1", 0.1, 1e-4, 1.0, "slip at which the grip along x is used up"),
    ),
    experiments=("pull", "swivel"),
    acts={Site.ROBOT: change},
    probes=({"weight": 1.0, "lambda_max": 0.1},),
    # with all of it a wheel that spins has no grip left, and from there nothing says how much it has
    spans={"weight": (0.05, 0.1, 0.2, 0.35, 0.5, 0.75), "lambda_max": (0.1,)},
)
