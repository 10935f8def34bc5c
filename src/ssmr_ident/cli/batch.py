"""``ident batch``."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from ssmr_ident.cli.effect_files import EffectFiles

EXAMPLES = (
    "ident batch sessions -o results",
    "ident batch sessions -o results --jobs 4 --timeout 600",
    "ident batch /shared/sessions -o /shared/results --scheduler tcp://10.0.0.1:8786",
)


def command(
    folder: Annotated[Path, typer.Argument(help="Folder with sessions, at any depth.")],
    output: Annotated[
        Path,
        typer.Option("-o", "--output", help="Folder for tables (Parquet), report.html, each session's files."),
    ],
    params: Annotated[
        str, typer.Option("--params", "-p", help="What is known beforehand of all; left out: each session's own robot.")
    ] = "",
    jobs: Annotated[int, typer.Option(min=0, help="Processes on this machine; 0: one on each processor.")] = 0,
    scheduler: Annotated[
        str, typer.Option(metavar="ADDRESS", help="A Dask scheduler, whose workers must see the same folders.")
    ] = "",
    timeout: Annotated[
        float, typer.Option(min=1.0, metavar="SECONDS", help="What one session may take.", show_default="any time")
    ] = float("inf"),
    diagnose: Annotated[bool, typer.Option(help="Diagnose each session, or only fit it.")] = True,
    report: Annotated[bool, typer.Option(help="Draw each session's page.")] = True,
    retry: Annotated[
        bool, typer.Option("--retry", help="Run again what failed, hung or was killed in an earlier run.")
    ] = False,
    effects: EffectFiles = None,
    as_json: Annotated[bool, typer.Option("--json", help="Print the table of sessions as JSON.")] = False,
    quiet: Annotated[bool, typer.Option("-q", "--quiet", help="Print nothing but errors.")] = False,
    seed: Annotated[int, typer.Option(help="Of random starts, permutation tests and simulated floors.")] = 0,
) -> None:
    """Fit and diagnose every session below a folder; a run that was stopped goes on where it was."""
    from ssmr_ident.cli.called import called
    from ssmr_ident.cli.progress import counted
    from ssmr_ident.session import read_parameters
    from ssmr_ident.workflows.batch.run import run_batch

    if params:
        read_parameters(params)  # told once, and not by every session
    with counted("sessions", hidden=quiet or as_json) as step:
        batch = run_batch(
            folder, output, params=params, diagnose=diagnose, report=report, seed=seed, jobs=jobs, scheduler=scheduler,
            timeout=timeout, retry=retry, command=called(), progress=lambda row, done, total: step(done, total),
            effects=tuple(effects or ()),
        )  # fmt: skip
    if as_json:
        typer.echo(batch.results.sessions.to_json(orient="records", force_ascii=False))
    elif not quiet:
        typer.echo(str(batch))
        typer.echo(f"report: {output / 'report.html'}; tables: {output}/*.parquet (ssmr_ident.read_results)")
