"""The process in which ``apart`` has files read: a pickled request in, the recordings or what is wrong out."""

from __future__ import annotations

import os
import pickle
import sys
from pathlib import Path
from typing import Any

from ssmr_ident.core.errors import InputError
from ssmr_ident.readers.door import reader_for
from ssmr_ident.readers.options import ReadOptions
from ssmr_ident.readers.source import Digest, open_source, source_of


def main() -> None:
    """Answer until nobody asks any more."""
    answers = os.fdopen(os.dup(1), "wb")
    os.dup2(2, 1)  # whatever a library prints is no answer
    while True:
        try:
            asked = pickle.load(sys.stdin.buffer)
        except EOFError:
            return
        pickle.dump(_read(*asked), answers)
        answers.flush()


def _read(folder: str, path: str, member: tuple[str, bytes] | None, options: ReadOptions) -> Any:
    os.chdir(folder)  # where whoever asks is now, so that names are said as they were given
    try:
        source = open_source(path) if member is None else source_of(Path(path), member[1], Digest(b""), member[0])
        return list(reader_for(source, options).read(source, options))
    except InputError as error:
        return error.where, error.problem, error.mend
    except SystemError:  # a library in C that lost its way in a damaged file, as one that ends there
        return None
    except Exception as error:  # a fault of ours is one there, too, and no damage of the file
        return RuntimeError(f"{type(error).__name__}: {error}")


if __name__ == "__main__":
    main()
