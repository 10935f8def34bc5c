"""Joints between tiles: grooves at equal distances along the path of every wheel."""

from __future__ import annotations

import math

from ssmr_ident.core.kernel import kernel
from ssmr_ident.core.parameter import Parameter
from ssmr_ident.physics.effect import Effect, Site


@kernel
def height(path, pitch, depth, width):
    """Height of the floor [m] after ``path`` [m]: grooves of ``depth``, ``width`` wide, ``pitch`` apart [m]."""
    away = path - pitch * (math.floor(path / pitch) + 0.5)  # the start lies between two joints
    sigma = 0.25 * width  # the groove is seen as wide as four standard deviations
    return -depth * math.exp(-0.5 * (away / sigma) ** 2)


@kernel
def slope(path, pitch, depth, width):
    """d(height)/d(path)."""
    away = path - pitch * (math.floor(path / pitch) + 0.5)  # the start lies between two joints
    sigma = 0.25 * width
    return depth * away / (sigma * sigma) * math.exp(-0.5 * (away / sigma) ** 2)


EFFECT = Effect(
    id="ground_joints",
    sentence="The wheels run over joints between tiles, one after the other at equal distances.",
    equation=r"h(\xi) = -d \sum_j e^{-(\xi - (j + 1/2) p)^2/2\sigma^2}",
    source="Own formula: Gaussian grooves",
    signature="a line in the spectrum at path speed over joint distance, with harmonics, rising with speed",
    parameters=(
        Parameter("depth_m", "m", 2e-4, 0.0, 0.02, "of a groove", off=0.0),
        Parameter("pitch_m", "m", 0.05, 2e-3, 2.0, "distance between joints along the path"),
        Parameter("width_m", "m", 6e-3, 1e-3, 0.1, "of a groove"),
    ),
    experiments=("swivel", "straight"),
    acts={Site.GROUND: height},
)
