"""A robot drawn from its parameters, from the side and from behind: what an answer is about stands in colour."""

from __future__ import annotations

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.patches import Circle, FancyBboxPatch, Rectangle

from ssmr_ident.physics.robot import Robot
from ssmr_ident.report import style

Array = np.ndarray

ACTS = {
    "nonlinear_stiffness": "tire", "dry_friction": "tire", "hysteresis": "tire", "quadratic_damping": "tire",
    "viscoelastic_relaxation": "tire", "free_play": "tire", "wheel_eccentricity": "tire", "rolling_resistance": "tire",
    "load_sensitive_friction": "floor", "stribeck": "floor", "slip_coupling": "floor", "wheel_lift": "floor",
    "ground_joints": "floor", "ground_roughness": "floor", "cable_compliance": "cable", "load_cell_drift": "cable",
    "motor_belt": "belt", "flexible_mast": "mast", "com_offset": "body", "translation_coupling": "body",
    "coriolis": "body", "sensor_saturation": "sensor", "sensor_bandwidth": "sensor", "sensor_delay": "sensor",
    "sensor_misalignment": "sensor",
}  # fmt: skip
"""The part of a robot at which each effect acts."""

NAMES = {"tire": "tires", "body": "body", "sensor": "accelerometer", "cable": "cable", "belt": "belt", "mast": "mast",
         "floor": "floor"}  # fmt: skip


def parts_of(effects: tuple[str, ...]) -> tuple[str, ...]:
    """Parts that are marked for effects by their ids, in their order."""
    return tuple(dict.fromkeys(ACTS[id] for id in effects if id in ACTS))


def robot_figure(robot: Robot, marked: tuple[str, ...]) -> Figure:
    """Both views to one scale.

    Parameters
    ----------
    robot : Robot
    marked : tuple of str
        Of ``NAMES``.
    """
    figure = Figure(figsize=(style.DOUBLE_COLUMN, 1.5))
    axes = figure.subplots(1, 2)
    for along, title, one in zip((0, 1), ("from the side", "from behind"), axes, strict=True):
        _view(one, robot, along, marked)
        one.set_title(title, fontsize=8, loc="left")
    figure.tight_layout()
    return figure


def _view(axes: Axes, robot: Robot, along: int, marked: tuple[str, ...]) -> None:
    def colour(part: str) -> str:
        return style.ORANGE if part in marked else style.INK

    place, height, r = robot.contact_points[:, along], robot.height, robot.radius or 0.5 * robot.height
    low, high = float(place.min()), float(place.max())
    reach = 0.5 * (high - low) + r
    axes.plot([low - 2.2 * r, high + 2.2 * r], [0.0, 0.0], color=colour("floor"), lw=1.8, solid_capstyle="butt")
    top = 2.0 * height - 0.8 * r
    axes.add_patch(
        FancyBboxPatch((low, 0.9 * r), high - low, max(top - 0.9 * r, 0.4 * r), boxstyle=f"round,pad={0.15 * r}",
                       fill=False, edgecolor=colour("body"), linewidth=1.3)
    )  # fmt: skip
    for x in np.unique(np.round(place, 3)):
        if along == 0:
            axes.add_patch(Circle((x, r), r, facecolor="white", edgecolor=colour("tire"), linewidth=1.6, zorder=3))
            axes.add_patch(Circle((x, r), 0.15 * r, facecolor=colour("tire"), edgecolor="none", zorder=4))
        else:
            wide = 0.6 * r
            axes.add_patch(
                Rectangle((x - 0.5 * wide, 0.0), wide, 2.0 * r, facecolor="white", edgecolor=colour("tire"),
                          linewidth=1.6, zorder=3)
            )  # fmt: skip
    if along == 0 and "belt" in marked:
        axes.plot([low, high], [r, r], color=style.ORANGE, lw=1.6, ls="--", zorder=5)
    if along == 0 and "cable" in marked:
        axes.plot([high + r, high + 2.2 * r], [height, height], color=style.ORANGE, lw=1.6)
    if "mast" in marked:
        axes.plot([0.0, 0.0], [max(top, r), max(top, r) + reach], color=style.ORANGE, lw=2.0)
    axes.plot([0.0], [height], marker="P", color=style.INK, ms=6, mec="white", zorder=6)
    sensor = robot.accelerometer.position
    axes.plot([sensor[along]], [height + sensor[2]], marker="s", color=colour("sensor"), ms=6, zorder=7)
    axes.set_aspect("equal")
    axes.set_axis_off()
