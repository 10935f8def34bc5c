"""``ident diagnose``."""

from __future__ import annotations

import math
from pathlib import Path
from typing import Annotated

import typer

from ssmr_ident.cli.effect_files import EffectFiles

EXAMPLES = (
    "ident diagnose data/raw/free_response -o out/diagnosis",
    "ident diagnose my-session --params params.yaml -o diagnosis",
    "ident diagnose my-session -o diagnosis --json",
    "ident diagnose my-session -o diagnosis --effects my_law.py",
)


def command(
    session: Annotated[Path, typer.Argument(help="Session folder, or its session.yaml.")],
    output: Annotated[
        Path,
        typer.Option("-o", "--output", help="Folder for diagnosis.yaml, before.yaml, after.yaml and report.html."),
    ],
    params: Annotated[
        str, typer.Option("--params", "-p", help="What is known beforehand; left out: the session's own robot.")
    ] = "",
    effects: EffectFiles = None,
    as_json: Annotated[bool, typer.Option("--json", help="Print the diagnosis as JSON.")] = False,
    quiet: Annotated[bool, typer.Option("-q", "--quiet", help="Print nothing but errors.")] = False,
    budget: Annotated[
        float, typer.Option(min=0.0, help="Seconds after which nothing new is tried on a rig.", show_default="none")
    ] = math.inf,
    seed: Annotated[int, typer.Option(min=0, help="Of permutation tests and simulated floors.")] = 0,
) -> None:
    """Say what physics the simulation leaves out, model it, and show it on recordings that were never fitted."""
    from ssmr_ident.cli.answer import print_json
    from ssmr_ident.cli.called import called
    from ssmr_ident.cli.progress import stages
    from ssmr_ident.core.atomic import refuse_unwritable
    from ssmr_ident.core.errors import InputError
    from ssmr_ident.experiments.campaign import load
    from ssmr_ident.session import read_parameters
    from ssmr_ident.workflows.diagnose import diagnose, write_diagnosis
    from ssmr_ident.workflows.files_read import files_read

    if output.exists() and not output.is_dir():
        raise InputError(str(output), "is a file, expected a folder", "Give another name with -o")
    refuse_unwritable(output)
    known = read_parameters(params) if params else None
    with stages(hidden=quiet or as_json) as step:
        campaign = load(session, lambda done, total: step("reading the logs", done, total))
        diagnosis = diagnose(campaign, known, seed, step, budget)
    write_diagnosis(diagnosis, campaign, output, called(), seed, files_read(session, params))
    if as_json:
        print_json(diagnosis.as_dict(), indent=1)
    elif not quiet:
        print(diagnosis)
        print(f"report: {output / 'report.html'}")
