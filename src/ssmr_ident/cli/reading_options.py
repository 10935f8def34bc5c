"""Options that say what a log does not say of itself, shared by the verbs that read bare logs."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Annotated

import typer

Columns = Annotated[
    list[str] | None, typer.Option("--columns", metavar="QUANTITY=COLUMN,...", help="Such as time=0,force=2.")
]
Units = Annotated[
    list[str] | None, typer.Option("--units", metavar="COLUMN=UNIT,...", help="Such as force=lbf,position=in.")
]
RateHz = Annotated[float | None, typer.Option("--fs", metavar="HZ", help="Sampling rate, instead of a log's own time.")]


def pairs(option: str, texts: Sequence[str] | None) -> dict[str, str]:
    """``a=1,b=2`` as a mapping; an option may be given several times.

    Raises
    ------
    InputError
        A part that is no pair.
    """
    from ssmr_ident.core.errors import InputError

    found = {}
    for pair in ",".join(texts or ()).split(","):
        if not pair.strip():
            continue
        key, sign, value = (part.strip() for part in pair.partition("="))
        if not (key and sign and value):
            raise InputError(option, f"{pair!r} is no pair", "Write for example force=2,time=0.")
        found[key] = value
    return found
