"""Panels of a diagnosis over turning speed: the waterfall of a swivel, and how far its levels are off."""

from __future__ import annotations

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from ssmr_ident.diagnose.evidence import SpeedMap
from ssmr_ident.report import style
from ssmr_ident.report.figures_diagnosis import PANEL, first_look
from ssmr_ident.report.figures_residual import from_paper

POWER = from_paper("power", style.BLUE)
WATERFALL_DB = 40.0
"""Range of a waterfall below its highest point."""
DASHES = ("--", ":", "-.", (0, (6, 1, 1, 1, 1, 1)))


@style.house
def waterfall_panel(speeds: SpeedMap, density: np.ndarray, title: str) -> Figure:
    """Power over turning speed and frequency, with the lines that candidate sources would draw.

    Parameters
    ----------
    speeds : SpeedMap
    density : (s, k) float [dB]
        ``recorded``, ``before`` or ``after``; all are drawn on the scale of ``recorded``.
    title : str
    """
    figure = style.new_figure(PANEL, 3.2)
    axes = figure.subplots()
    top = float(np.nanmax(speeds.recorded))
    bottom = max(top - WATERFALL_DB, float(np.nanquantile(speeds.recorded, 0.02)))
    turning = np.rad2deg(speeds.speed)
    image = axes.pcolormesh(
        _edges(turning), _edges(speeds.frequency), density.T, cmap=POWER, vmin=bottom, vmax=top,
        rasterized=True,
    )  # fmt: skip
    _candidates(axes, speeds, turning)
    bar = figure.colorbar(image, ax=axes, label="power [dB re 1 (m/s²)²/Hz]", pad=0.02)
    if bar.solids is not None:
        bar.solids.set_rasterized(True)
    axes.grid(visible=False)
    axes.set_xlabel("turning speed [°/s]")
    axes.set_ylabel("frequency [Hz]")
    axes.set_ylim(float(_edges(speeds.frequency)[0]), float(_edges(speeds.frequency)[-1]))
    axes.set_title(title, loc="left")
    return figure


def _candidates(axes: Axes, speeds: SpeedMap, turning: np.ndarray) -> None:
    highest = speeds.frequency[-1]
    for index, (name, course) in enumerate(speeds.lines):
        inside = np.where(course <= highest, course, np.nan)
        axes.plot(turning, inside, color=style.INK, lw=1.0, ls=DASHES[index % len(DASHES)], label=name)
    if speeds.lines:
        axes.legend(loc="upper left", bbox_to_anchor=(0, -0.2), ncols=1, borderaxespad=0, handlelength=2.4)


@style.house
def level_panel(speeds: SpeedMap, after: str) -> Figure:
    """How far the levels of recorded and simulated spectra are apart at each speed, RMS over the frequencies."""
    figure = style.new_figure(PANEL, 3.2)
    axes = figure.subplots()
    models = [(speeds.before, "o", *first_look(after))]
    if after:
        models.append((speeds.after, "s", style.BLUE, after))
    for density, marker, colour, label in models:
        apart = np.sqrt(np.nanmean((density - speeds.recorded) ** 2, axis=1))
        axes.plot(np.rad2deg(speeds.speed), apart, marker=marker, color=colour, label=label)
    axes.set_ylim(bottom=0)
    axes.set_xlabel("turning speed [°/s]")
    axes.set_ylabel("levels apart, RMS [dB]")
    axes.legend(loc="lower left", bbox_to_anchor=(0, 1), ncols=2, borderaxespad=0.1)
    return figure


def _edges(centres: np.ndarray) -> np.ndarray:
    """Limits of cells around centres, halfway between neighbours."""
    if len(centres) == 1:
        return np.array([centres[0] - 0.5, centres[0] + 0.5])
    middle = 0.5 * (centres[:-1] + centres[1:])
    return np.concatenate([[2 * centres[0] - middle[0]], middle, [2 * centres[-1] - middle[-1]]])
