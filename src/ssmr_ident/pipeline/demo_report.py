"""The main job as one page: what was read, found and simulated, with figures."""

from __future__ import annotations

from pathlib import Path

from ssmr_ident.compare import Comparison, RecordingComparison
from ssmr_ident.pipeline.demo import Demo
from ssmr_ident.report.figures_speed import amplitude_figure, peaks_figure
from ssmr_ident.report.html import Page, Picture, Section, Table, picture, write_page
from ssmr_ident.report.overlay import overlay_figure

_SHOWN = {
    "free_response": ("roll-1.xlsx", "pitch-1.xlsx", "yaw-1.xlsx"),
    "pulls": ("concrete-lateral-steel-1.txt", "concrete-longitudinal-steel-1.txt", "concrete-wheel-compression-1.txt"),
    "swivel": ("v0-w30-t20-frame-concrete.xlsx", "v0-w60-t20-frame-concrete.xlsx"),
}
_UNITS = {"nrmse_percent": "%", "log_psd_db": "dB"}


def write_demo_report(demo: Demo, command: str) -> Path:
    """Write ``report.html`` beside the parameters.

    Parameters
    ----------
    demo : Demo
    command : str
        The call that made it, printed at the end of the page.
    """
    decays, pulls, swivels = demo.comparisons
    lead = (
        "Recordings of a synthetic campaign in the formats of the 2012 thesis, read, filtered, fitted, and simulated "
        "with what the fit found. Nothing here was measured: the logs come from this package's own simulator with "
        "noise, hum and converter steps, so what comes out can be checked against what went in.",
        f"Simulated with the identified parameters, the free responses differ from the recordings by "
        f"{decays.overall['nrmse_percent']:.1f} % on average (all channels, below 50 Hz), the pulls by "
        f"{pulls.overall['nrmse_percent']:.1f} %, and the spectra of the swivels on concrete by "
        f"{swivels.overall['log_psd_db']:.1f} dB.",
    )
    sections = (
        Section(
            "Published, identified, simulated",
            (
                "Thesis: what its tables print. Identified: from the logs in data/raw, with one standard deviation. "
                "Simulated: the simulator run with the identified parameters, its logs identified by the same methods.",
            ),
            (Table("", ("quantity", "thesis", "identified", "simulated"), demo.table.cells()),),
        ),
        _spectra(demo),
        _comparison("Free responses: simulation over recordings", decays, _SHOWN["free_response"]),
        _comparison(
            "Pulls and bench tests",
            pulls,
            _SHOWN["pulls"],
            "Slopes and levels compare. Once contacts slide, the moment at which a single wheel lets go is chaotic: it "
            "does not repeat, so single teeth do not lie on each other even for the right parameters.",
        ),
        _comparison(
            "Swivels",
            swivels,
            _SHOWN["swivel"],
            "Stick-slip does not repeat its course, so power spectra are compared, not samples. No experiment "
            "fitted here informs lambda_max, the slip at which grip is used up; it keeps the value of robot.yaml, and "
            "these logs were made with another. That is what the distance shows.",
        ),
        Section(
            "What the fits say",
            ("Reports of ident fit on the pulls, then on the free responses with what the pulls told.",),
            listings=(str(demo.pulls), str(demo.decays)),
        ),
    )
    page = Page("Skid-steering robot: from logs to parameters to simulation", lead, sections, command, _files(demo))
    return write_page(demo.output / "report.html", page)


def _spectra(demo: Demo) -> Section:
    figures: list[Picture] = []
    for report in demo.spectra:
        for configuration in dict.fromkeys(average.configuration for average in report.averages):
            own = [average for average in report.averages if average.configuration == configuration]
            caption = f"{configuration}: the three highest peaks of each axis over the yaw rate."
            figures.append(
                picture(peaks_figure(configuration, own, report.speed_label), caption, f"peaks {configuration}")
            )
        caption = f"Amplitude (half of maximum minus minimum, below 50 Hz) over the yaw rate, {report.source}."
        figures.append(
            picture(amplitude_figure(report.averages, report.speed_label), caption, f"amplitudes {report.source}")
        )
    return Section(
        "Spectra of the swivels", ("Peaks and amplitudes as in Appendix B of the thesis.",), figures=tuple(figures)
    )


def _comparison(title: str, comparison: Comparison, shown: tuple[str, ...], text: str = "") -> Section:
    rows = tuple(
        (r.file, r.experiment.replace("_", " "), _value(r, r.value), _channels(r)) for r in comparison.recordings
    )
    header = ("recording", "experiment", "all channels", "channel by channel")
    figures = tuple(
        picture(
            overlay_figure(r.prediction, r.file),
            f"{r.file}: recorded and simulated, {_value(r, r.value)} apart.",
            f"overlay {r.file}",
        )
        for r in comparison.recordings
        if r.file in shown
    )
    caption = (
        "Distance between simulation and recording; starting state, slack and sensor zeros were fitted, physics not."
    )
    return Section(title, (text,) if text else (), (Table(caption, header, rows),), figures)


def _value(recording: RecordingComparison, value: float) -> str:
    return f"{value:.3g} {_UNITS[recording.metric]}"


def _channels(recording: RecordingComparison) -> str:
    if len(recording.channels) < 2:
        return ""
    return ", ".join(f"{name} {_value(recording, value)}" for name, value in recording.channels.items())


def _files(demo: Demo) -> tuple[tuple[str, str], ...]:
    """Name and SHA-256 of every log that the fits used."""
    found: dict[str, str] = {}
    for fit in (demo.pulls, demo.carpet, demo.decays):
        found |= {row["file"]: row["sha256"] for row in fit.parameters.provenance["files"]}
    return tuple(found.items())
