"""A file appears whole or not at all: it is written beside its place and moved there."""

from __future__ import annotations

import os
import tempfile
from pathlib import Path

from ssmr_ident.core.errors import InputError


def write_bytes(path: str | Path, data: bytes) -> Path:
    """Write bytes to a file at once.

    Raises
    ------
    InputError
        When the folder is missing or may not be written to.
    """
    path = Path(path)
    try:
        handle, temporary = tempfile.mkstemp(prefix=f".{path.name}.", dir=path.parent)
    except OSError as error:
        raise InputError(str(path), f"cannot be written ({error.strerror})", "Make the folder first.") from error
    try:
        with os.fdopen(handle, "wb") as stream:
            stream.write(data)
        umask = os.umask(0)
        os.umask(umask)
        Path(temporary).chmod(0o666 & ~umask)  # mkstemp makes files that only their owner reads
        Path(temporary).replace(path)
    except BaseException:
        Path(temporary).unlink(missing_ok=True)
        raise
    return path


def write_text(path: str | Path, text: str) -> Path:
    """Write UTF-8 text with plain line ends at once.

    Raises
    ------
    InputError
        When the folder is missing or may not be written to.
    """
    return write_bytes(path, text.encode())
