"""The main job as one page: what was read, found and simulated, with figures."""

from __future__ import annotations

from pathlib import Path

from ssmr_ident.report.comparison_page import comparison_section, distance
from ssmr_ident.report.html import Page, Section, Table, Verdict, file_hashes, write_page
from ssmr_ident.workflows.demo.campaign import COMPARED, SWIVELS, Demo
from ssmr_ident.workflows.files_read import files_read
from ssmr_ident.workflows.spectrum.page import speed_section

# recordings that are drawn
_DECAYS = ("roll-1.xlsx", "pitch-1.xlsx", "yaw-1.xlsx")
_PULLS = ("concrete-lateral-steel-1.txt", "concrete-longitudinal-steel-1.txt", "concrete-wheel-compression-1.txt")
_SWIVELS = ("v0-w30-t20-frame-concrete.xlsx", "v0-w60-t20-frame-concrete.xlsx")


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
            distance("Free responses", decays, "nrmse_percent"),
            distance("Pulls and bench tests", pulls, "nrmse_percent"),
            distance("Swivels on concrete", swivels, "log_psd_db"),
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
        comparison_section("Free responses: simulation over recordings", decays, _DECAYS),
        comparison_section(
            "Pulls and bench tests",
            pulls,
            _PULLS,
            "Slopes and levels compare. Once contacts slide, the moment at which a single wheel lets go is chaotic: it "
            "does not repeat, so single teeth do not lie on each other even for the right parameters.",
        ),
        comparison_section(
            "Swivels",
            swivels,
            _SWIVELS,
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
    figures = [figure for report in demo.spectra for figure in speed_section(report).figures]
    return Section(
        "Spectra of the swivels", ("Peaks and amplitudes as in Appendix B of the thesis.",), figures=tuple(figures)
    )


def _files(demo: Demo) -> list[Path]:
    """Every file that was read."""
    raw = Path(demo.spectra[0].source).parent.parent
    names = dict.fromkeys((*COMPARED, *SWIVELS, "pulls/carpet.yaml"))
    return [file for name in names for file in files_read(raw / name)]
