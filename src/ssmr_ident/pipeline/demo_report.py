"""The main job as one page: what was read, found and simulated, with figures."""

from __future__ import annotations

from pathlib import Path

from ssmr_ident.compare import Comparison, RecordingComparison
from ssmr_ident.pipeline.demo import COMPARED, SWIVELS, Demo
from ssmr_ident.report.figures_speed import amplitude_figure, peaks_figure
from ssmr_ident.report.html import Fact, Page, Picture, Section, Table, Verdict, file_hashes, picture, write_page
from ssmr_ident.report.numbers import number
from ssmr_ident.report.overlay import overlay_figure
from ssmr_ident.session import read_session

_SHOWN = {
    "free_response": ("roll-1.xlsx", "pitch-1.xlsx", "yaw-1.xlsx"),
    "pulls": ("concrete-lateral-steel-1.txt", "concrete-longitudinal-steel-1.txt", "concrete-wheel-compression-1.txt"),
    "swivel": ("v0-w30-t20-frame-concrete.xlsx", "v0-w60-t20-frame-concrete.xlsx"),
}
_HOW = {"nrmse_percent": "course over time", "log_psd_db": "power spectrum"}
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
        "Nothing here was measured: the logs come from this package's own simulator with noise, hum and converter "
        "steps, so what comes out can be checked against what went in.",
    )
    verdict = Verdict(
        "From logs to parameters, to a simulation, and back to the logs",
        "",
        "Recordings of a synthetic campaign in the formats of the 2012 thesis were read, filtered, fitted; simulated "
        "with what the fits found, they differ from the recordings by so much:",
        (
            _distance("Free responses", decays, "of the recording's size, below 50 Hz"),
            _distance("Pulls and bench tests", pulls, "of the recording's size"),
            _distance("Swivels on concrete", swivels, "between levels of spectra, 1 to 50 Hz"),
        ),
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
    title = "Skid-steering robot: the main job on the reference campaign"
    page = Page(title, lead, sections, command, file_hashes(_files(demo)), verdict=verdict)
    return write_page(demo.output / "report.html", page)


def _spectra(demo: Demo) -> Section:
    figures: list[Picture] = []
    for report in demo.spectra:
        for configuration in dict.fromkeys(average.configuration for average in report.averages):
            own = [average for average in report.averages if average.configuration == configuration]
            alt = f"{configuration}: frequency and height of the three highest peaks of each axis over the yaw rate."
            caption = (
                f"{configuration}: at which frequencies the robot shakes most along each axis (above), how strongly "
                "(middle), and how far the whole signal swings (below), over the speed at which it turns."
            )
            figures.append(picture(peaks_figure(configuration, own, report.speed_label), caption, alt))
        alt = f"Amplitude of each axis over the yaw rate, {Path(report.source).parent.name}, one line per floor."
        caption = "How far the signal swings (half of maximum minus minimum, below 50 Hz) over the turning speed."
        figures.append(picture(amplitude_figure(report.averages, report.speed_label), caption, alt))
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
            f"{r.file}: recorded (grey) and simulated (orange), {_value(r, r.value)} apart.",
            f"{r.file}: {_HOW[r.metric]} of each channel, recorded and simulated, {_value(r, r.value)} apart.",
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


def _distance(name: str, comparison: Comparison, what: str) -> Fact:
    """Mean over recordings, with the range that they span."""
    metric, mean = next(iter(comparison.overall.items()))
    values = [r.value for r in comparison.recordings]
    note = f"{what}; {number(min(values))} … {number(max(values))} {_UNITS[metric]} over {len(values)} recordings"
    return Fact(name, f"{number(mean)} {_UNITS[metric]}", note)


def _files(demo: Demo) -> list[Path]:
    """Every file that was read: sessions, what they say of the robot, and their logs."""
    raw = Path(demo.spectra[0].source).parent.parent
    found: list[Path] = []
    for name in dict.fromkeys((*COMPARED, *SWIVELS, "pulls/carpet.yaml")):
        session = read_session(raw / name)
        robot = session.folder / session.robot
        found += [raw / name, *([robot] if robot.is_file() else []), *(session.path(e) for e in session.entries)]
    return found
