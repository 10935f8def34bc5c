"""One recording: its course with low-pass and band-pass, its strongest moments, its spectrum with marked peaks."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from ssmr_ident.report import style
from ssmr_ident.signals.analysis import ChannelAnalysis
from ssmr_ident.signals.lines import places

PEAK_COLOURS = (style.ORANGE, style.BLUE, style.GREEN)
SHOWN_TO_HZ = 70.0
"""Beyond the 60 Hz of the mains, so that its line is seen though it is not searched."""
PERIODS = 10


@dataclass(frozen=True, eq=False)
class NamedAnalysis:
    """An analysis with the name and unit of its channel."""

    channel: str
    unit: str
    analysis: ChannelAnalysis


@style.house
def recording_figure(title: str, channels: Sequence[NamedAnalysis]) -> Figure:
    """Course, close-up and spectrum, one row per channel.

    Parameters
    ----------
    title : str
    channels : sequence of NamedAnalysis
        From one recording.

    Returns
    -------
    Figure
    """
    rows = len(channels)
    figure = style.new_figure(style.DOUBLE_COLUMN, 0.75 + 1.5 * rows)
    figure.suptitle(style.name_text(title, 120), fontsize=8, x=0.01, ha="left")
    grid = figure.subplots(rows, 3, squeeze=False, sharex="col", width_ratios=(1.1, 1, 1.25))
    window = _strongest(channels)
    for row, named in zip(grid, channels, strict=True):
        _course(row[0], named)
        _close_up(row[1], named, window)
        _spectrum(row[2], named)
    heads = ("whole log", "around the largest excursion", "spectrum of the shaded part")
    for axes, head in zip(grid[0], heads, strict=True):
        axes.set_title(head, loc="left", color=style.INK)
    for axes in grid[-1][:2]:
        axes.set_xlabel("time [s]")
    grid[-1][2].set_xlabel("frequency [Hz]")
    figure.align_ylabels(grid[:, 0])
    figure.align_ylabels(grid[:, 2])
    handles, labels = grid[0][1].get_legend_handles_labels()
    figure.legend(handles, labels, loc="outside lower left", ncols=len(labels), handlelength=1.6)
    return figure


def _course(axes: Axes, named: NamedAnalysis) -> None:
    analysis = named.analysis
    time, part = analysis.time, analysis.part
    axes.axvspan(time[part.first], time[part.first + part.count - 1], color=style.SHADE, lw=0, zorder=0)
    axes.plot(time, analysis.samples, color=style.RAW, lw=0.3, rasterized=True)
    axes.plot(time, analysis.low_passed, color=style.INK, lw=0.35, rasterized=True)
    envelope = analysis.band_envelope
    if envelope is not None:
        # Only inside the analysed part: near the ends so narrow a filter shows its continuation of the log.
        inside = part.indices
        for side in (-1, 1):
            curve = np.median(analysis.low_passed) + side * envelope[inside]
            axes.plot(time[inside], curve, color=style.ORANGE, lw=1.0)
    axes.set_xlim(time[0], time[-1])
    axes.set_ylabel(style.axis_text(named.channel, named.unit))


def _close_up(axes: Axes, named: NamedAnalysis, window: slice) -> None:
    analysis, options = named.analysis, named.analysis.options
    time = analysis.time[window]
    axes.plot(time, analysis.samples[window], color=style.RAW, lw=0.6, label="as logged")
    low = f"low-pass {options.low_pass_hz:g} Hz"
    axes.plot(time, analysis.low_passed[window], color=style.INK, lw=0.9, label=low)
    if analysis.band_passed is not None:
        label = f"band-pass ±{options.half_width_hz:g} Hz around the highest peak (left: its envelope)"
        curve = np.median(analysis.low_passed) + analysis.band_passed[window]
        axes.plot(time, curve, color=style.ORANGE, lw=0.9, label=label)
    axes.set_xlim(time[0], time[-1])
    lowest, highest = axes.get_ylim()
    axes.set_ylim(lowest, highest + 0.22 * (highest - lowest))  # room for the text
    text = f"(max − min)/2 = {analysis.amplitude:.3g} {style.unit_text(named.unit)}"
    axes.text(0.98, 0.98, text, transform=axes.transAxes, ha="right", va="top", fontsize=6.5)


def _strongest(channels: Sequence[NamedAnalysis]) -> slice:
    """Ten periods around the largest excursion inside the analysed part, of the channel that moves most."""
    analysis = max((named.analysis for named in channels), key=lambda analysis: analysis.amplitude)
    part, n = analysis.part, len(analysis.samples)
    excursion = np.abs(analysis.low_passed - np.median(analysis.low_passed))[part.indices]
    centre = part.first + int(np.argmax(excursion))
    period = 1 / analysis.peaks.frequency[0] if len(analysis.peaks) else 0.1
    width = int(np.clip(PERIODS * period * analysis.sample_rate, min(n, 16), n))
    first = int(np.clip(centre - width // 2, 0, n - width))
    return slice(first, first + width)


def _spectrum(axes: Axes, named: NamedAnalysis) -> None:
    spectrum, peaks, lines = named.analysis.spectrum, named.analysis.peaks, named.analysis.lines
    end = min(SHOWN_TO_HZ, spectrum.frequency[-1])
    shown = (spectrum.frequency > 0) & (spectrum.frequency <= end)
    band = named.analysis.options.band_hz
    axes.axvspan(band[0], min(band[1], end), color=style.SHADE, lw=0, zorder=0)
    axes.plot(spectrum.frequency[shown], spectrum.amplitude[shown], color=style.INK, lw=0.7)
    for rank, (frequency, amplitude) in enumerate(zip(peaks.frequency, peaks.amplitude, strict=True)):
        read = f"{lines.frequency[rank]:.{places(lines.frequency_std[rank])}f}"
        axes.plot(
            frequency,
            amplitude,
            style.MARKERS[rank],
            color=PEAK_COLOURS[rank],
            mec="white",
            mew=0.5,
            ms=4.5,
            label=f"{read} Hz, {amplitude:.3g} {style.unit_text(named.unit)}",
        )
    searched = shown & (spectrum.frequency >= band[0]) & (spectrum.frequency <= band[1])
    # Drift below the band and hum above it may tower over all lines; the axis is for what is searched, with room
    # for the legend.
    highest = spectrum.amplitude[searched].max() if searched.any() else spectrum.amplitude[shown].max()
    top = 1.25 * highest if highest > 0 else 1.0
    axes.set_ylim(0, top)
    axes.set_xlim(0, end)
    mains = named.analysis.mains
    if mains is not None and mains.frequency < end and mains.amplitude > 0.04 * top:
        axes.text(
            mains.frequency - 2.5,
            0.1 * top,
            f"mains {mains.amplitude:.2g}",
            rotation=90,
            ha="right",
            va="bottom",
            fontsize=6.5,
            color=style.MEASURED,
        )
    axes.set_ylabel(f"|{style.quantity_text(named.channel)}| [{style.unit_text(named.unit)}]")
    if len(peaks):
        axes.legend(
            loc="upper right",
            handletextpad=0.2,
            borderaxespad=0.1,
            frameon=True,
            framealpha=0.85,
            edgecolor="none",
        )
