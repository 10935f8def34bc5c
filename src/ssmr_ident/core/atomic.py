"""A file appears whole or not at all: it is written beside its place and moved there."""

from __future__ import annotations

import errno
import os
import secrets
import stat
from collections.abc import Iterable
from contextlib import suppress
from pathlib import Path
from tempfile import TemporaryFile

from ssmr_ident.core.errors import InputError

_BEGUN: set[Path] = set()
"""Files that are not yet in their place."""

_MENDS = {
    errno.ENOSPC: "Make room, or write elsewhere with -o",
    errno.EDQUOT: "Make room, or write elsewhere with -o",
    errno.EFBIG: "Files may not be larger here: write elsewhere with -o",
}


def write_bytes(path: str | Path, data: bytes) -> Path:
    """Write bytes to a file at once; its folder is made, with all that it lies in.

    Raises
    ------
    InputError
        When the folder cannot be made or may not be written to, the disk is full, or a device is called so.
    """
    path = Path(path)
    if not path.name:
        raise InputError(str(path), "is a folder, expected a file", "Give a file's name with -o")
    _refuse_device(path)
    if not path.parent.exists():
        make_folder(path.parent)
    # Named before it is made: a signal between its making and its name would leave it lying.
    temporary = path.with_name(f".{path.name[:60]}.{secrets.token_hex(4)}")
    _BEGUN.add(temporary)
    try:
        with temporary.open("xb") as stream:
            stream.write(data)
        temporary.replace(path)
    except BaseException as error:
        with suppress(OSError):
            temporary.unlink(missing_ok=True)
        if isinstance(error, OSError):
            raise _unwritable(path, error) from error
        raise
    finally:
        _BEGUN.discard(temporary)
    return path


def write_text(path: str | Path, text: str) -> Path:
    """Write UTF-8 text with plain line ends at once; letters of a file name that are no text become their numbers.

    Raises
    ------
    InputError
        When the folder cannot be made or may not be written to, or the disk is full.
    """
    return write_bytes(path, text.encode(errors="backslashreplace"))


def make_folder(path: str | Path) -> Path:
    """A folder with all that it lies in.

    Raises
    ------
    InputError
        When it cannot be made, or a file is called so.
    """
    path = Path(path)
    try:
        path.mkdir(parents=True, exist_ok=True)
    except FileExistsError as error:
        raise InputError(str(path), "is a file, expected a folder", "Give another name with -o") from error
    except OSError as error:
        raise _unwritable(path, error) from error
    return path


def refuse_unwritable(path: str | Path) -> None:
    """Ask before long work whether its answer can be written, and leave nothing behind.

    Raises
    ------
    InputError
        When a folder on the way is a file, or may not be written to, or nothing can be made in it.
    """
    _refuse_device(Path(path))
    above = next(place for place in (Path(path), *Path(path).absolute().parents) if place.exists())
    if above != Path(path) and not above.is_dir():
        raise InputError(str(path), f"cannot be written ({above} is a file)", "Write elsewhere with -o")
    if not os.access(above, os.W_OK):
        raise InputError(str(path), f"cannot be written ({above} is read-only)", "Write elsewhere with -o")
    try:
        with TemporaryFile(dir=above if above.is_dir() else above.parent):
            pass  # a file system has rules of its own, of which its rights say nothing
    except OSError as error:
        raise _unwritable(Path(path), error) from error


def refuse_overwriting(path: str | Path, read: Iterable[str | Path]) -> None:
    """Ask before work whether its answer would take the place of what it is made from.

    Raises
    ------
    InputError
        When ``path`` is one of the files read.
    """
    if any(Path(path).resolve() == Path(file).resolve() for file in read):
        raise InputError(str(path), "is read by this call and would be lost", "Give another name with -o")


def _refuse_device(path: Path) -> None:
    """What takes the place of /dev/null is another's loss."""
    with suppress(OSError):
        mode = path.stat().st_mode
        if not (stat.S_ISREG(mode) or stat.S_ISDIR(mode)):
            raise InputError(str(path), "is a device or a socket, expected a file", "Give another name with -o")


def remove_begun() -> None:
    """Take away what has been begun and will not be ended, as a process is made to end."""
    for temporary in tuple(_BEGUN):
        with suppress(OSError):
            temporary.unlink(missing_ok=True)


def _unwritable(path: Path, error: OSError) -> InputError:
    return InputError(
        str(path), f"cannot be written ({error.strerror})", _MENDS.get(error.errno or 0, "Write elsewhere with -o")
    )
