"""What ``ident spectrum`` leaves in its folder: spectrum.csv, spectrum-average.csv, figures."""

from __future__ import annotations

import re
from collections.abc import Callable, Sequence
from dataclasses import replace
from pathlib import Path

from matplotlib.figure import Figure

from ssmr_ident.core.errors import InputError
from ssmr_ident.report import style
from ssmr_ident.report.figures_spectrum import NamedAnalysis, recording_figure
from ssmr_ident.report.figures_speed import amplitude_figure, peaks_figure
from ssmr_ident.workflows.spectrum.run import SpectrumReport
from ssmr_ident.workflows.spectrum.table import SpectrumRow, write_rows

MOST_PANELS = 6
"""More rows than this do not fit on a page; the table has them all."""


def write(
    report: SpectrumReport,
    out: Path,
    *,
    format: str = "png",
    figures: bool = True,
    progress: Callable[[str], None] | None = None,
) -> SpectrumReport:
    """Write spectrum.csv, spectrum-average.csv where there are swivels, and the figures.

    Parameters
    ----------
    report : SpectrumReport
    out : Path
        Folder; made when it does not exist.
    format : {"png", "svg", "pdf"}
    figures : bool
    progress : callable, optional
        Called with a line on each log before it is drawn.

    Returns
    -------
    SpectrumReport
        With ``files``.
    """
    if out.exists() and not out.is_dir():
        raise InputError(str(out), "is a file, a folder is wanted", "Give another --out.")
    files = [write_rows(out / "spectrum.csv", (row.as_dict() for row in report.rows))]
    if report.averages:
        files.append(write_rows(out / "spectrum-average.csv", report.average_rows()))
    if figures:
        files += _write_figures(report, out, format, progress or (lambda name: None))
    return replace(report, files=tuple(files))


def _write_figures(report: SpectrumReport, out: Path, format: str, progress: Callable[[str], None]) -> list[Path]:
    files = []
    by_file: dict[str, list[SpectrumRow]] = {}
    for row in report.rows:
        by_file.setdefault(row.label.file, []).append(row)
    for file, rows in by_file.items():
        progress(f"drawing {file}")
        files.append(style.save(recording_of_rows(rows), out / f"spectrum-{_stem(file)}", format))
    for configuration in dict.fromkeys(average.configuration for average in report.averages):
        own = [average for average in report.averages if average.configuration == configuration]
        figure = peaks_figure(configuration, own, report.speed_label)
        files.append(style.save(figure, out / f"peaks-over-speed-{_stem(configuration)}", format))
    if report.averages:
        figure = amplitude_figure(report.averages, report.speed_label)
        files.append(style.save(figure, out / "amplitude-over-speed", format))
    return files


def recording_of_rows(rows: Sequence[SpectrumRow]) -> Figure:
    """Course, close-up and spectrum of one log: its accelerations, or whatever it has."""
    chosen = [row for row in rows if row.unit == "m/s^2"] or rows
    return recording_figure(
        _title(rows[0]), [NamedAnalysis(row.channel, row.unit, row.analysis) for row in chosen[:MOST_PANELS]]
    )


def _title(row: SpectrumRow) -> str:
    label, analysis = row.label, row.analysis
    words = [label.file, *label.made]
    if label.yaw_rate_deg_s == label.yaw_rate_deg_s:
        words.append(f"{label.yaw_rate_deg_s:g} deg/s")
    if label.wheel_speed_m_s == label.wheel_speed_m_s:
        words.append(f"wheels {label.wheel_speed_m_s:g} m/s")
    words.append(f"{analysis.part.count} samples, bins of {analysis.spectrum.resolution:.3g} Hz")
    return " · ".join(word for word in words if word)


def _stem(name: str) -> str:
    """A file name from a name: letters, digits, dot and dash; the suffix stays, as logs may differ by it alone."""
    return re.sub(r"[^\w.-]+", "-", name).strip("-.")
