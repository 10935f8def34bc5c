"""``ident effects``."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from ssmr_ident.cli import completion
from ssmr_ident.cli.effect_files import EffectFiles

EXAMPLES = (
    "ident effects",
    "ident effects dry_friction -o dry_friction.png",
    "ident effects --json",
    "ident effects --check my_law.py",
    "ident effects my_law --effects my_law.py -o my_law.png",
)


def command(
    effect_id: Annotated[
        str | None,
        typer.Argument(
            metavar="[ID]",
            help="One effect; left out, the whole list.",
            show_default=False,
            autocompletion=completion.effect_ids,
        ),
    ] = None,
    output: Annotated[
        Path | None, typer.Option("-o", "--output", help="Figure to draw: .png, .svg or .pdf.", show_default=False)
    ] = None,
    check: Annotated[
        Path | None,
        typer.Option(
            metavar="FILE",
            help="Ask a file of your own, which is run, what every effect of the catalogue promises.",
            show_default=False,
        ),
    ] = None,
    effects: EffectFiles = None,
    as_json: Annotated[bool, typer.Option("--json", help="Print as JSON; infinite numbers as text.")] = False,
    quiet: Annotated[bool, typer.Option("-q", "--quiet", help="Print nothing but errors.")] = False,
) -> None:
    """Physics that a model may have left out: equation, parameters, signature, and what each does to a recording."""
    from ssmr_ident.cli.answer import print_json
    from ssmr_ident.cli.progress import doing
    from ssmr_ident.core.errors import InputError
    from ssmr_ident.physics.effects import CATALOGUE
    from ssmr_ident.workflows.effects.catalogue import bearer, catalogue_text, draw, effect_text, effect_values, find

    if check is not None:
        if effect_id is not None or output is not None:
            raise InputError("--check", "takes a file and nothing else", "ident effects --check FILE")
        _check(check, as_json, quiet)
        return
    if effect_id is None:
        if output is not None:
            raise InputError("--output", "a figure shows one effect", "Name it: ident effects ID -o FIGURE.png")
        if as_json:
            print_json([effect_values(effect) for effect in CATALOGUE.values()])
        elif not quiet:
            typer.echo(catalogue_text())
        return
    effect = find(effect_id)
    written = None
    if output is not None:
        with doing(f"simulating with and without {effect.id}", hidden=quiet or as_json):
            written = draw(effect, output)
    if as_json:
        print_json({**effect_values(effect), "figure": None if written is None else str(written)})
    elif not quiet:
        typer.echo(effect_text(effect))
        if written is not None:
            typer.echo(f"\n  figure: {written}")
        elif bearer(effect) != "a rig":  # of which there is no drawing
            typer.echo(f"\n  a figure of it: ident effects {effect.id} -o {effect.id}.png")


def _check(file: Path, as_json: bool, quiet: bool) -> None:
    from ssmr_ident.cli.answer import print_json
    from ssmr_ident.cli.progress import doing
    from ssmr_ident.core.errors import InputError
    from ssmr_ident.workflows.effects.check import check_file

    with doing(f"simulating with and without what {file} holds", hidden=quiet or as_json):
        checked = check_file(file)
    if as_json:
        print_json(checked.as_dict())
    elif not quiet:
        typer.echo(str(checked))
    if checked.failed:
        problem = f"fails {checked.failed} of {len(checked.outcomes)} checks"
        raise InputError(str(file), problem, "Mend what stands behind FAILS")
