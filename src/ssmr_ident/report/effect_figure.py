"""What one left-out effect does to recordings: panels of curves, the baseline in grey and the effect in colour."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from ssmr_ident.report import style

LOWEST = 1e6
"""A logarithmic panel reaches no further below its highest point."""
_LOOKS: dict[str, Any] = {
    "line": {"lw": 1.0},
    "thin": {"lw": 0.6},
    "points": {"lw": 0.6, "marker": "o", "ms": 2.5},
}
_COLOURS = {"without": style.MEASURED, "with": style.ORANGE, "more": style.BLUE}


@dataclass(frozen=True, eq=False)
class Curve:
    """One line of a panel.

    Parameters
    ----------
    x, y : (n,) float
        In the units of the panel's axes.
    label : str
        "" keeps it out of the legend.
    role : str
        ``without`` the effect, ``with`` it, or ``more`` for a second line with it.
    look : str
        ``line``, ``thin`` or ``points``.
    """

    x: np.ndarray
    y: np.ndarray
    label: str = ""
    role: str = "with"
    look: str = "line"


@dataclass(frozen=True, eq=False)
class Panel:
    """One pair of axes.

    Parameters
    ----------
    title : str
        Which experiment, in words.
    x_label, y_label : str
        With units.
    curves : tuple of Curve
    logarithmic : bool
        The y axis.
    """

    title: str
    x_label: str
    y_label: str
    curves: tuple[Curve, ...]
    logarithmic: bool = False


@style.house
def effect_figure(heading: str, sentence: str, panels: Sequence[Panel]) -> Figure:
    """Draw the panels of one effect, two in a row.

    Parameters
    ----------
    heading : str
        The effect's id with its parameters.
    sentence : str
        What it is.
    panels : sequence of Panel

    Returns
    -------
    Figure
    """
    rows = math.ceil(len(panels) / 2)
    figure = style.new_figure(style.DOUBLE_COLUMN, 0.7 + 2.1 * rows)
    figure.suptitle(f"{heading}\n{sentence}", fontsize=8, x=0.01, ha="left")
    grid = figure.subplots(rows, min(2, len(panels)), squeeze=False).ravel()
    for index, axes in enumerate(grid):
        if index >= len(panels):
            axes.set_axis_off()
            continue
        _draw(axes, panels[index])
    return figure


def _draw(axes: Axes, panel: Panel) -> None:
    for curve in panel.curves:
        colour = _COLOURS[curve.role]
        axes.plot(curve.x, curve.y, color=colour, label=curve.label or None, **_LOOKS[curve.look])
    if panel.logarithmic:
        axes.set_yscale("log")
        top = max(float(curve.y.max()) for curve in panel.curves)
        lowest = min(float(curve.y.min()) for curve in panel.curves)
        axes.set_ylim(max(top / LOWEST, 0.5 * lowest), 3.0 * top)
    axes.set_title(panel.title, loc="left", color=style.INK)
    axes.set_xlabel(panel.x_label)
    axes.set_ylabel(panel.y_label)
    axes.margins(x=0.01, y=0.08)
    if any(curve.label for curve in panel.curves):
        axes.legend(loc="best", handlelength=1.4)
