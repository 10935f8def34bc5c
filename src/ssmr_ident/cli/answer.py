"""An answer as JSON on standard output, and nothing else there."""

from __future__ import annotations

from typing import Any

import typer


def print_json(answer: Any, indent: int | None = None) -> None:
    """Print it; what null stands for in place of a number that is not finite goes to standard error."""
    from ssmr_ident.core.documents import finite, json_text, note_of

    typer.echo(json_text(answer, indent))
    note = note_of(finite(answer)[1])
    if note:
        typer.echo(f"ident: {note}", err=True)
