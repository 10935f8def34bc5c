"""Inputs judged one after the other in a warm child, each under a limit of processor time, with the memory it took.

A child that hangs or dies is told of and replaced, so that what ends a process is counted and found.
"""

from __future__ import annotations

import multiprocessing
import resource
import signal
import sys
import time
from collections.abc import Callable
from contextlib import suppress
from multiprocessing.connection import Connection
from pathlib import Path
from typing import NamedTuple

from ssmr_ident.readers.apart import APART

SECONDS, MEGABYTES = 2.0, 500
"""Of processor per megabyte of input and at least; of memory, resident."""
PATIENCE_S = 600.0
"""Of the clock, for one input, on a machine that has others to serve."""


class Judged(NamedTuple):
    """What an input came to, the processor time [s] and the largest resident memory [MB] that it took."""

    outcome: str
    seconds: float
    megabytes: float


class Child:
    """A warm child, begun anew when it has hung or died.

    Parameters
    ----------
    folder : Path
        Where inputs are written, each under its name.
    warm : callable
        Given the folder before anything is measured: what is compiled or imported first is no matter of an input.
    judge : callable
        Outcome of a file, as a line.
    addresses_megabytes : int or None
        Address space beyond what a warm child has, above which memory is refused.
    """

    def __init__(
        self,
        folder: Path,
        warm: Callable[[Path], None],
        judge: Callable[[Path], str],
        addresses_megabytes: int | None = None,
    ) -> None:
        self._asked = (folder, warm, judge, addresses_megabytes)
        self._begin()

    def _begin(self) -> None:
        self.line, theirs = multiprocessing.Pipe()
        self.process = multiprocessing.get_context("spawn").Process(target=_child, args=(theirs, *self._asked))
        self.process.start()
        theirs.close()
        self.line.recv()

    def ask(self, name: str, raw: bytes) -> Judged:
        """What an input comes to."""
        self.line.send((name, raw))
        try:
            if self.line.poll(PATIENCE_S):
                return Judged(*self.line.recv())
            told = "hung"
        except EOFError:
            told = "died"
        self.end()
        self._begin()
        return Judged(told, PATIENCE_S, 0.0)

    def end(self) -> None:
        self.line.close()
        self.process.kill()
        self.process.join()


class _Late(BaseException):
    """The processor time of one input is over."""


def _late(number: int, frame: object) -> None:
    raise _Late


def _child(
    line: Connection,
    folder: Path,
    warm: Callable[[Path], None],
    judge: Callable[[Path], str],
    addresses_megabytes: int | None,
) -> None:
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    signal.signal(signal.SIGPROF, _late)
    warm(folder)
    if addresses_megabytes is not None:
        used = int(Path("/proc/self/statm").read_text(encoding="ascii").split()[0]) * resource.getpagesize()
        resource.setrlimit(resource.RLIMIT_AS, (used + addresses_megabytes * 2**20,) * 2)
    line.send("warm")
    while True:
        try:
            name, raw = line.recv()
        except EOFError:
            APART.close()
            return
        path = folder / name
        path.unlink(missing_ok=True)  # a file that is written over is flushed to the disk when it is closed
        path.write_bytes(raw)
        _forget_peaks()
        begun = processor_seconds()
        signal.setitimer(signal.ITIMER_PROF, SECONDS * max(1.0, len(raw) / 1e6))
        try:
            outcome = judge(path)
        except MemoryError:
            outcome = "too large"
        except _Late:
            outcome = "slow"
        signal.setitimer(signal.ITIMER_PROF, 0.0)
        spent = processor_seconds() - begun
        if spent > SECONDS * max(1.0, len(raw) / 1e6):
            outcome = f"slow: {outcome}"
        with suppress(BrokenPipeError):
            line.send((outcome, spent, peak_megabytes()))


def processor_seconds() -> float:
    """Of this process, of the children that have ended, and (Linux) of the one that still reads for it."""
    ended = resource.getrusage(resource.RUSAGE_CHILDREN)
    spent = time.process_time() + ended.ru_utime + ended.ru_stime
    child = APART.running
    if child is not None and sys.platform == "linux":
        with suppress(OSError):  # it has just ended, and is among the children from the next time on
            spent += time.clock_gettime(~child << 3 | 2)  # another process' clock, as clock_getcpuclockid makes it
    return spent


def _measured() -> list[Path]:
    child = APART.running
    return [Path("/proc/self"), *([Path(f"/proc/{child}")] if child is not None else [])]


def _forget_peaks() -> None:
    """Let the peak of memory begin anew."""
    for process in _measured():
        with suppress(OSError):
            (process / "clear_refs").write_text("5", encoding="ascii")


def peak_megabytes() -> float:
    """Largest resident memory since it was forgotten, of this process or of the one that reads for it."""
    peaks = [0.0]
    for process in _measured():
        with suppress(OSError):
            status = (process / "status").read_text(encoding="ascii", errors="replace")
            peaks += [float(row.split()[1]) / 1024 for row in status.splitlines() if row.startswith("VmHWM")]
    return max(peaks)
