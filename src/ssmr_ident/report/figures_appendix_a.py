"""Peaks over yaw rate and over amplitude, every trial a dot (thesis appendix A)."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from matplotlib.figure import Figure

from ssmr_ident.report import style


@dataclass(frozen=True, eq=False)
class Trial:
    """One channel of one log.

    Parameters
    ----------
    channel, group : str
        Trials of one group share a colour.
    speed : float [deg/s]
        NaN where none is known.
    amplitude : float [m/s^2]
    printed, ours : (3,) float [Hz]
        Peaks of the low-passed signal, and of the samples as logged.
    """

    channel: str
    group: str
    speed: float
    amplitude: float
    printed: np.ndarray
    ours: np.ndarray


@style.house
def trials_figure(trials: Sequence[Trial], speed_label: str) -> Figure:
    """Three peaks over the yaw rate, where there is one, and the highest over the amplitude; a column per channel.

    Filled dots are the thesis' (filtered first), rings ours; the largest dot is the highest peak.
    """
    channels = list(dict.fromkeys(trial.channel for trial in trials))
    groups = list(dict.fromkeys(trial.group for trial in trials))
    rows = 2 if speed_label else 1
    figure = style.new_figure(max(style.SINGLE_COLUMN, 2.4 * len(channels)), 2.4 * rows + 0.5)
    grid = figure.subplots(rows, len(channels), squeeze=False, sharey=True)
    for column, channel in zip(grid.T, channels, strict=True):
        for number, group in enumerate(groups):
            colour = style.SERIES[number % len(style.SERIES)]
            own = [trial for trial in trials if trial.channel == channel and trial.group == group]
            for trial in own:
                if speed_label:
                    sizes, places = np.array([18.0, 10.0, 5.0]), np.full(3, trial.speed)
                    column[0].scatter(places, trial.printed, s=sizes, color=colour, lw=0)
                    column[0].scatter(places, trial.ours, s=2 * sizes, facecolors="none", edgecolors=colour, lw=0.5)
                column[-1].scatter(trial.amplitude, trial.printed[0], s=18.0, color=colour, lw=0)
                column[-1].scatter(trial.amplitude, trial.ours[0], s=36.0, facecolors="none", edgecolors=colour, lw=0.5)
        column[0].set_title(style.quantity_text(channel))
        if speed_label:
            column[0].set_xlabel(speed_label)
        column[-1].set_xlabel("(max − min)/2 [m/s²]")
        column[-1].set_xlim(left=0)
    for axes, label in zip(grid[:, 0], ["peaks [Hz]", "highest peak [Hz]"][-rows:], strict=True):
        axes.set_ylabel(label)
        axes.set_ylim(bottom=0)
    first = grid[0, 0]
    handles = [
        first.scatter([], [], s=18.0, color=style.SERIES[number % len(style.SERIES)], lw=0)
        for number in range(len(groups))
    ]
    handles += [
        first.scatter([], [], s=18.0, color=style.INK, lw=0),
        first.scatter([], [], s=36.0, facecolors="none", edgecolors=style.INK, lw=0.5),
    ]
    figure.legend(
        handles, [*groups, "thesis: low-passed first", "ours: as logged"], loc="outside lower center", ncols=3
    )
    return figure
