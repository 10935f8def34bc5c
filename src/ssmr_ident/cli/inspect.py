"""``ident inspect``."""

from __future__ import annotations

import sys
from pathlib import Path
from typing import Annotated, Literal

import typer

from ssmr_ident.cli.reading_options import Columns, RateHz, Units, pairs

EXAMPLES = (
    "ident inspect roll-1.xlsx pull-3.txt",
    "ident inspect data/raw/pulls",
    "ident inspect press.csv daq.csv",
    "ident inspect press.txt --units load=lbf,position=in",
    "ident inspect roll-1.xlsx --json",
)


def command(
    paths: Annotated[
        list[Path], typer.Argument(metavar="FILE...", help="Logs, or folders with logs in or below them.")
    ],
    reader: Annotated[
        str | None,
        typer.Option("--reader", help="Such as csv, lvm, tdms, labview-xlsx, mat; left out, the content decides."),
    ] = None,
    columns: Columns = None,
    units: Units = None,
    sheets: Annotated[
        list[str] | None, typer.Option("--sheets", metavar="AXIS=SHEET,...", help="Such as x=4,y=3,z=2.")
    ] = None,
    fs: RateHz = None,
    time_unit: Annotated[
        str | None, typer.Option("--time-unit", metavar="UNIT", help="Of the time column: s, ms, us.")
    ] = None,
    skip: Annotated[
        str, typer.Option("--skip", metavar="ROWS", help="Rows of a sheet's numbers; 10 is the thesis' 11:end.")
    ] = "auto",
    on_bad: Annotated[
        Literal["error", "nan"], typer.Option("--on-bad", help="What a cell that is no number does.")
    ] = "error",
    stamps: Annotated[
        Literal["auto", "even", "logged"],
        typer.Option("--stamps", help="Stamps in bursts or too coarse: made even by regression (auto), or kept."),
    ] = "auto",
    trim: Annotated[bool, typer.Option("--trim", help="Cut axes of different length to what all have.")] = False,
    load_scale: Annotated[
        float | None, typer.Option("--load-scale", metavar="N", help="Newton per unit of LOAD in .mtwData.")
    ] = None,
    decimal: Annotated[
        Literal[".", ","] | None, typer.Option("--decimal", help="Decimal sign, where the log leaves it open.")
    ] = None,
    sample: Annotated[
        int | None, typer.Option("--sample", help="Which recording of a log that holds several, from 1.")
    ] = None,
    mains: Annotated[float, typer.Option("--mains", metavar="HZ", help="Frequency of the mains.")] = 60.0,
    save: Annotated[
        Path | None,
        typer.Option("--save", metavar="SESSION.YAML", help="Write these choices into the log's entry there."),
    ] = None,
    as_json: Annotated[bool, typer.Option("--json", help="Print the answer as JSON.")] = False,
    quiet: Annotated[bool, typer.Option("--quiet", "-q", help="Only warnings and errors.")] = False,
) -> None:
    """What a log holds: reader, channels, units, rate, length, gaps, clipping, mains hum; of two, how clocks differ."""
    from ssmr_ident.cli.inspect_folder import common_lines, in_common, line_of
    from ssmr_ident.cli.inspect_log import summary_of
    from ssmr_ident.cli.inspect_save import save_choices
    from ssmr_ident.cli.inspect_screen import show
    from ssmr_ident.cli.progress import doing
    from ssmr_ident.core.errors import InputError
    from ssmr_ident.readers import ReadOptions, read
    from ssmr_ident.readers.folder import logs_in
    from ssmr_ident.workflows.clocks import clocks_of

    options = ReadOptions(
        reader=reader,
        fs=fs,
        units=pairs("--units", units),
        columns=pairs("--columns", columns),
        skip=int(skip[:9]) if skip.isascii() and skip.isdigit() else skip,
        sheets=pairs("--sheets", sheets),
        time_unit=time_unit,
        on_bad=on_bad,
        stamps=stamps,
        trim=trim,
        load_scale=load_scale,
        sample=sample,
        decimal=decimal,
    )
    if not 0 < mains < float("inf"):
        raise InputError("--mains", f"{mains} is no frequency", "Give 50 or 60.")
    files, unread = logs_in(paths, below=True)
    overview = any(path.is_dir() for path in paths)
    summaries, errors = [], list(unread)
    for file in files:
        try:
            with doing(f"reading {file.name}", hidden=quiet or as_json):
                found = [summary_of(recording, mains) for recording in read(file, options)]
        except InputError as error:
            errors.append(error)
            continue
        summaries += found
        if overview and not as_json and not quiet:
            for summary in found:
                typer.echo(line_of(summary))
        elif not as_json:
            show(found, quiet=quiet)
    common = in_common(summaries) if overview else {}
    if overview and not as_json and not quiet:
        for line in common_lines(common, len(summaries)):
            typer.echo(line)
    clocks = None
    try:
        with doing("comparing clocks", hidden=quiet or as_json or len(files) != 2):
            clocks = clocks_of([summary.recording for summary in summaries]) if len(files) == 2 else None
    except InputError as error:
        errors.append(error)
    if clocks is not None and not as_json and not quiet:
        typer.echo(f"both feel one event. {clocks}")
    if save is not None:
        if len(files) != 1 or errors:
            raise errors[0] if errors else InputError("--save", f"{len(files)} logs are named", "Name one log.")
        save_choices(save, files[0], options)
        if not quiet and not as_json:
            typer.echo(f"saved in {save}")
    if as_json:
        from ssmr_ident.cli.answer import print_json

        answer = {
            "logs": [summary.as_dict() for summary in summaries],
            "clocks": [clocks.as_dict()] if clocks else [],
            **({"in_common": common} if overview else {}),
            "errors": [{"where": e.where, "problem": e.problem, "mend": e.mend} for e in errors],
        }
        print_json(answer)
    if len(errors) == 1:
        raise errors[0]
    for problem in errors:
        print(f"ident: {' '.join(str(problem).split())}", file=sys.stderr)
    if errors:
        raise typer.Exit(2)
