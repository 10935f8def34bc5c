"""Appendix A of the thesis to the letter, beside what this package reads off the same logs.

The thesis filters first: its three peaks are those of the low-passed signal, whose filter halves a line at its edge.
Ours are those of the samples as they were logged, so a line near the edge keeps its height,
and read between the bins. Amplitudes are the same.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np

from ssmr_ident.core.errors import InputError
from ssmr_ident.report import style
from ssmr_ident.report.figures_appendix_a import Trial, trials_figure
from ssmr_ident.signals.lines import Lines
from ssmr_ident.signals.peaks import COUNT, Peaks, find_peaks
from ssmr_ident.signals.spectra import amplitude_spectrum
from ssmr_ident.workflows.spectrum.run import SpectrumReport
from ssmr_ident.workflows.spectrum.table import RATE_LABEL, SpectrumRow, write_rows


def printed_peaks(row: SpectrumRow) -> Peaks:
    """The three highest lines of the low-passed signal, at least 1 Hz apart."""
    one = row.analysis
    spectrum = amplitude_spectrum(one.low_passed[one.part.indices], one.sample_rate)
    return find_peaks(spectrum, band_hz=one.options.band_hz)


def band_amplitude(row: SpectrumRow) -> float | None:
    """(max − min)/2 of the band around the highest peak, over the samples analysed; None without such a band."""
    band = row.analysis.band_passed
    return None if band is None else float(np.ptp(band[row.analysis.part.indices]) / 2)


def write(report: SpectrumReport, out: Path, format: str = "png") -> SpectrumReport:
    """Write appendix-a.csv, and a figure with every trial a dot where there are accelerations.

    Raises
    ------
    InputError
        No log has a channel.
    """
    if not report.rows:
        raise InputError(report.source, "has no channel", "Give logs with samples")
    files = [write_rows(out / "appendix-a.csv", (_row(row) for row in report.rows))]
    trials = _trials(report.rows)
    if trials:
        label = RATE_LABEL if all(math.isfinite(trial.speed) for trial in trials) else ""
        files.append(style.save(trials_figure(trials, label), out / "appendix-a", format))
    return replace(report, files=(*report.files, *files))


def _row(row: SpectrumRow) -> dict[str, Any]:
    label, one = row.label, row.analysis
    found: dict[str, Any] = {
        "file": label.file, "motion": label.motion, "floor": label.floor, "frame": label.frame,
        "yaw_rate_deg_s": label.yaw_rate_deg_s if math.isfinite(label.yaw_rate_deg_s) else None,
        "channel": row.channel, "unit": row.unit, "low_pass_hz": one.options.low_pass_hz,
        "amplitude": one.amplitude, "band_amplitude": band_amplitude(row),
    }  # fmt: skip
    for name, peaks in (("printed", printed_peaks(row)), ("ours", one.lines)):
        for rank in range(COUNT):
            there = rank < len(peaks)
            found[f"{name}_peak_{rank + 1}_hz"] = float(peaks.frequency[rank]) if there else None
            found[f"{name}_peak_{rank + 1}_amplitude"] = float(peaks.amplitude[rank]) if there else None
    return found


def _trials(rows: Sequence[SpectrumRow]) -> list[Trial]:
    return [
        Trial(
            row.channel, row.label.motion or row.label.configuration,
            row.label.yaw_rate_deg_s, row.analysis.amplitude, _three(printed_peaks(row)), _three(row.analysis.lines),
        )
        for row in rows
        if row.unit == "m/s^2"
    ]  # fmt: skip


def _three(peaks: Peaks | Lines) -> np.ndarray:
    three = np.full(COUNT, np.nan)
    three[: len(peaks)] = peaks.frequency
    return three
