"""Swivels: average peaks and amplitudes over the turning speed (thesis appendix B, figures 6.10–6.24)."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from ssmr_ident.report import style

RANKS = ("highest peak", "second", "third")


@dataclass(frozen=True, eq=False)
class SpeedAverage:
    """Repeats of one configuration, speed and channel, averaged.

    Parameters
    ----------
    configuration : str
        Floor and frame, as printed.
    channel, unit : str
    speed : float
        In the unit of the speed axis.
    peak_hz : (r, 3) float [Hz]
        Of each repeat, highest first; NaN where a repeat has fewer peaks.
    peak_amplitude : (r, 3) float [unit]
    amplitude : (r,) float [unit]
        (max − min)/2 of each repeat.
    """

    configuration: str
    channel: str
    unit: str
    speed: float
    peak_hz: np.ndarray
    peak_amplitude: np.ndarray
    amplitude: np.ndarray

    @property
    def repeats(self) -> int:
        return len(self.amplitude)


def mean_and_spread(values: np.ndarray) -> tuple[float, float]:
    """Mean and standard deviation (n − 1) of the values that exist; NaN where there are too few.

    >>> mean_and_spread(np.array([1.0, 3.0, np.nan]))
    (2.0, 1.4142135623730951)
    """
    known = values[np.isfinite(values)]
    mean = float(np.mean(known)) if len(known) else float("nan")
    return mean, float(np.std(known, ddof=1)) if len(known) > 1 else float("nan")


@style.house
def peaks_figure(configuration: str, averages: Sequence[SpeedAverage], speed_label: str) -> Figure:
    """One configuration: frequency and height of the three peaks, and the amplitude of the log, per channel.

    Parameters
    ----------
    configuration : str
    averages : sequence of SpeedAverage
        Of this configuration.
    speed_label : str
        With its unit.
    """
    channels = list(dict.fromkeys(a.channel for a in averages))
    figure = style.new_figure(max(style.SINGLE_COLUMN, 2.27 * len(channels) + 0.4), 5.6)
    grid = figure.subplots(3, len(channels), squeeze=False, sharex=True, sharey="row")
    for column, channel in zip(grid.T, channels, strict=True):
        own = sorted((a for a in averages if a.channel == channel), key=lambda a: a.speed)
        for rank, name in enumerate(RANKS):
            look = _Look(style.SERIES[rank], style.MARKERS[rank], name, 0.012 * (rank - 1))
            _series(column[0], own, [a.peak_hz[:, rank] for a in own], look, joined=False)
            _series(column[1], own, [a.peak_amplitude[:, rank] for a in own], look, joined=True)
        _series(column[2], own, [a.amplitude for a in own], _Look(style.INK, "o"))
        column[0].set_title(style.quantity_text(channel))
        column[2].set_xlabel(speed_label)
    unit = style.unit_text(averages[0].unit)
    for axes, label in zip(
        grid[:, 0],
        ("peak frequency [Hz]", f"height of the peak [{unit}]", f"(max − min)/2 [{unit}]"),
        strict=True,
    ):
        axes.set_ylabel(label)
    for axes in grid.flat:
        axes.set_ylim(bottom=0)
        axes.set_xlim(left=0)
    figure.align_ylabels(grid[:, 0])
    handles, labels = grid[0][0].get_legend_handles_labels()
    repeats = sorted({a.repeats for a in averages})
    counted = f"{repeats[0]}" if len(repeats) == 1 else f"{repeats[0]} to {repeats[-1]}"
    note = "; bars: standard deviation, dots: single logs" if repeats[-1] > 1 else ""
    counted += " log per speed" if repeats[-1] == 1 else " logs per speed"
    figure.suptitle(f"{style.name_text(configuration)}: {counted}{note}", fontsize=8, x=0.01, ha="left")
    figure.legend(handles, labels, loc="outside lower center", ncols=3)
    return figure


@style.house
def amplitude_figure(averages: Sequence[SpeedAverage], speed_label: str) -> Figure:
    """All configurations: the amplitude of the log over the speed, one panel per channel."""
    channels = list(dict.fromkeys(a.channel for a in averages))
    configurations = list(dict.fromkeys(a.configuration for a in averages))
    figure = style.new_figure(max(style.SINGLE_COLUMN, 2.27 * len(channels) + 0.4), 2.7)
    grid = figure.subplots(1, len(channels), squeeze=False, sharey=True)[0]
    for axes, channel in zip(grid, channels, strict=True):
        for index, configuration in enumerate(configurations):
            own = [a for a in averages if a.channel == channel and a.configuration == configuration]
            own.sort(key=lambda a: a.speed)
            look = _Look(
                style.SERIES[index % len(style.SERIES)],
                # Beyond six configurations colours come again, with another marker.
                style.MARKERS[(index + index // len(style.SERIES)) % len(style.MARKERS)],
                configuration,
                0.012 * (index - (len(configurations) - 1) / 2),
            )
            _series(axes, own, [a.amplitude for a in own], look)
        axes.set_title(style.quantity_text(channel))
        axes.set_xlabel(speed_label)
    # Axes are shared: limits are set once everything is drawn.
    grid[0].set_ylim(bottom=0)
    for axes in grid:
        axes.set_xlim(left=0)
    grid[0].set_ylabel(f"(max − min)/2 [{style.unit_text(averages[0].unit)}]")
    handles, labels = grid[0].get_legend_handles_labels()
    figure.legend(handles, labels, loc="outside lower center", ncols=min(len(labels), 4))
    return figure


@dataclass(frozen=True)
class _Look:
    """Colour, marker and name of a series, s speeds."""

    color: str
    marker: str
    label: str | None = None
    aside: float = 0.0


def _series(
    axes: Axes,
    averages: Sequence[SpeedAverage],
    values: Sequence[np.ndarray],
    look: _Look,
    *,
    joined: bool = True,
) -> None:
    """Means with bars over the speed; single repeats as small dots where there is more than one."""
    speeds = np.array([a.speed for a in averages])
    means, spreads = np.array([mean_and_spread(v) for v in values]).reshape(-1, 2).T
    shifted = speeds + look.aside * speeds.max()
    axes.errorbar(
        shifted,
        means,
        yerr=np.nan_to_num(spreads),
        color=look.color,
        marker=look.marker,
        ls="-" if joined else "none",
        lw=0.8,
        ms=4.5,
        mec="white",
        mew=0.4,
        elinewidth=0.8,
        capsize=2,
        label=look.label,
        zorder=3,
    )
    for speed, repeats in zip(shifted, values, strict=True):
        if len(repeats) > 1:
            where = np.full(len(repeats), speed)
            axes.plot(where, repeats, ".", color=look.color, ms=2.5, alpha=0.6, zorder=2)
