"""Simulation against recordings as a page, and as a section of other pages."""

from __future__ import annotations

from collections.abc import Collection

import numpy as np
from scipy.stats import t

from ssmr_ident.compare import Comparison, RecordingComparison
from ssmr_ident.report.html import Cell, Fact, Number, Page, Section, Table, Verdict, picture
from ssmr_ident.report.numbers import interval, number
from ssmr_ident.report.overlay import overlay_figure

UNITS = {"nrmse_percent": "%", "log_psd_db": "dB"}
MEANING = {
    "nrmse_percent": "of the recording's size",
    "log_psd_db": "between the levels of the spectra, 1 to 50 Hz",
}
_DRAWN = {"nrmse_percent": "course over time", "log_psd_db": "power spectrum"}
_DIFFERENCE = {"nrmse_percent": ", and the difference (blue)", "log_psd_db": ""}
SHOWN = 6


def comparison_page(comparison: Comparison, command: str, files: tuple[tuple[str, str], ...]) -> Page:
    """How far simulation and recordings are apart, and where most.

    Parameters
    ----------
    comparison : Comparison
    command : str
    files : tuple of (str, str)
        Name and SHA-256 of what was read.
    """
    facts = tuple(distance(_title(metric), comparison, metric) for metric in comparison.overall)
    farthest = sorted(comparison.recordings, key=lambda r: -r.value)[:SHOWN]
    worst = farthest[0]
    means = " and ".join(f"{number(value)} {UNITS[metric]}" for metric, value in comparison.overall.items())
    verdict = Verdict(
        f"Simulation and recordings are {means} apart",
        "",
        f"{comparison.session}, simulated with {comparison.params}; farthest apart is {worst.file}, by "
        f"{_value(worst, worst.value)}. Starting states, slack and sensor zeros were fitted, physics not.",
        facts,
    )
    shown = {r.file for r in farthest}
    title = "Farthest apart first" if len(shown) < len(comparison.recordings) else "Recording by recording"
    section = comparison_section(title, comparison, shown)
    return Page(f"Simulation against {comparison.session}", (), (section,), command, files, verdict=verdict)


def comparison_section(title: str, comparison: Comparison, shown: Collection[str], text: str = "") -> Section:
    """Overlays of the recordings named in ``shown``, the farthest apart first, and a table of all."""
    header = ("recording", "experiment", "apart by", "channel by channel")
    rows = tuple(
        (r.file, r.experiment.replace("_", " "), Number(_value(r, r.value), r.value), _channels(r))
        for r in comparison.recordings
    )
    figures = tuple(
        picture(
            overlay_figure(r.prediction, r.file),
            f"{r.file}: recorded (grey), simulated (orange){_DIFFERENCE[r.metric]}; {_value(r, r.value)} apart.",
            f"{r.file}: {_DRAWN[r.metric]} of each channel, recorded and simulated, {_value(r, r.value)} apart.",
        )
        for r in sorted(comparison.recordings, key=lambda r: -r.value)
        if r.file in shown
    )
    caption = (
        "Distance between simulation and recording over all channels; starting state, slack and sensor zeros were "
        "fitted, physics not."
    )
    return Section(title, (text,) if text else (), (Table(caption, header, rows),), figures)


def distance(name: str, comparison: Comparison, metric: str) -> Fact:
    """Mean over recordings with its 95 % interval (Student's t over recordings), and the range that they span."""
    values = np.array([r.value for r in comparison.recordings if r.metric == metric])
    note = MEANING[metric]
    if len(values) > 1:
        reach = float(t.ppf(0.975, len(values) - 1) * values.std(ddof=1) / np.sqrt(len(values)))
        mean = float(values.mean())
        note = (
            f"95 %: {interval(max(mean - reach, 0.0), mean + reach, UNITS[metric])}; {note}; {len(values)} recordings "
        )
        note += f"from {number(values.min())} to {number(values.max())} {UNITS[metric]}"
    return Fact(name, f"{number(float(values.mean()))} {UNITS[metric]}", note)


def _title(metric: str) -> str:
    return "Mean distance of the signals" if metric == "nrmse_percent" else "Mean distance of the spectra"


def _value(recording: RecordingComparison, value: float) -> str:
    return f"{number(value)} {UNITS[recording.metric]}"


def _channels(recording: RecordingComparison) -> Cell:
    if len(recording.channels) < 2:
        return ""
    return ", ".join(f"{name} {_value(recording, value)}" for name, value in recording.channels.items())
