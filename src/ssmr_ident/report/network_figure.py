"""A network drawn: ground, bodies and the springs between them, what an answer is about in colour."""

from __future__ import annotations

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from ssmr_ident.physics.network import Layout
from ssmr_ident.report import style

COILS, SWING = 5, 0.09
"""Of a spring, and how far these go to either side where bodies stand 1 apart."""


def network_figure(layout: Layout, marked: tuple[str, ...] = ()) -> Figure:
    """Bodies from left to right by how many springs they are away from the ground.

    Parameters
    ----------
    layout : Layout
    marked : tuple of str
        Bodies and springs that are drawn in colour.
    """
    places = _places(layout)
    rows = max(y for _, y in places.values()) - min(y for _, y in places.values())
    longest = max(x for x, _ in places.values())
    figure = Figure(figsize=(min(1.3 * (longest + 1.0), style.DOUBLE_COLUMN), 1.1 * (rows + 1.0)))
    axes = figure.add_axes((0.02, 0.02, 0.96, 0.96))
    for spring, (first, second) in zip(layout.springs, layout.ends, strict=True):
        colour = style.ORANGE if spring in marked else style.INK
        start, end = (np.array(places[k] if k >= 0 else (0.0, places[max(first, second)][1])) for k in (first, second))
        alike = [s for s, e in zip(layout.springs, layout.ends, strict=True) if set(e) == {first, second}]
        _spring(axes, start, end, spring, colour, (alike.index(spring) - 0.5 * (len(alike) - 1)) * 0.3)
    for number, name in enumerate(layout.bodies):
        x, y = places[number]
        colour = style.ORANGE if name in marked else style.INK
        box = {"boxstyle": "square,pad=0.5", "facecolor": "white", "edgecolor": colour, "linewidth": 1.4}
        axes.text(x, y, name, ha="center", va="center", fontsize=8, color=colour, bbox=box, zorder=3)
    low, high = (f(y for _, y in places.values()) for f in (min, max))
    if layout.grounded:
        axes.plot([0.0, 0.0], [low - 0.45, high + 0.45], color=style.INK, lw=2.0)
        for y in np.arange(low - 0.45, high + 0.4, 0.12):
            axes.plot([-0.1, 0.0], [y, y + 0.1], color=style.INK, lw=0.7)
    axes.set(xlim=(-0.2, longest + 0.55), ylim=(low - 0.55, high + 0.55))
    axes.set_axis_off()
    return figure


def _spring(axes: Axes, first: np.ndarray, second: np.ndarray, name: str, colour: str, aside: float) -> None:
    """A zigzag from one place to the other, ``aside`` of the straight line where several join the same two."""
    along = second - first
    across = np.array([-along[1], along[0]]) / np.hypot(*along)
    share = np.linspace(0.3, 0.72, 2 * COILS + 2)
    swing = np.array([0.0, *([SWING, -SWING] * COILS), 0.0])
    path = first + np.outer(share, along) + np.outer(swing + aside, across)
    path = np.vstack([first + aside * across, path, second + aside * across])
    axes.plot(path[:, 0], path[:, 1], color=colour, lw=1.2, zorder=1)
    at = first + 0.51 * along + (aside + 0.2) * across
    axes.text(float(at[0]), float(at[1]), name, ha="center", va="center", fontsize=7, color=colour)


def _places(layout: Layout) -> dict[int, tuple[float, float]]:
    """Where each body stands: springs away from the ground (or from the first body), then one below the other."""
    away = {-1: 0} if layout.grounded else {0: 1}
    while len(away) < len(layout.bodies) + int(layout.grounded):
        near = {end: d + 1 for ends in layout.ends for at, d in away.items() if at in ends for end in ends}
        away |= {end: d for end, d in near.items() if end not in away}
    found: dict[int, tuple[float, float]] = {}
    for number in range(len(layout.bodies)):
        column = [k for k in range(len(layout.bodies)) if away[k] == away[number]]
        found[number] = (float(away[number]), 0.5 * (len(column) - 1) - column.index(number))
    return found
