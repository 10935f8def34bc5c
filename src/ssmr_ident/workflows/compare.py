"""From a session and parameters to a comparison, its table and its overlay plots."""

from __future__ import annotations

import csv
import io
from collections.abc import Callable
from functools import partial
from pathlib import Path

from ssmr_ident.compare import Comparison, compare
from ssmr_ident.core.atomic import make_folder, write_text
from ssmr_ident.experiments.campaign import load
from ssmr_ident.report.comparison_page import comparison_page
from ssmr_ident.report.html import file_hashes, write_page
from ssmr_ident.report.overlay import overlay_figure
from ssmr_ident.report.style import save
from ssmr_ident.session import read_parameters
from ssmr_ident.workflows.files_read import files_read


def compare_session(
    session: Path,
    params: str = "",
    output: Path | None = None,
    progress: Callable[[str, int, int], None] | None = None,
    command: str = "ssmr_ident.compare, called from Python",
) -> Comparison:
    """Compare a session with parameters; write plots and a table where asked for.

    Parameters
    ----------
    session : Path
    params : str
        Parameter file or bundled robot; empty takes the session's own.
    output : Path or None
        Folder for ``compare.csv``, one overlay per recording, and ``report.html``.
    progress : callable, optional
        Called with what is being done, how much of it is done, and of how much.
    command : str
        The call that made it, printed at the end of the page.
    """
    step = progress or (lambda stage, done, total: None)
    campaign = load(session, partial(step, "reading logs"))
    parameters = read_parameters(params) if params else campaign.parameters
    result = compare(campaign, parameters, partial(step, "simulating"))
    if output is not None:
        write_comparison(result, output, partial(step, "drawing"))
        files = file_hashes(files_read(session, params))
        write_page(output / "report.html", comparison_page(result, command, files))
    return result


def write_comparison(
    result: Comparison, output: Path, progress: Callable[[int, int], None] = lambda done, total: None
) -> None:
    """``compare.csv`` and one PNG per recording; named with its ending where logs differ by that alone."""
    make_folder(output)
    stream = io.StringIO(newline="")
    writer = csv.writer(stream)
    writer.writerow(["file", "experiment", "metric", "channel", "value"])
    for row in result.recordings:
        writer.writerow([row.file, row.experiment, row.metric, "all", repr(row.value)])
        for name, value in row.channels.items():
            writer.writerow([row.file, row.experiment, row.metric, name, repr(value)])
    write_text(output / "compare.csv", stream.getvalue())
    stems = [Path(row.file).stem for row in result.recordings]
    for index, (row, stem) in enumerate(zip(result.recordings, stems, strict=True), start=1):
        figure = overlay_figure(row.prediction, f"{row.file}: {row.experiment.replace('_', ' ')}")
        save(figure, output / (stem if stems.count(stem) == 1 else Path(row.file).name))
        progress(index, len(stems))
