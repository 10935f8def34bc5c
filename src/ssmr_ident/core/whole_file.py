"""A file read whole: a pipe as well, never a device that has no end, and no more than there may be."""

from __future__ import annotations

import stat
from pathlib import Path

from ssmr_ident.core.errors import InputError

_PART = 2**20


def read_whole(path: Path, most: int, mend: str) -> bytes:
    """The bytes of a file, or of a pipe up to its end.

    Parameters
    ----------
    path : Path
    most : int
        Bytes.
    mend : str
        What helps where there are more.

    Raises
    ------
    InputError
        A device or a socket, or more bytes than ``most``.
    OSError, ValueError
        As of ``open``; ValueError for a NUL in the name.
    """
    status = path.stat()
    if not (stat.S_ISREG(status.st_mode) or stat.S_ISFIFO(status.st_mode) or stat.S_ISDIR(status.st_mode)):
        raise InputError(str(path), "is a device or a socket, not a file", "Check the name")
    if status.st_size > most:
        raise InputError(str(path), f"holds {status.st_size / 2**20:.0f} MB, more than {most // 2**20} MB", mend)
    if status.st_size:
        return path.read_bytes()
    parts, count = [], 0
    with path.open("rb") as stream:  # a pipe, or a file of the kernel's, says no size
        while part := stream.read(_PART):
            parts.append(part)
            count += len(part)
            if count > most:
                raise InputError(str(path), f"holds more than {most // 2**20} MB", mend)
    return b"".join(parts)
