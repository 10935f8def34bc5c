"""Simulation over recording: one panel per channel, and what is left between them."""

from __future__ import annotations

import numpy as np
from matplotlib.figure import Figure

from ssmr_ident.compare.outcome import Prediction
from ssmr_ident.report import style
from ssmr_ident.signals.spectra import power_density


@style.house
def overlay_figure(prediction: Prediction, title: str) -> Figure:
    """Time courses for what repeats (decays, pulls, rigs), power densities for what does not (swivels).

    Courses are drawn as the metric sees them: in its band, their means taken off, one scale for one unit.

    Parameters
    ----------
    prediction : Prediction
    title : str
    """
    channels = len(prediction.names)
    figure = style.new_figure(style.DOUBLE_COLUMN, 0.6 + 1.7 * channels)
    panels = np.atleast_1d(np.asarray(figure.subplots(channels, 1, sharex=True)))
    spectra = prediction.metric == "log_psd_db"
    courses = [prediction.measured, prediction.simulated]
    if not spectra and prediction.low_pass_hz is not None:
        courses = [prediction.judged(c) for c in courses]
        courses = [c - c.mean(axis=0) for c in courses]
    for index, axes in enumerate(panels):
        name, unit = prediction.names[index], prediction.units[index]
        measured, simulated = courses[0][:, index], courses[1][:, index]
        if spectra:
            for samples, colour, label in (
                (measured, style.MEASURED, "recorded"),
                (simulated, style.ORANGE, "simulated"),
            ):
                density = power_density(samples, prediction.sample_rate)
                axes.semilogy(density.frequency, density.density, color=colour, label=label)
            axes.set_ylabel(f"{style.quantity_text(name)} [({style.unit_text(unit)})²/Hz]")
        else:
            axes.plot(prediction.time, measured, color=style.RAW, lw=2.4, label="recorded")
            axes.plot(prediction.time, simulated, color=style.ORANGE, lw=0.8, label="simulated")
            axes.plot(prediction.time, measured - simulated, color=style.BLUE, lw=0.5, label="difference")
            axes.set_ylabel(style.axis_text(name, unit))
            same = [i for i, other in enumerate(prediction.units) if other == unit]
            low, high = min(c[:, same].min() for c in courses), max(c[:, same].max() for c in courses)
            axes.set_ylim(low - 0.08 * (high - low), high + 0.08 * (high - low))
    panels[0].legend(loc="upper right", ncols=3)
    panels[0].set_title(style.name_text(title))
    panels[-1].set_xlabel("frequency [Hz]" if spectra else "time [s]")
    return figure
