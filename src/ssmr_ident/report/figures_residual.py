"""Panels of a diagnosis that are drawn as surfaces: residual over time and frequency, force surface."""

from __future__ import annotations

import numpy as np
from matplotlib.colors import LinearSegmentedColormap, TwoSlopeNorm, to_rgba
from matplotlib.figure import Figure

from ssmr_ident.diagnose.evidence import ForceSurface, ResidualMap
from ssmr_ident.report import style
from ssmr_ident.report.figures_diagnosis import PANEL, first_look
from ssmr_ident.report.numbers import NONE, unit


def from_paper(name: str, colour: str) -> LinearSegmentedColormap:
    """From nothing to a colour: the paper shows through, so that it reads on white and on black."""
    return LinearSegmentedColormap.from_list(name, [to_rgba(colour, 0.0), to_rgba(colour, 1.0)])


_ENDS = ((0.0, style.BLUE, 1.0), (0.5, style.BLUE, 0.0), (0.5, style.ORANGE, 0.0), (1.0, style.ORANGE, 1.0))
EITHER_SIGN = LinearSegmentedColormap.from_list(
    "either sign", [(at, to_rgba(colour, opaque)) for at, colour, opaque in _ENDS]
)


@style.house
def residual_map_panel(residual: ResidualMap, power: np.ndarray, title: str) -> Figure:
    """Power of what is left over, above noise alone; a line goes round what noise makes once in 100 maps.

    Parameters
    ----------
    residual : ResidualMap
    power : (k, m) float [dB]
        ``residual.before`` or ``residual.after``; both are drawn on the scale of ``before``.
    title : str
    """
    figure = style.new_figure(PANEL, 2.6)
    axes = figure.subplots()
    top = max(float(np.nanmax(residual.before)), 1.5 * residual.threshold_db)
    image = axes.pcolormesh(
        residual.time,
        residual.frequency,
        power,
        cmap=_pale_to(residual.threshold_db / top),
        vmin=0.0,
        vmax=top,
        shading="nearest",
        rasterized=True,
    )
    if min(power.shape) > 1 and np.nanmax(power) > residual.threshold_db > np.nanmin(power):
        axes.contour(
            residual.time, residual.frequency, power, [residual.threshold_db], colors=style.INK, linewidths=0.8
        )
    bar = figure.colorbar(image, ax=axes, label="above noise alone [dB]", pad=0.02)
    if bar.solids is not None:
        bar.solids.set_rasterized(True)
    bar.ax.axhline(residual.threshold_db, color=style.INK, lw=1.0)
    axes.grid(visible=False)
    axes.set_xlabel("time [s]")
    axes.set_ylabel("frequency [Hz]")
    axes.set_title(title, loc="left")
    return figure


FEWEST = 3
"""Cells with fewer points count as never reached."""


def _pale_to(step: float) -> LinearSegmentedColormap:
    """Orange, pale below a share of the scale and full above: what may be noise shall not catch the eye."""
    points = ((0.0, 0.0), (step, 0.2), (step, 0.5), (1.0, 1.0))
    return LinearSegmentedColormap.from_list(
        "left over", [(at, to_rgba(style.ORANGE, opaque)) for at, opaque in points]
    )


@style.house
def surface_panel(surface: ForceSurface, force: np.ndarray, title: str, cells: int = 17) -> Figure:
    """Mean residual force in cells of displacement and velocity; grey where the motion never came.

    Parameters
    ----------
    surface : ForceSurface
    force : (n,) float
        ``surface.before`` or ``surface.after``; both are drawn on the scale of ``before``.
    title : str
    cells : int
        Along each side.
    """
    (across, across_unit), (along, along_unit) = _scaled(surface)
    edges = [np.linspace(*_reach(values), cells + 1) for values in (across, along)]
    counted = np.histogram2d(across, along, edges)[0]
    counted[counted < min(FEWEST, counted.max())] = 0
    both = []
    for values in (surface.before, force):
        with np.errstate(invalid="ignore"):
            both.append(np.histogram2d(across, along, edges, weights=values)[0] / np.where(counted, counted, np.nan))
    # Pure noise shall look pale, so the scale reaches at least three times its spread.
    top = max(float(np.nanmax(np.abs(both[0]))), 3 * float(np.std(surface.after))) or 1.0
    figure = style.new_figure(PANEL, 2.8)
    axes = figure.subplots()
    axes.set_facecolor(style.SHADE)
    axes.grid(visible=False)
    visited = np.ma.masked_equal(np.where(counted > 0, 1.0, 0.0), 0.0).T
    axes.pcolormesh(*edges, visited, cmap=LinearSegmentedColormap.from_list("paper", ["#ffffff", "#ffffff"]))
    image = axes.pcolormesh(
        *edges, np.ma.masked_invalid(both[1]).T, cmap=EITHER_SIGN, norm=TwoSlopeNorm(0.0, -top, top), rasterized=True
    )
    bar = figure.colorbar(image, ax=axes, label=f"unexplained force [{unit(surface.units[2]) or NONE}]", pad=0.02)
    if bar.solids is not None:
        bar.solids.set_rasterized(True)
    axes.set_xlabel(f"displacement [{across_unit}]")
    axes.set_ylabel(f"velocity [{along_unit}]")
    axes.set_title(title, loc="left")
    return figure


@style.house
def cut_panel(surface: ForceSurface, over: str, after: str, bins: int = 15) -> Figure:
    """Median unexplained force over displacement or velocity, with the middle 80 % of its values shaded.

    Parameters
    ----------
    surface : ForceSurface
    over : {"displacement", "velocity"}
    after : str
        Name of the model with physics added; empty leaves it out.
    bins : int
    """
    values, name = _scaled(surface)[0 if over == "displacement" else 1]
    edges = np.linspace(*_reach(values), bins + 1)
    place = np.clip(np.digitize(values, edges) - 1, 0, bins - 1)
    filled = [k for k in range(bins) if np.count_nonzero(place == k) >= 5]
    centres = 0.5 * (edges[:-1] + edges[1:])[filled]
    figure = style.new_figure(PANEL, 2.5)
    axes = figure.subplots()
    lines = [(surface.before, *first_look(after))]
    if after:
        lines.append((surface.after, style.BLUE, after))
    for force, colour, label in lines:
        if len(filled) < 3:
            axes.plot(values, force, ".", color=colour, ms=3, label=label)
            continue
        low, middle, high = np.array([np.quantile(force[place == k], (0.1, 0.5, 0.9)) for k in filled]).T
        axes.fill_between(centres, low, high, color=colour, alpha=0.2, lw=0)
        axes.plot(centres, middle, "o-", color=colour, ms=3, label=label)
    axes.axhline(0, color=style.INK, lw=0.6)
    axes.set_xlabel(f"{over} [{name}]")
    axes.set_ylabel(f"unexplained force [{unit(surface.units[2]) or NONE}]")
    axes.legend(loc="lower left", bbox_to_anchor=(0, 1), ncols=2, borderaxespad=0.1)
    return figure


def _scaled(surface: ForceSurface) -> tuple[tuple[np.ndarray, str], tuple[np.ndarray, str]]:
    """Displacement and velocity with their units, in thousandths where they are small."""
    scaled = []
    for values, name in zip((surface.displacement, surface.velocity), surface.units, strict=False):
        small = name.startswith(("m", "rad")) and float(np.max(np.abs(values))) < 0.2
        scaled.append((1e3 * values, f"m{unit(name)}") if small else (values, unit(name) or NONE))
    return scaled[0], scaled[1]


def _reach(values: np.ndarray) -> tuple[float, float]:
    """Lowest and highest, without the outermost hundredth: single points would stretch the picture."""
    outside = 0.005 if len(values) > 1000 else 0.0
    low, high = np.quantile(values, (outside, 1 - outside))
    return (float(low), float(high)) if high > low else (float(low) - 0.5, float(high) + 0.5)
