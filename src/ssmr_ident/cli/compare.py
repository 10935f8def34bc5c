"""``ident compare``: simulation against recordings, or two parameter files or diagnoses against each other."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from ssmr_ident.cli import completion
from ssmr_ident.cli.answer import print_json
from ssmr_ident.cli.called import called
from ssmr_ident.cli.effect_files import EffectFiles

EXAMPLES = (
    "ident compare data/raw/free_response --params out/campaign/parameters.yaml -o out/compare",
    "ident compare my-session --json",
    "ident compare before-repair.yaml after-repair.yaml -o compare",
    "ident compare diagnosis-march diagnosis-june -o compare",
)


def command(
    session: Annotated[
        Path,
        typer.Argument(help="Session folder or its session.yaml; with SECOND a parameter file or a diagnosis' folder."),
    ],
    second: Annotated[
        Path | None,
        typer.Argument(help="Parameter file or diagnosis' folder that the first is held against.", show_default=False),
    ] = None,
    params: Annotated[
        str,
        typer.Option(
            "--params",
            "-p",
            help="Parameter file; left out: the session's own robot.",
            autocompletion=completion.robots,
        ),
    ] = "",
    output: Annotated[
        Path | None, typer.Option("-o", "--output", help="Folder for report.html, overlay plots and compare.csv.")
    ] = None,
    effects: EffectFiles = None,
    as_json: Annotated[bool, typer.Option("--json", help="Print the result as JSON.")] = False,
    quiet: Annotated[bool, typer.Option("-q", "--quiet", help="Print nothing but errors.")] = False,
) -> None:
    """Simulate every recording of a session and say how far it is apart; of two parameter sets, what has changed."""
    from ssmr_ident.cli.progress import stages
    from ssmr_ident.core.atomic import refuse_unwritable
    from ssmr_ident.core.errors import InputError

    if output is not None:
        refuse_unwritable(output)
    if second is not None:
        from ssmr_ident.workflows.compare_two import compare_two

        if params:
            raise InputError("--params", "stands beside a second set", "Leave it out, or name a session alone")
        found = compare_two(session, second, output, called())
        if as_json:
            print_json(found.as_dict())
        elif not quiet:
            print(found)
            if output:
                print(f"report.html and changes.csv in {output}")
        return
    from ssmr_ident.workflows.compare import compare_session

    with stages(hidden=quiet or as_json) as step:
        result = compare_session(session, params, output, step, called())
    if as_json:
        print_json(result.as_dict())
    elif not quiet:
        print(result)
        if output:
            print(f"report.html, figures and compare.csv in {output}")
