"""Formats that compiled libraries take apart, read in a process of their own: a damaged file may end the library, and
with it the process that it is in.

The process is started with the first such file, kept for the next, and ends with the one that started it.
"""

from __future__ import annotations

import atexit
import os
import pickle
import subprocess
import sys
import threading
from contextlib import suppress
from dataclasses import replace
from pathlib import Path
from typing import Any

from ssmr_ident.core.errors import InputError
from ssmr_ident.core.recording import Recording
from ssmr_ident.readers.options import ReadOptions
from ssmr_ident.readers.source import Source

KINDS = ("mat", "hdf5", "parquet", "feather")
PATIENCE = 60.0, 10.0
"""Seconds, and further ones for each megabyte: what never ends is stopped, far above what reading takes."""


class Apart:
    """The process, and what is said to it."""

    def __init__(self) -> None:
        self._child: subprocess.Popen[bytes] | None = None
        self._one_at_a_time = threading.Lock()

    def read(self, source: Source, options: ReadOptions) -> list[Recording]:
        """The recordings in a file.

        Raises
        ------
        InputError
            As the reader's, and where the library that reads it ended or did not.
        """
        member = (source.shown, source.data) if source.shown else None
        with self._one_at_a_time:
            answer = self._answer((str(Path.cwd()), str(source.path), member, options), len(source.data))
        if answer is None:
            raise source.error("is damaged: the library that reads it ended, or came to no end", "Save it again.")
        if isinstance(answer, tuple):
            raise InputError(*answer)
        if isinstance(answer, Exception):
            raise answer
        own = source.digest.hex()
        return [replace(found, provenance=replace(found.provenance, sha256=own)) for found in answer]

    def _answer(self, asked: Any, size: int) -> Any:
        child = self._living()
        assert child.stdin is not None
        assert child.stdout is not None
        timer = threading.Timer(PATIENCE[0] + PATIENCE[1] * size / 2**20, child.kill)
        timer.daemon = True
        timer.start()
        try:
            pickle.dump(asked, child.stdin)
            child.stdin.flush()
            return pickle.load(child.stdout)
        except (EOFError, BrokenPipeError, pickle.UnpicklingError):
            self.close()
            return None
        finally:
            timer.cancel()

    def _living(self) -> subprocess.Popen[bytes]:
        if self._child is None or self._child.poll() is not None:
            self.close()
            self._child = subprocess.Popen(
                [sys.executable, "-m", "ssmr_ident.readers.apart_child"],
                stdin=subprocess.PIPE, stdout=subprocess.PIPE, stderr=subprocess.DEVNULL,
                start_new_session=os.name == "posix",  # Ctrl-C is for who waits for it
                env={**os.environ, "PYTHONPATH": os.pathsep.join(path for path in sys.path if path)},
            )  # fmt: skip
        return self._child

    @property
    def running(self) -> int | None:
        """Number of the process, where there is one."""
        return None if self._child is None or self._child.poll() is not None else self._child.pid

    def close(self) -> None:
        """End the process."""
        child, self._child = self._child, None
        if child is not None:
            child.kill()
            with suppress(BrokenPipeError), child:  # what it was still to be told is nobody's loss
                pass


APART = Apart()
atexit.register(APART.close)


def read_apart(source: Source, options: ReadOptions) -> list[Recording]:
    """The recordings in a file of one of ``KINDS``; see ``Apart.read``."""
    return APART.read(source, options)
