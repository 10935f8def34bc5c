"""A sweep of the simulator: spectra, peaks and amplitudes over the swept value (thesis appendix C)."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from matplotlib.axes import Axes
from matplotlib.colors import LogNorm
from matplotlib.figure import Figure

from ssmr_ident.report import style
from ssmr_ident.report.figures_residual import from_paper
from ssmr_ident.report.figures_speed import RANKS

DECADES = 1.7
"""From this spread on, values that are all above 0 go on a logarithmic axis."""
DEPTH = 300.0
"""A map of spectra reaches this far below its highest line."""
MOST_NAMED = 24
CELL_HZ = 0.25
_HEIGHT = from_paper("height", style.BLUE)


@dataclass(frozen=True, eq=False)
class SweptRun:
    """One run of a sweep as it is drawn.

    Parameters
    ----------
    value : float or str
        Of the first axis.
    group : str
        Values of the others, in words; empty where there are none.
    peak_hz, peak_amplitude : (3, 3) float [Hz, m/s^2]
        Of ax, ay, az, highest first; NaN where there are fewer.
    amplitude : (3,) float [m/s^2]
    frequency : (k,) float [Hz]
    spectrum : (3, k) float [m/s^2]
    """

    value: float | str
    group: str
    peak_hz: np.ndarray
    peak_amplitude: np.ndarray
    amplitude: np.ndarray
    frequency: np.ndarray
    spectrum: np.ndarray


CHANNELS = ("ax", "ay", "az")


@style.house
def spectra_figure(runs: Sequence[SweptRun], label: str) -> Figure:
    """Amplitude spectra of all runs, one strip each, in the order of the sweep."""
    figure = style.new_figure(style.DOUBLE_COLUMN, max(2.6, 0.16 * len(runs) + 1.2))
    grid = figure.subplots(1, 3, sharey=True)
    top = max(float(run.spectrum[:, run.frequency >= 1.0].max()) for run in runs)
    for index, (axes, channel) in enumerate(zip(grid, CHANNELS, strict=True)):
        for row, run in enumerate(runs):
            edges, strip = _strip(run.frequency, run.spectrum[index])
            image = axes.pcolormesh(
                edges, [row - 0.5, row + 0.5], strip[None], cmap=_HEIGHT, norm=LogNorm(top / DEPTH, top),
                rasterized=True,
            )  # fmt: skip
        axes.set_title(style.quantity_text(channel))
        axes.set_xlabel("frequency [Hz]")
        axes.grid(visible=False)
    named = range(0, len(runs), -(-len(runs) // MOST_NAMED))
    grid[0].set_yticks(list(named), [_named(runs[row]) for row in named])
    grid[0].set_ylabel(label)
    figure.colorbar(image, ax=grid, label="amplitude [m/s²]", pad=0.01)
    return figure


def _strip(frequency: np.ndarray, amplitude: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """The highest lines in cells of ``CELL_HZ`` from 1 Hz on, and the cells' edges: single bins cannot be seen."""
    shown = frequency >= 1.0
    together = max(1, round(CELL_HZ / (frequency[1] - frequency[0])))
    count = int(shown.sum()) // together
    first = int(np.argmax(shown))
    lines = amplitude[first : first + count * together].reshape(count, together).max(axis=1)
    edges = frequency[first] + (np.arange(count + 1) * together - 0.5) * (frequency[1] - frequency[0])
    return edges, lines


def _named(run: SweptRun) -> str:
    value = run.value if isinstance(run.value, str) else f"{run.value:g}"
    return f"{value}, {run.group}" if run.group else value


@style.house
def peaks_figure(runs: Sequence[SweptRun], label: str) -> Figure:
    """The three highest peaks of each run, a dot each, its area by the height of the line."""
    figure = style.new_figure(style.DOUBLE_COLUMN, 3.0)
    grid = figure.subplots(1, 3, sharey=True)
    top = float(np.nanmax([run.peak_amplitude for run in runs]))
    groups = _groups(runs)
    for index, (axes, channel) in enumerate(zip(grid, CHANNELS, strict=True)):
        x = _places(axes, runs, label)
        for rank, name in enumerate(RANKS):
            heights = np.array([run.peak_amplitude[index, rank] for run in runs])
            lines = [run.peak_hz[index, rank] for run in runs]
            colours = [style.SERIES[groups.index(run.group) % len(style.SERIES)] for run in runs]
            axes.scatter(
                x, lines, s=4.0 + 60.0 * heights / top, marker=style.MARKERS[rank], c=colours, alpha=0.75,
                edgecolors="white", linewidths=0.4, label=name if not index else None,
            )  # fmt: skip
        axes.set_title(style.quantity_text(channel))
    grid[0].set_ylim(bottom=0)
    grid[0].set_ylabel("frequency of the peaks [Hz]")
    _name_groups(figure, grid[0], groups)
    return figure


@style.house
def amplitudes_figure(runs: Sequence[SweptRun], label: str) -> Figure:
    """(max − min)/2 of the low-passed log over the swept value: a dot each, joined by the means."""
    figure = style.new_figure(style.DOUBLE_COLUMN, 2.8)
    grid = figure.subplots(1, 3)
    groups = _groups(runs)
    for index, (axes, channel) in enumerate(zip(grid, CHANNELS, strict=True)):
        x = _places(axes, runs, label)
        for number, group in enumerate(groups):
            own = [k for k, run in enumerate(runs) if run.group == group]
            places, heights = x[own], np.array([runs[k].amplitude[index] for k in own])
            colour = style.SERIES[number % len(style.SERIES)]
            axes.plot(places, heights, ls="none", marker=style.MARKERS[number % len(style.MARKERS)], color=colour, ms=4)
            distinct = np.unique(places)
            means = [float(heights[places == place].mean()) for place in distinct]
            axes.plot(distinct, means, color=colour, lw=0.9)
        axes.set_title(style.quantity_text(channel))
        axes.set_ylim(bottom=0)
    grid[0].set_ylabel("(max − min)/2 [m/s²]")
    _name_groups(figure, None, groups)
    return figure


def _groups(runs: Sequence[SweptRun]) -> list[str]:
    return list(dict.fromkeys(run.group for run in runs))


def _places(axes: Axes, runs: Sequence[SweptRun], label: str) -> np.ndarray:
    """Where along x each run stands: its value, or the place of its word."""
    axes.set_xlabel(label)
    words = list(dict.fromkeys(run.value for run in runs))
    if any(isinstance(word, str) for word in words):
        axes.set_xticks(range(len(words)), [str(word) for word in words])
        return np.array([float(words.index(run.value)) for run in runs])
    places = np.array([float(run.value) for run in runs])
    if places.min() > 0.0 and np.log10(places.max() / places.min()) > DECADES:
        axes.set_xscale("log")
    return places


def _name_groups(figure: Figure, ranked: Axes | None, groups: Sequence[str]) -> None:
    """A legend of markers by rank, and of colours by the values of further axes."""
    handles, labels = ranked.get_legend_handles_labels() if ranked is not None else ([], [])
    if len(groups) > 1:
        axes = figure.axes[0]
        for number, group in enumerate(groups):
            marker = "o" if ranked is not None else style.MARKERS[number % len(style.MARKERS)]
            handles += axes.plot([], [], ls="none", marker=marker, color=style.SERIES[number % len(style.SERIES)])
            labels.append(group)
    if handles:
        figure.legend(handles, labels, loc="outside lower center", ncols=min(len(labels), 6))
