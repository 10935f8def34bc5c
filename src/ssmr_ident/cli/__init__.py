"""Reception: each verb becomes a subcommand. No science here; a verb imports what it needs when it is called."""

from __future__ import annotations

import importlib
import os
import sys
from typing import Annotated

import typer

from ssmr_ident.core.errors import InputError, SimulationError

# Matrices here are small, and threads of the linear algebra only wait for each other: on a busy machine a decay fit
# takes twenty times as long. Set before numpy is first imported, which each verb does on its own.
os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")

VERBS = ("inspect", "spectrum", "geometry", "fit", "simulate", "compare", "effects", "demo")

app = typer.Typer(
    name="ident",
    help="Parameters, simulation and comparison from accelerometer and force logs.",
    no_args_is_help=True,
    add_completion=True,
    pretty_exceptions_enable=False,
    context_settings={"help_option_names": ["-h", "--help"]},
)


def _version(wanted: bool) -> None:
    if wanted:
        from ssmr_ident import __version__

        typer.echo(f"ident {__version__}")
        raise typer.Exit


@app.callback()
def _root(
    version: Annotated[
        bool, typer.Option("--version", callback=_version, is_eager=True, help="Print the version.")
    ] = False,
) -> None:
    pass


for _verb in VERBS:
    _module = importlib.import_module(f"ssmr_ident.cli.{_verb}")
    app.command(_verb)(_module.command)


def main() -> None:
    """Run ``ident``: exit 0 done, 2 the input or the call is wrong, 1 the tool failed."""
    try:
        app()
    except InputError as error:
        print(f"ident: {' '.join(str(error).split())}", file=sys.stderr)
        sys.exit(2)
    except SimulationError as error:
        print(f"ident: simulation failed: {error}", file=sys.stderr)
        sys.exit(1)
