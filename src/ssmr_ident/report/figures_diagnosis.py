"""Panels of a diagnosis that are drawn as lines: overlays, drift."""

from __future__ import annotations

import math

import numpy as np
from matplotlib.figure import Figure

from ssmr_ident.diagnose.evidence import Drift, Overlay
from ssmr_ident.report import style
from ssmr_ident.report.curves import busiest_part, thinned
from ssmr_ident.report.numbers import NONE, number, unit

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
