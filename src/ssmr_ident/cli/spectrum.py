"""``ident spectrum``."""

from __future__ import annotations

import sys
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Literal

import typer

from ssmr_ident.cli.reading_options import RateHz, Units, pairs

if TYPE_CHECKING:
    from ssmr_ident.workflows.spectrum.run import SpectrumReport

RANGE_HELP = (
    "Samples transformed: middle, beginning, end, all, or T0:T1 in seconds. "
    "Left out: middle (2^14), for free responses beginning (2^11)."
)
LOW_PASS_HELP = "Of the trace and the amplitude. Left out: 50, for free responses of the robot 20."


EXAMPLES = (
    "ident spectrum data/raw/free_response -o out/spectra",
    "ident spectrum roll-1.xlsx --range 0:2 --low-pass 20 -o spectra",
    "ident spectrum data/raw/swivel-frame --appendix-a -o out/appendix-a",
    "ident spectrum rig.csv --band 0.2:20 --json",
)


def command(
    paths: Annotated[
        list[Path], typer.Argument(metavar="FILE-or-SESSION...", help="A session folder, or one or more logs.")
    ],
    out: Annotated[
        Path | None, typer.Option("--out", "-o", help="Folder for report.html, spectrum.csv and the figures.")
    ] = None,
    part: Annotated[str | None, typer.Option("--range", help=RANGE_HELP)] = None,
    low_pass: Annotated[float | None, typer.Option("--low-pass", metavar="HZ", help=LOW_PASS_HELP)] = None,
    half_width: Annotated[
        float, typer.Option("--half-width", metavar="HZ", help="Of the band-pass; 1 for the thesis' 2 Hz.")
    ] = 0.5,
    band: Annotated[str, typer.Option("--band", metavar="F0:F1", help="Where peaks are searched, in Hz.")] = "1:50",
    reader: Annotated[str | None, typer.Option("--reader", help="Of bare logs; left out, the content decides.")] = None,
    sample: Annotated[
        int | None, typer.Option("--sample", help="Which recording of a bare log that holds several.")
    ] = None,
    fs: RateHz = None,
    units: Units = None,
    format: Annotated[Literal["png", "svg", "pdf"], typer.Option("--format", help="Of the figures.")] = "png",
    figures: Annotated[bool, typer.Option("--figures/--no-figures", help="Draw figures into OUT.")] = True,
    appendix_a: Annotated[
        bool,
        typer.Option("--appendix-a", help="Write appendix A of the thesis to the letter beside ours, a dot per trial."),
    ] = False,
    as_json: Annotated[bool, typer.Option("--json", help="Print the answer as JSON, not as a table.")] = False,
    quiet: Annotated[bool, typer.Option("--quiet", "-q", help="No table.")] = False,
) -> None:
    """Butterworth, FFT and peaks of logs (thesis section 3.2): table, spectrum.csv and figures."""
    from ssmr_ident.cli.called import called
    from ssmr_ident.core.errors import InputError
    from ssmr_ident.readers import ReadOptions
    from ssmr_ident.workflows.spectrum import appendix_a as to_the_letter
    from ssmr_ident.workflows.spectrum.files import write
    from ssmr_ident.workflows.spectrum.page import write_spectrum_page
    from ssmr_ident.workflows.spectrum.run import SpectrumChoices, spectrum

    for option, value in (("--low-pass", low_pass), ("--half-width", half_width), ("--fs", fs)):
        if value is not None and not 0 < value < float("inf"):
            raise InputError(option, f"{value} is no positive frequency", "Give it in Hz.")
    if appendix_a and out is None:
        raise InputError("--appendix-a", "writes files", "Say where with -o")
    if sample is not None and sample < 1:
        raise InputError("--sample", f"{sample} is no recording", "Count from 1.")
    options = ReadOptions(reader=reader, sample=sample, fs=fs, units=pairs("--units", units))
    progress = None if quiet or not sys.stderr.isatty() else _progress
    choices = SpectrumChoices(part, low_pass, half_width, _band(band))
    report = spectrum(paths, choices, options=options, progress=progress)
    if out is not None:
        report = write(report, out, format=format, figures=figures, progress=progress)
        if figures:
            report = write_spectrum_page(report, out, called(), paths)
        if appendix_a:
            report = to_the_letter.write(report, out, format)
    if progress:
        progress("")
    if as_json:
        _print_json(report)
    elif not quiet:
        from ssmr_ident.workflows.spectrum.screen import screen_text

        typer.echo(screen_text(report))


def _progress(line: str) -> None:
    """Over the line before, so that nothing of it stays on the screen."""
    print(f"\r\033[K{line}", end="", file=sys.stderr, flush=True)


def _band(text: str) -> tuple[float, float]:
    from ssmr_ident.core.errors import InputError

    low, _, high = text.partition(":")
    try:
        edges = float(low), float(high)
    except ValueError:
        edges = (0.0, -1.0)
    if not 0 <= edges[0] < edges[1] < float("inf"):
        raise InputError("--band", f"{text!r} is no band", "Write for example 0.2:50.")
    return edges


def _print_json(report: SpectrumReport) -> None:
    from ssmr_ident.cli.answer import print_json

    answer = {
        "source": report.source,
        "rows": [row.as_dict() for row in report.rows],
        "averages": report.average_rows(),
        "notes": [{"file": file, "level": note.level, "text": note.text} for file, note in report.notes],
        "files": [str(path) for path in report.files],
    }
    print_json(answer)
