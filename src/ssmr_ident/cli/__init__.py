"""Reception: each verb becomes a subcommand. No science here; a verb imports what it needs when it is called."""

from __future__ import annotations

import difflib
import errno
import importlib
import io
import logging
import os
import re
import sys
from typing import Annotated, Any, NoReturn

import typer

from ssmr_ident.core.errors import InputError, SimulationError
from ssmr_ident.core.stopping import asked

# Matrices here are small, and threads of the linear algebra only wait for each other: on a busy machine a decay fit
# takes twenty times as long. Set before numpy is first imported, which each verb does on its own.
os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")

VERBS = (
    *("inspect", "spectrum", "geometry", "new", "fit", "simulate", "sweep", "compare", "diagnose", "batch", "export"),
    *("effects", "demo", "proof"),
)

_OF_THE_CALL = (errno.ENAMETOOLONG, errno.ENOENT, errno.ENOTDIR, errno.EISDIR, errno.EACCES, errno.ELOOP)
"""What is wrong with a name that was given, or with its permissions."""

_TOO_LONG = re.compile(r"(\S{100})\S{400,}(\S{100})")
"""A word that no line needs whole."""

UsageError: type[Exception] = typer.BadParameter.__bases__[0]
"""Of the click that typer brings along, whichever that is."""

app = typer.Typer(
    name="ident",
    help="Parameters, simulation and comparison from accelerometer and force logs.",
    epilog="Tab completion: ident --install-completion, or --show-completion to look at it first.",
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
    # paragraphs of an epilog keep their line ends, single lines do not
    app.command(_verb, epilog="\n\n".join(("Examples:", *getattr(_module, "EXAMPLES", ()))))(_module.command)


def main() -> None:
    """Run ``ident``: exit 0 done, 2 the input or the call is wrong, 1 the tool failed, 130 or 143 stopped."""
    # without a home it draws all the same, from a folder of its own that it lets go; nothing that a user need know
    logging.getLogger("matplotlib").setLevel(logging.ERROR)
    for stream in (sys.stdout, sys.stderr):
        if isinstance(stream, io.TextIOWrapper):  # a terminal that knows ASCII alone gets numbers for other letters
            stream.reconfigure(errors="backslashreplace")
    try:
        status = app(prog_name="ident", standalone_mode=False) or 0
        if asked():
            raise KeyboardInterrupt  # which typer has made a status of
        if sys.stdout is not None:
            sys.stdout.flush()
        sys.exit(status)
    except UsageError as error:
        _complain(*_usage(error))
    except InputError as error:
        _complain(str(error))
    except SimulationError as error:
        _complain(f"simulation failed: {error}", status=1)
    except typer.Abort:
        raise KeyboardInterrupt from None
    except BrokenPipeError:  # who read has read enough
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
        sys.exit(1)
    except OSError as error:  # a disk that is full, a name that no file can have
        status = 2 if error.errno in _OF_THE_CALL else 1
        _complain(f"{error.filename or 'standard output'}: {error.strerror or error}", status=status)
    except MemoryError:
        _complain("out of memory: give it fewer or shorter recordings", status=1)


def _usage(error: Any) -> tuple[str, str]:
    """A wrong call in one line, with the nearest name and where to read on."""
    context = error.ctx
    if type(error).__name__ == "NoArgsIsHelpError":  # whose message is the help, unless rich has printed it already
        print(error.format_message(), end="")
        sys.exit(2)
    text = error.format_message().rstrip(".")
    near = getattr(error, "possibilities", None)
    if near:
        nearest = difflib.get_close_matches(str(error.option_name), near, n=1, cutoff=0.0)[0]
        text = f"{text.partition(' (Possible')[0].rstrip('.?')}. Did you mean {nearest}"
    mark = "?" if "Did you mean" in text and not text.endswith("?") else "" if text.endswith("?") else "."
    return text + mark, f"See {context.command_path if context else 'ident'} --help."


def _complain(*parts: str, status: int = 2) -> NoReturn:
    """One line on standard error, and the end; what is left for standard output goes nowhere if it cannot."""
    words = " ".join(" ".join(parts).split())
    print(f"ident: {_TOO_LONG.sub(lambda word: f'{word[1]}…{word[2]}', words)}", file=sys.stderr)
    try:
        sys.stdout.flush()
    except (OSError, AttributeError):
        os.dup2(os.open(os.devnull, os.O_WRONLY), 1)
    sys.exit(status)
