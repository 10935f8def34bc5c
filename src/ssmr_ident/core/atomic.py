"""A file appears whole or not at all: it is written beside its place and moved there."""

from __future__ import annotations

import secrets
from pathlib import Path
from typing import BinaryIO

from ssmr_ident.core.errors import InputError


def write_bytes(path: str | Path, data: bytes) -> Path:
    """Write bytes to a file at once.

    Raises
    ------
    InputError
        When the folder is missing or may not be written to.
    """
    path = Path(path)
    # Named before it is made: a signal between its making and its name would leave it lying.
    temporary = path.with_name(f".{path.name}.{secrets.token_hex(4)}")
    try:
        with _made(temporary, path) as stream:
            stream.write(data)
        temporary.replace(path)
    except InputError:
        raise
    except BaseException:
        temporary.unlink(missing_ok=True)
        raise
    return path


def _made(temporary: Path, path: Path) -> BinaryIO:
    try:
        return temporary.open("xb")
    except OSError as error:
        raise InputError(str(path), f"cannot be written ({error.strerror})", "Make the folder first.") from error


def write_text(path: str | Path, text: str) -> Path:
    """Write UTF-8 text with plain line ends at once.

    Raises
    ------
    InputError
        When the folder is missing or may not be written to.
    """
    return write_bytes(path, text.encode())
