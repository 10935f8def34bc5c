"""The option ``--effects FILE``, shared by the verbs that know effects: a law of one's own for the length of a call."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer


def _taken(context: typer.Context, files: list[Path] | None) -> list[Path]:
    """Files are run before the verb is, and their effects leave the catalogue when it is done."""
    if files:
        from ssmr_ident.physics.effects import effects_of

        context.with_resource(effects_of(*files))
    return files or []


EffectFiles = Annotated[
    list[Path] | None,
    typer.Option(
        "--effects",
        metavar="FILE",
        help="Python file with an effect of your own, which is run; may be given again (docs/howto/add-effect.md).",
        callback=_taken,
    ),
]
