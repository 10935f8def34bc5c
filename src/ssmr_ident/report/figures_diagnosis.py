"""Panels of a diagnosis that are drawn as lines and bars: overlays, explanations tried, parameters moved, drift."""

from __future__ import annotations

import math
from collections.abc import Collection, Sequence

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from ssmr_ident.diagnose.diagnosis import Conflict, Tried
from ssmr_ident.diagnose.evidence import Drift, Overlay
from ssmr_ident.report import style
from ssmr_ident.report.curves import busiest_part, thinned
from ssmr_ident.report.numbers import NONE, alike, number, unit

PANEL = 3.9
"""Width [inch] of one panel: readable over a phone's whole width and as one of two columns."""
CYCLES = 24
"""So many swings can be told apart in one panel."""


def readable(id: str) -> str:
    """An id as words.

    >>> readable("dry_friction+free_play"), readable("baseline")
    ('dry friction + free play', 'baseline, nothing added')
    """
    return "baseline, nothing added" if id == "baseline" else id.replace("_", " ").replace("+", " + ")


def evidence_text(value: float) -> str:
    """A log evidence as printed: tenths matter near zero, never for thousands.

    >>> evidence_text(8.013), evidence_text(-5228.4)
    ('8.0', '−5228')
    """
    if not math.isfinite(value):
        return number(value)
    return f"{value:.{1 if abs(value) < 100 else 0}f}".replace("-", "−")


def first_look(after: str) -> tuple[str, str]:
    """Colour and name of the baseline: blue is the answer's colour, so it is blue where it is the answer."""
    return (style.ORANGE, "model before") if after else (style.BLUE, "model")


@style.house
def overlay_panel(overlay: Overlay, after: str) -> Figure:
    """Recorded and simulated above, what is left over below; of a long recording the part that differs most.

    Parameters
    ----------
    overlay : Overlay
    after : str
        Name of the model with physics added; empty draws the model once.
    """
    figure = style.new_figure(PANEL, 3.0)
    above, below = figure.subplots(2, 1, sharex=True, height_ratios=(2, 1))
    matter = overlay.measured - (overlay.before if after else overlay.measured.mean())
    part = busiest_part(overlay.measured, matter, CYCLES)
    time, recorded = overlay.time[part], overlay.measured[part]
    models = [(overlay.before[part], *first_look(after))]
    if after:
        models.append((overlay.after[part], style.BLUE, after))
    above.plot(*thinned(time, recorded), color=style.RAW, lw=2.6, label="recorded")
    for course, colour, label in models:
        above.plot(*thinned(time, course), color=colour, lw=0.9, label=label)
        below.plot(*thinned(time, recorded - course), color=colour, lw=0.7)
    below.set_xlabel("time [s]")
    printed = unit(overlay.unit) or NONE
    above.set_ylabel(f"{style.quantity_text(overlay.channel)} [{printed}]")
    below.set_ylabel(f"left over [{printed}]")
    above.set_xlim(time[0], time[-1])
    above.legend(loc="lower left", bbox_to_anchor=(0, 1), ncols=3, borderaxespad=0.1, handlelength=1.4, columnspacing=1)
    above.set_title(style.name_text(overlay.recording), loc="left", pad=14)
    figure.align_ylabels()
    return figure


@style.house
def evidence_panel(tried: Sequence[Tried], chosen: str, tied: Collection[str]) -> Figure:
    """Bars of log evidence, the baseline being 0.

    Parameters
    ----------
    tried : sequence of Tried
        Drawn from above in this order.
    chosen : str
        Its bar is blue.
    tied : collection of str
        Their bars are light blue.
    """
    figure = style.new_figure(PANEL, 0.75 + 0.24 * len(tried))
    axes = figure.subplots()
    values = [t.log_evidence for t in tried]
    _bars(axes, tried, values, [evidence_text(v) for v in values], chosen, tied)
    axes.axvline(0, color=style.INK, lw=0.6)
    axes.set_xlabel("log evidence above the baseline's [–]")
    return figure


@style.house
def metric_panel(tried: Sequence[Tried], chosen: str, tied: Collection[str], floor: float, unit_name: str) -> Figure:
    """Bars of the distance on held-out recordings, with the noise floor as a dashed line."""
    figure = style.new_figure(PANEL, 0.75 + 0.24 * len(tried))
    axes = figure.subplots()
    values = [t.heldout_metric for t in tried]
    _bars(axes, tried, values, alike(values), chosen, tied)
    axes.axvline(floor, color=style.INK, lw=0.9, ls="--")
    axes.set_xlabel(f"distance from held-out recordings [{unit_name}]")
    return figure


def _bars(
    axes: Axes,
    tried: Sequence[Tried],
    values: Sequence[float],
    texts: Sequence[str],
    chosen: str,
    tied: Collection[str],
) -> None:
    rows = np.arange(len(tried))
    colours = [style.BLUE if t.id == chosen else style.SKY if t.id in tied else style.RAW for t in tried]
    known = np.nan_to_num(np.asarray(values, float), posinf=0.0, neginf=0.0)
    bars = axes.barh(rows, known, color=colours, height=0.7)
    axes.bar_label(bars, texts, padding=2, fontsize=7)
    axes.set_yticks(rows, [readable(t.id) for t in tried])
    axes.invert_yaxis()
    axes.grid(visible=False, axis="y")
    low, high = min(0.0, known.min()), max(0.0, known.max())
    room = 0.22 * ((high - low) or 1.0)  # for the numbers at the bars' ends
    axes.set_xlim(low - (room if low < 0 else 0), high + room)


@style.house
def moved_panel(conflicts: Sequence[Conflict], after: Sequence[float | None], name: str) -> Figure:
    """How far each parameter was pulled from what is known of it, in standard deviations of that knowledge.

    Parameters
    ----------
    conflicts : sequence of Conflict
    after : sequence of float or None
        The same with physics added; None where there is nothing to compare.
    name : str
        Of the model with physics added.
    """
    figure = style.new_figure(PANEL, 0.95 + 0.3 * len(conflicts))
    axes = figure.subplots()
    rows = np.arange(len(conflicts))
    largest = max((abs(c.sigmas) for c in conflicts if math.isfinite(c.sigmas)), default=3.0)
    axes.axvspan(-2, 2, color=style.SHADE, lw=0, zorder=0)
    colour, label = first_look(name)
    axes.barh(
        rows,
        [float(np.clip(c.sigmas, -1.25 * largest, 1.25 * largest)) for c in conflicts],
        color=colour,
        height=0.5,
        label=label,
    )
    known = [(row, value) for row, value in zip(rows, after, strict=True) if value is not None]
    if known:
        where, values = zip(*known, strict=True)
        axes.plot(values, where, "o", color=style.BLUE, ms=5, label=name)
    if largest > 30:  # small ones would vanish beside it
        axes.set_xscale("symlog", linthresh=3, linscale=1)
        steps = [step for step in (3, 30, 300, 3000) if step <= 2 * largest]
        steps = [*(-s for s in reversed(steps)), 0, *steps]
        axes.set_xticks(steps, [number(s) for s in steps])
        axes.minorticks_off()
    reach = 1.25 * max([largest, 3.0, *(abs(v) for v in after if v is not None)])
    low = any(c.sigmas < 0 for c in conflicts) or any(v is not None and v < -2 for v in after)
    high = any(c.sigmas > 0 for c in conflicts) or any(v is not None and v > 2 for v in after)
    axes.set_xlim(-reach if low else -3, reach if high else 3)
    axes.axvline(0, color=style.INK, lw=0.6)
    axes.set_yticks(rows, [c.parameter for c in conflicts])
    axes.invert_yaxis()
    axes.grid(visible=False, axis="y")
    axes.set_xlabel("moved by [std of what was known]")
    axes.legend(loc="lower right", bbox_to_anchor=(1, 1), ncols=2, borderaxespad=0.1, columnspacing=1)
    return figure


@style.house
def drift_panel(drift: Drift) -> Figure:
    """A baseline parameter refitted in parts of the data: level when the model is right, sloped when it is not."""
    figure = style.new_figure(PANEL, 2.3)
    axes = figure.subplots()
    axes.axhline(1, color=style.INK, lw=0.9, ls="--")
    axes.errorbar(
        drift.position, drift.value, 1.96 * np.asarray(drift.std), color=style.ORANGE, marker="o", ls="none", capsize=2,
        elinewidth=0.8,
    )  # fmt: skip
    axes.set_xlabel(f"{drift.along} [{unit(drift.unit) or NONE}]")
    if set(drift.position) <= {-1.0, 1.0}:  # two sides, no scale
        axes.set_xticks([-1, 1], ["−", "+"])
    axes.set_ylabel("relative to the whole fit [–]")
    axes.set_title(f"{drift.parameter}   p = {number(drift.p_value, 2)}", loc="left")
    axes.margins(x=0.06, y=0.12)
    return figure
