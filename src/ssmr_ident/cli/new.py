"""``ident new``: a session.yaml and a robot.yaml from a folder of logs."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from ssmr_ident.cli import completion

EXAMPLES = (
    "ident new my-logs",
    "ident new my-logs --robot p3at-extended",
    "ident new pulls --robot p3at-platform --set height_m=0.05 --set floor=carpet",
    "ident new rig-logs --baseline sdof --mass-kg 8.2",
)


def command(
    session: Annotated[Path, typer.Argument(help="Folder with the logs; the two files are written into it.")],
    robot: Annotated[
        str,
        typer.Option(
            help="Start from a bundled robot (p3at-extended, p3at-platform) instead of questions.",
            autocompletion=completion.bundled,
        ),
    ] = "",
    mass_kg: Annotated[
        float | None,
        typer.Option("--mass-kg", help="Moving mass of a rig, or mass of a block; kg m^2 for a rotary rig."),
    ] = None,
    baseline: Annotated[
        str,
        typer.Option(
            help="rigid6, decoupled, sdof or drag; left out, the logs decide.", autocompletion=completion.baselines
        ),
    ] = "",
    answers: Annotated[
        list[str] | None,
        typer.Option("--set", metavar="KEY=VALUE", help="Answer a question of every recording: height_m=0.05."),
    ] = None,
    as_json: Annotated[bool, typer.Option("--json", help="Print what was found as JSON.")] = False,
    quiet: Annotated[bool, typer.Option("-q", "--quiet", help="Print nothing but errors.")] = False,
) -> None:
    """Look at a folder of logs and write a commented session.yaml and robot.yaml; never overwrites."""
    from ssmr_ident.cli.answer import print_json
    from ssmr_ident.cli.progress import progress
    from ssmr_ident.workflows.new.run import draft_session, refuse_existing

    refuse_existing(session)
    with progress("reading logs", hidden=quiet or as_json) as step:
        draft = draft_session(session, robot, mass_kg, baseline, _pairs(answers or []), step)
    paths = draft.write()
    if as_json:
        print_json(draft.as_dict())
    elif not quiet:
        typer.echo(str(draft))
        typer.echo(f"written: {paths[0]}, {paths[1]}")
        after = "Fill in what is asked, then" if draft.questions else "Look them over, then"
        typer.echo(f"{after}: ident fit {session} -o params.yaml")


def _pairs(texts: list[str]) -> dict[str, str]:
    from ssmr_ident.core.errors import InputError

    pairs = {}
    for text in texts:
        key, sign, value = text.partition("=")
        if not (key and sign and value):
            raise InputError("--set", f"{text!r} is no answer", "Write for example --set height_m=0.05")
        pairs[key] = value
    return pairs
