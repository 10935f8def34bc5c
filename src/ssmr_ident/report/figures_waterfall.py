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
FEWEST_FOR_MAP = 5
"""Fewer speeds are drawn as lines: as a map they would be broad bands that nobody can compare."""


def many(speeds: SpeedMap) -> bool:
    """Whether there are enough speeds, each once, for a map."""
    return len(set(speeds.speed)) == len(speeds.speed) >= FEWEST_FOR_MAP


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
        _edges(turning), _edges(speeds.frequency), density.T, cmap=POWER, vmin=bottom, vmax=top, rasterized=True
    )
    for index, (name, course) in enumerate(speeds.lines):
        inside = np.where(course <= speeds.frequency[-1], course, np.nan)
        axes.plot(turning, inside, color=style.INK, lw=1.0, ls=DASHES[index % len(DASHES)], label=name)
    _name_lines(axes, speeds)
    bar = figure.colorbar(image, ax=axes, label="power [dB re 1 (m/s²)²/Hz]", pad=0.02)
    if bar.solids is not None:
        bar.solids.set_rasterized(True)
    axes.grid(visible=False)
    axes.set_xlabel("turning speed [°/s]")
    axes.set_ylabel("frequency [Hz]")
    edges = _edges(speeds.frequency)
    axes.set_ylim(float(edges[0]), float(edges[-1]))
    axes.set_title(title, loc="left")
    return figure


@style.house
def stacked_panel(speeds: SpeedMap, after: str) -> Figure:
    """Recorded and simulated spectra one above the other, slowest below, with the lines of candidate sources.

    Parameters
    ----------
    speeds : SpeedMap
    after : str
        Name of the model with physics added; empty leaves it out.
    """
    count = len(speeds.speed)
    figure = style.new_figure(PANEL, 1.0 + 0.75 * count)
    axes = figure.subplots()
    # One step holds nine tenths of the recorded levels, so that neighbours cross little.
    step = max(float(np.ptp(np.nanquantile(speeds.recorded, (0.05, 1.0)))), 10.0)
    ground = float(np.nanquantile(speeds.recorded, 0.05))
    looks = [(speeds.recorded, style.RAW, "recorded", 2.4), (speeds.before, *first_look(after), 0.9)]
    if after:
        looks.append((speeds.after, style.BLUE, after, 0.9))
    for density, colour, label, width in looks:
        for row in range(count):
            level = np.clip(density[row], ground - 0.2 * step, None) - ground + step * row
            axes.plot(speeds.frequency, level, color=colour, lw=width, label=None if row else label)
    for index, (name, course) in enumerate(speeds.lines):
        dash = DASHES[index % len(DASHES)]
        shown = np.where((course >= speeds.frequency[0]) & (course <= speeds.frequency[-1]), course, np.nan)
        if np.isnan(shown).all():
            continue
        for row in range(count):
            at = [float(shown[row])] * 2
            axes.plot(at, [step * row, step * (row + 0.95)], color=style.INK, lw=0.8, ls=dash)
        axes.plot([], [], color=style.INK, lw=0.8, ls=dash, label=name)
    axes.set_yticks(step * np.arange(count), [_row_label(speeds, row, bool(after)) for row in range(count)])
    axes.set_xlim(float(speeds.frequency[0]), float(speeds.frequency[-1]))
    axes.set_xlabel("frequency [Hz]")
    axes.set_title(f"{style.quantity_text(speeds.channel)}; one step is {step:.3g} dB", loc="left")
    figure.legend(loc="outside lower left", ncols=2, columnspacing=1)
    return figure


def _row_label(speeds: SpeedMap, row: int, added: bool) -> str:
    """Speed, what the spectrum is, and how far the models' levels are from it."""
    first = f"{np.rad2deg(speeds.speed[row]):.3g} °/s"
    first += f", {speeds.names[row]}" if speeds.names else ""
    apart = [f"{_apart(speeds, density)[row]:.1f}" for density in (speeds.before, speeds.after)[: 1 + added]]
    return f"{first}\n{' → '.join(apart)} dB apart"


def _apart(speeds: SpeedMap, density: np.ndarray) -> np.ndarray:
    """Difference in level from what was recorded, RMS over frequencies, (s,) [dB]."""
    return np.asarray(np.sqrt(np.nanmean((density - speeds.recorded) ** 2, axis=1)))


def _name_lines(axes: Axes, speeds: SpeedMap) -> None:
    if speeds.lines:
        axes.legend(loc="upper left", bbox_to_anchor=(0, -0.2), borderaxespad=0, handlelength=2.4)


@style.house
def level_panel(speeds: SpeedMap, after: str) -> Figure:
    """How far the levels of recorded and simulated spectra are apart at each speed, RMS over the frequencies."""
    figure = style.new_figure(PANEL, 3.2)
    axes = figure.subplots()
    models = [(speeds.before, "o", *first_look(after))]
    if after:
        models.append((speeds.after, "s", style.BLUE, after))
    for density, marker, colour, label in models:
        axes.plot(np.rad2deg(speeds.speed), _apart(speeds, density), marker=marker, color=colour, label=label)
    axes.set_ylim(bottom=0)
    axes.set_xlabel("turning speed [°/s]")
    axes.set_ylabel("levels apart, RMS [dB]")
    axes.set_title(style.quantity_text(speeds.channel), loc="right")
    axes.legend(loc="lower left", bbox_to_anchor=(0, 1), ncols=2, borderaxespad=0.1)
    return figure


def _edges(centres: np.ndarray) -> np.ndarray:
    """Limits of cells around centres, halfway between neighbours."""
    if len(centres) == 1:
        return np.array([centres[0] - 0.5, centres[0] + 0.5])
    middle = 0.5 * (centres[:-1] + centres[1:])
    return np.concatenate([[2 * centres[0] - middle[0]], middle, [2 * centres[-1] - middle[-1]]])
