"""The page of ``ident spectrum``: strongest peaks, figures, and every number in a table."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path

from ssmr_ident.report.figures_speed import amplitude_figure, peaks_figure
from ssmr_ident.report.html import (
    Cell,
    Fact,
    Number,
    Page,
    Picture,
    Section,
    Table,
    Verdict,
    file_hashes,
    picture,
    write_page,
)
from ssmr_ident.report.numbers import NONE, number, unit
from ssmr_ident.signals.lines import places
from ssmr_ident.workflows.files_read import files_read
from ssmr_ident.workflows.spectrum.files import recording_of_rows
from ssmr_ident.workflows.spectrum.run import SpectrumReport
from ssmr_ident.workflows.spectrum.table import SpectrumRow

SHOWN = 6
"""As many recordings are drawn; the table has them all, the folder their figures."""


def write_spectrum_page(report: SpectrumReport, out: Path, command: str, paths: Sequence[Path]) -> SpectrumReport:
    """Write ``report.html``; returns the report with it among its files.

    Parameters
    ----------
    report : SpectrumReport
    out : Path
    command : str
    paths : sequence of Path
        A session, or logs.
    """
    single = Path(paths[0])
    session = single.is_dir() or single.suffix in (".yaml", ".yml")
    page = spectrum_page(report, command, files_read(single) if session else paths)
    return replace(report, files=(*report.files, write_page(out / "report.html", page)))


def spectrum_page(report: SpectrumReport, command: str, files: Sequence[Path]) -> Page:
    """What the logs hold, in the frequencies that stand out.

    Parameters
    ----------
    report : SpectrumReport
    command : str
    files : sequence of Path
        What was read.
    """
    by_file: dict[str, list[SpectrumRow]] = {}
    for row in report.rows:
        by_file.setdefault(row.label.file, []).append(row)
    strongest = max(report.rows, key=lambda row: _height(row, 0))
    facts = tuple(_fact(channel, report.rows) for channel in dict.fromkeys(r.channel for r in report.rows))[:SHOWN]
    label = f"{len(by_file)} recording{'s' if len(by_file) > 1 else ''}"
    if len(strongest.analysis.lines):
        label += f", strongest line at {float(_hertz(strongest, 0)):.4g} Hz"
    sentence = f"The strongest line of each channel, over {len(by_file)} recordings of {report.source}:"
    if len(by_file) == 1:
        sentence = f"The strongest line of each channel of {report.source}:"
    sections = (speed_section(report), _recordings(by_file), _table(report), _notes(report))
    kept = tuple(s for s in sections if s.figures or s.tables or s.points)
    verdict = Verdict(label, "", sentence, facts)
    return Page(f"Spectra of {report.source}", (), kept, command, file_hashes(files), verdict=verdict)


def speed_section(report: SpectrumReport, title: str = "Over the turning speed", text: str = "") -> Section:
    """Peaks and amplitudes of swivels over their speed."""
    figures: list[Picture] = []
    for configuration in dict.fromkeys(average.configuration for average in report.averages):
        own = [average for average in report.averages if average.configuration == configuration]
        alt = f"{configuration}: frequency and height of the three highest peaks of each axis over the turning speed."
        caption = (
            f"{configuration}: at which frequencies the robot shakes most along each axis (above), how strongly "
            "(middle), and how far the whole signal swings (below), over the speed at which it turns."
        )
        figures.append(picture(peaks_figure(configuration, own, report.speed_label), caption, alt))
    if report.averages:
        alt = f"Amplitude of each axis over the turning speed, {report.source}, one line per floor and frame."
        caption = "How far the signal swings (half of maximum minus minimum, below 50 Hz) over the turning speed."
        figures.append(picture(amplitude_figure(report.averages, report.speed_label), caption, alt))
    return Section(title, (text,) if text else (), figures=tuple(figures))


def _recordings(by_file: dict[str, list[SpectrumRow]]) -> Section:
    figures = []
    for file, rows in list(by_file.items())[:SHOWN]:
        alt = f"{file}: course and spectrum of each channel; highest peaks at "
        alt += ", ".join(f"{_hertz(row, 0)} Hz in {row.channel}" for row in rows) + "."
        caption = (
            f"{file}. Left: the whole log, as recorded (grey) and without what is faster than the low-pass (black). "
            "Middle: ten swings around the largest one. Right: how much of each frequency there is, with the three "
            "highest peaks marked."
        )
        figures.append(picture(recording_of_rows(rows), caption, alt, white=True))
    return Section("Recordings" if len(by_file) <= SHOWN else f"The first {SHOWN} recordings", figures=tuple(figures))


def _table(report: SpectrumReport) -> Section:
    rows: list[tuple[Cell, ...]] = []
    for row in report.rows:
        cells: list[Cell] = [row.label.file, row.channel]
        for rank in range(3):
            there = rank < len(row.analysis.lines)
            cells.append(Number(_error(row, rank), float(row.analysis.lines.frequency[rank])) if there else NONE)
            cells.append(Number(number(_height(row, rank)), _height(row, rank)) if there else NONE)
        cells += [Number(number(row.analysis.amplitude), row.analysis.amplitude), unit(row.unit) or NONE]
        rows.append((*cells, Number(number(row.analysis.spectrum.resolution, 2), row.analysis.spectrum.resolution)))
    peaks = [text for rank in ("highest", "second", "third") for text in (f"{rank} [Hz]", "height")]
    header = ("recording", "channel", *peaks, "(max − min)/2", "unit", "bin [Hz]")
    caption = (
        "Peaks of every channel, read between the bins; ± is one standard deviation. "
        "Heights and amplitudes in the unit named."
    )
    return Section("All peaks", tables=(Table(caption, header, tuple(rows)),))


def _notes(report: SpectrumReport) -> Section:
    return Section("What was noticed", points=tuple(f"{file}: {note.text}" for file, note in report.notes))


def _fact(channel: str, rows: Sequence[SpectrumRow]) -> Fact:
    own = sorted((r for r in rows if r.channel == channel and len(r.analysis.lines)), key=lambda r: -_height(r, 0))
    if not own:
        return Fact(channel, NONE, "no peak in the band searched")
    best = own[0]
    note = (
        f"± {number(float(best.analysis.lines.frequency_std[0]), 1)} Hz, {number(_height(best, 0))} {unit(best.unit)}"
    )
    if len(own) > 1:
        found = [float(r.analysis.lines.frequency[0]) for r in own]
        note += f", in {best.label.file}; others from {number(min(found))} to {number(max(found))} Hz"
    return Fact(channel, f"{_hertz(best, 0)} Hz", note)


def _hertz(row: SpectrumRow, rank: int) -> str:
    peaks = row.analysis.lines
    return f"{peaks.frequency[rank]:.{places(float(peaks.frequency_std[rank]))}f}" if rank < len(peaks) else NONE


def _error(row: SpectrumRow, rank: int) -> str:
    return f"{_hertz(row, rank)} ± {row.analysis.lines.frequency_std[rank]:.1g}"


def _height(row: SpectrumRow, rank: int) -> float:
    peaks = row.analysis.lines
    return float(peaks.amplitude[rank]) if rank < len(peaks) else 0.0
