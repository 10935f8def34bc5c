"""A folder of results belongs to one run at a time; the system lets go of it however that run ends."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from ssmr_ident.core.errors import InputError


@contextmanager
def held(folder: Path) -> Iterator[None]:
    """Hold a folder.

    Raises
    ------
    InputError
        Another run has it, or filelock is not installed.
    """
    try:
        from filelock import FileLock, Timeout
    except ModuleNotFoundError as error:
        raise InputError("filelock", "is not installed", "pip install 'ssmr_ident[batch]'") from error
    lock = FileLock(folder / ".held")
    try:
        lock.acquire(timeout=0)
    except Timeout:
        raise InputError(str(folder), "is being written to by another run", "Wait for it, or give another -o") from None
    try:
        yield
    finally:
        lock.release()
