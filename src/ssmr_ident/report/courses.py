"""A recording as it was measured: one panel per channel over time."""

from __future__ import annotations

import numpy as np
from matplotlib.figure import Figure

from ssmr_ident.core.recording import Recording
from ssmr_ident.report import style
from ssmr_ident.report.curves import thinned


@style.house
def courses_figure(recording: Recording, title: str = "") -> Figure:
    """Every channel over time, in the recording's own units.

    Parameters
    ----------
    recording : Recording
    title : str
        Empty takes the file's name.
    """
    figure = style.new_figure(style.DOUBLE_COLUMN, 0.6 + 1.3 * len(recording.channels))
    panels = np.atleast_1d(np.asarray(figure.subplots(len(recording.channels), 1, sharex=True)))
    for axes, channel in zip(panels, recording.channels, strict=True):
        axes.plot(*thinned(recording.time, channel.samples), color=style.BLUE, lw=0.7)
        axes.set_ylabel(style.axis_text(channel.name, channel.unit))
    panels[0].set_title(style.name_text(title or recording.provenance.file), loc="left")
    panels[-1].set_xlabel("time [s]")
    return figure
