"""``ident new``: a session from a folder of logs."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from ssmr_ident.cli import completion
from ssmr_ident.cli.reading_options import Columns, RateHz, Units, pairs

EXAMPLES = (
    "ident new my-logs --mass-kg 2.0",
    "ident new my-logs --robot p3at-extended",
    "ident new pulls --robot p3at-platform --set height_m=0.05 --set floor=carpet",
    "ident new swings --inertia-kg-m2 0.012 --units theta=deg",
    "ident new pulls --mass-kg 12 --set pull-1.csv:speed_mm_s=10",
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
        float | None, typer.Option("--mass-kg", metavar="KG", help="Moving mass of a rig, or mass of a block.")
    ] = None,
    inertia_kg_m2: Annotated[
        float | None, typer.Option("--inertia-kg-m2", metavar="KG_M2", help="Moment of inertia of a rotary rig.")
    ] = None,
    baseline: Annotated[
        str,
        typer.Option(
            help="rigid6, decoupled, sdof, network or drag; left out, the logs decide.",
            autocompletion=completion.baselines,
        ),
    ] = "",
    experiment: Annotated[
        str, typer.Option(help="How every log of a rig or a block was made; left out, the samples decide.")
    ] = "",
    columns: Columns = None,
    units: Units = None,
    fs: RateHz = None,
    answers: Annotated[
        list[str] | None,
        typer.Option(
            "--set",
            metavar="[FILE:]KEY=VALUE",
            help="Answer a question for every recording, or for one: height_m=0.05, pull-1.csv:speed_mm_s=2.",
        ),
    ] = None,
    ask: Annotated[
        bool | None,
        typer.Option("--ask/--no-ask", help="Ask what is a guess, one question at a time. In a terminal: yes."),
    ] = None,
    as_json: Annotated[bool, typer.Option("--json", help="Print what was found as JSON.")] = False,
    quiet: Annotated[bool, typer.Option("-q", "--quiet", help="Print nothing but errors.")] = False,
) -> None:
    """Look at a folder of logs and write a commented session.yaml and a parameter file; never overwrites."""
    import sys
    from dataclasses import replace

    from ssmr_ident.cli.answer import print_json
    from ssmr_ident.cli.new_questions import typed
    from ssmr_ident.cli.progress import progress
    from ssmr_ident.core.errors import InputError
    from ssmr_ident.core.place import Place
    from ssmr_ident.session.schema import KEYS
    from ssmr_ident.workflows.new.draft import refuse_existing
    from ssmr_ident.workflows.new.run import Told, draft_session

    refuse_existing(session)
    if mass_kg is not None and inertia_kg_m2 is not None:
        raise InputError(
            "--inertia-kg-m2", "stands beside --mass-kg", "A rig moves straight or turns: give one of them"
        )
    for option, key, value in (
        ("--mass-kg", "mass_kg", mass_kg),
        ("--inertia-kg-m2", "inertia_kg_m2.xx", inertia_kg_m2),
    ):
        if value is not None:
            KEYS[key].domain.check(Place(option), value)
    told = Told(
        robot=robot,
        mass=inertia_kg_m2 if mass_kg is None else mass_kg,
        baseline=baseline,
        experiment=experiment,
        columns=pairs("--columns", columns),
        units=pairs("--units", units),
        sample_rate_hz=fs,
        answers=_answers(answers or []),
    )
    with progress("reading logs", hidden=quiet or as_json) as step:
        draft = draft_session(session, told, step)
    terminal = sys.stdin.isatty() and sys.stdout.isatty() and not quiet and not as_json
    if terminal if ask is None else ask:
        given = typed(draft)
        if given:
            draft = draft_session(session, replace(told, answers={**told.answers, **given}))
    paths = draft.write()
    if as_json:
        print_json(draft.as_dict())
    elif not quiet:
        typer.echo(str(draft))
        typer.echo(f"written: {paths[0]}, {paths[1]}")
        typer.echo(f"{'fill in what is asked, then' if draft.questions else 'next'}: {draft.next_command}")


def _answers(texts: list[str]) -> dict[str, str]:
    from ssmr_ident.core.errors import InputError

    pairs = {}
    for text in texts:
        key, sign, value = text.partition("=")
        if not (key and sign and value):
            raise InputError("--set", f"{text!r} is no answer", "Write for example --set height_m=0.05")
        pairs[key] = value
    return pairs
