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

    Parameters
    ----------
    prediction : Prediction
    title : str
    """
    channels = len(prediction.names)
    figure = style.new_figure(style.DOUBLE_COLUMN, 0.6 + 1.7 * channels)
    panels = np.atleast_1d(figure.subplots(channels, 1, sharex=True))
    spectra = prediction.metric == "log_psd_db"
    for index, axes in enumerate(panels):
        name, unit = prediction.names[index], prediction.units[index]
        measured, simulated = prediction.measured[:, index], prediction.simulated[:, index]
        if spectra:
            for samples, colour, label in (
                (measured, style.MEASURED, "recorded"),
                (simulated, style.ORANGE, "simulated"),
            ):
                density = power_density(samples, prediction.sample_rate)
                axes.semilogy(density.frequency, density.density, color=colour, label=label)
            axes.set_ylabel(f"{style.quantity_text(name)} [({style.unit_text(unit)})²/Hz]")
        else:
            axes.plot(prediction.time, measured, color=style.MEASURED, label="recorded")
            axes.plot(prediction.time, simulated, color=style.ORANGE, lw=0.8, label="simulated")
            axes.plot(prediction.time, measured - simulated, color=style.BLUE, lw=0.5, label="difference")
            axes.set_ylabel(style.axis_text(name, unit))
    panels[0].legend(loc="upper right", ncols=3)
    panels[0].set_title(title)
    panels[-1].set_xlabel("frequency [Hz]" if spectra else "time [s]")
    return figure
