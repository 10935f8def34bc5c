"""What ``ident spectrum`` prints: the table, the averages over repeats, the notes, the files."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import groupby

from ssmr_ident.report.figures_speed import mean_and_spread
from ssmr_ident.signals.lines import Lines, places
from ssmr_ident.signals.peaks import COUNT
from ssmr_ident.workflows.spectrum.run import SpectrumReport
from ssmr_ident.workflows.spectrum.table import SpectrumRow

MOST_FILES = 6


def screen_text(report: SpectrumReport) -> str:
    """The whole answer as lines of text.

    Parameters
    ----------
    report : SpectrumReport
    """
    blocks = [_table(_rows(report.rows))]
    if any(average.repeats > 1 for average in report.averages):
        blocks.append("averages over repeats (± standard deviation)\n" + _table(_averages(report)))
    if any(row.analysis.lines.wide(rank) for row in report.rows for rank in range(len(row.analysis.lines))):
        blocks.append("wide: the line decays within the samples analysed; its frequency is that of the decaying swing")
    notes = _notes(report)
    if notes:
        blocks.append("\n".join(notes))
    if report.files:
        names = [path.name for path in report.files]
        shown = ", ".join(names[:MOST_FILES]) + (
            f" and {len(names) - MOST_FILES} more" if len(names) > MOST_FILES else ""
        )
        blocks.append(f"written to {report.files[0].parent}: {shown}")
    return "\n\n".join(blocks)


def _rows(rows: Sequence[SpectrumRow]) -> list[list[str]]:
    lines = [
        [
            "file",
            "made",
            "channel",
            *(f"peak {k + 1} Hz (height)" for k in range(COUNT)),
            "amplitude",
            "60 Hz",
            "unit",
        ]
    ]
    previous = ""
    for row in rows:
        label, analysis = row.label, row.analysis
        new = label.file != previous
        peaks = [_peak(analysis.lines, rank) for rank in range(len(analysis.lines))]
        peaks += ["–"] * (COUNT - len(peaks))
        mains = "–" if analysis.mains is None else f"{analysis.mains.amplitude:.2g}"
        head = [label.file, _made(row)] if new else ["", ""]
        lines.append([*head, row.channel, *peaks, f"{analysis.amplitude:.3g}", mains, row.unit or "–"])
        previous = label.file
    return lines


def _peak(lines: Lines, rank: int) -> str:
    frequency, std = float(lines.frequency[rank]), float(lines.frequency_std[rank])
    broad = f", {lines.width[rank]:.2g} wide" if lines.wide(rank) else ""
    return f"{frequency:.{places(std)}f} ± {std:.1g}{broad} ({lines.amplitude[rank]:.3g})"


def _made(row: SpectrumRow) -> str:
    label = row.label
    speed = ""
    if label.yaw_rate_deg_s == label.yaw_rate_deg_s:
        speed = f"{label.yaw_rate_deg_s:g} deg/s"
    elif label.wheel_speed_m_s == label.wheel_speed_m_s:
        speed = f"{label.wheel_speed_m_s:g} m/s"
    return ", ".join([*label.made, *([speed] if speed else [])]) or "–"


def _averages(report: SpectrumReport) -> list[list[str]]:
    speed = "deg/s" if report.speed_key == "yaw_rate_deg_s" else "m/s"
    lines = [["configuration", speed, "channel", "n", *(f"peak {k + 1} Hz" for k in range(COUNT)), "amplitude", "unit"]]
    for average in report.averages:
        peaks = [_pair(mean_and_spread(average.peak_hz[:, rank]), ".2f") for rank in range(COUNT)]
        amplitude = _pair(mean_and_spread(average.amplitude), ".3g")
        head = [average.configuration, f"{average.speed:.3g}", average.channel, str(average.repeats)]
        lines.append([*head, *peaks, amplitude, average.unit])
    return lines


def _pair(pair: tuple[float, float], form: str) -> str:
    mean, spread = pair
    if mean != mean:
        return "–"
    return f"{mean:{form}}" if spread != spread else f"{mean:{form}} ± {spread:.2g}"


def _notes(report: SpectrumReport) -> list[str]:
    """Each text once, with the logs that it holds for."""
    ordered = sorted(((str(note), file) for file, note in report.notes), key=lambda pair: pair[0])
    lines = []
    for text, group in groupby(ordered, key=lambda pair: pair[0]):
        files = list(dict.fromkeys(file for _, file in group))
        lines.append(f"{text} ({files[0]}{f' and {len(files) - 1} more' if len(files) > 1 else ''})")
    return lines


def _table(lines: list[list[str]]) -> str:
    widths = [max(len(line[k]) for line in lines) for k in range(len(lines[0]))]
    texts = ["  ".join(cell.ljust(width) for cell, width in zip(line, widths, strict=True)).rstrip() for line in lines]
    return "\n".join([texts[0], "  ".join("-" * width for width in widths), *texts[1:]])
