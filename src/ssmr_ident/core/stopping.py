"""How a run ends that is asked to: within two seconds, without half a file, without a process left behind.

Python calls a signal's handler between two of its own instructions, and a compiled loop or a compiler can be minutes
away from the next. So a thread reads the signal's number from a pipe that the interpreter writes at once, waits for the
polite way to work, and ends the process if it has not.
"""

from __future__ import annotations

import atexit
import os
import signal
import sys
import threading
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager, suppress
from pathlib import Path
from types import FrameType

PATIENCE_S = 1.0
"""For the polite way; with the interpreter's own end it stays below two seconds."""

STOPPED = "ident: stopped; what was being written is not there"


_ASKED: list[int] = []
_DONE: list[int] = []
"""The status with which a run has ended by itself."""


def asked() -> int:
    """The signal that asked this run to end; 0 for none. Who catches ``KeyboardInterrupt`` on its way may lose it."""
    return _ASKED[-1] if _ASKED else 0


@contextmanager
def stoppable() -> Iterator[None]:
    """Turn SIGINT and SIGTERM into ``KeyboardInterrupt``, and into an end where nobody hears it.

    Afterwards either ends the process at once, until its last threads have ended and all is let go that asked to be.
    The process ends there: the interpreter would take itself apart for the better part of a second, on a busy machine
    for many, and hear no signal.
    """
    numbers = (signal.SIGINT, signal.SIGTERM)
    atexit.register(_leave, numbers)  # the first to be registered is the last to be called
    sys.unraisablehook = _unraisable
    _heard_by(_stop, numbers)
    woken, written = _watched(numbers) if os.name == "posix" else (-1, -1)
    try:
        yield
    except SystemExit as end:
        if end.code is None or isinstance(end.code, int):  # words would have to be printed first
            _DONE.append(end.code or 0)
        raise
    finally:
        _heard_by(_end, numbers)
        if woken != -1:
            signal.set_wakeup_fd(woken)
            os.close(written)  # the thread reads its end and ends


def _heard_by(handler: Callable[[int, FrameType | None], None] | signal.Handlers, numbers: tuple[int, ...]) -> None:
    for number in numbers:
        signal.signal(number, handler)


def _watched(numbers: tuple[int, ...]) -> tuple[int, int]:
    """The wake-up descriptor there was, and the writing end of the pipe whose other end a thread reads."""
    reading, writing = os.pipe()
    os.set_blocking(writing, False)
    threading.Thread(target=_watch, args=(reading, numbers), daemon=True).start()
    return signal.set_wakeup_fd(writing, warn_on_full_buffer=False), writing


def _stop(number: int, frame: FrameType | None) -> None:
    _ASKED.append(number)
    raise KeyboardInterrupt


def _end(number: int, frame: FrameType | None) -> None:
    end_now(number)


def _leave(numbers: tuple[int, ...]) -> None:
    _heard_by(signal.SIG_IGN, numbers)
    if _DONE:
        for stream in (sys.stdout, sys.stderr):
            with suppress(AttributeError, OSError, ValueError):  # none there, full, or closed
                stream.flush()
        os._exit(_DONE[-1])


def _unraisable(told: sys.UnraisableHookArgs) -> None:
    """A signal in the midst of a destructor can be raised to nobody: the thread ends the run, without more words."""
    if not (_ASKED and told.exc_type is KeyboardInterrupt):
        sys.__unraisablehook__(told)


def _watch(reading: int, numbers: tuple[int, ...]) -> None:
    while True:
        got = os.read(reading, 1)
        if not got:
            os.close(reading)
            return
        if got[0] in numbers:
            time.sleep(PATIENCE_S)
            end_now(got[0])


def end_now(number: int) -> None:
    """End this process and all that it began, whatever it is doing."""
    atomic = sys.modules.get("ssmr_ident.core.atomic")  # by which nothing has been begun where nobody has imported it
    if atomic is not None:
        atomic.remove_begun()
    for child in _below(os.getpid()):
        with suppress(OSError):
            os.kill(child, signal.SIGKILL)
    with suppress(OSError, ValueError, AttributeError):
        cursor = "\033[?25h" if sys.stderr.isatty() else ""  # a progress bar has hidden it
        os.write(sys.stderr.fileno(), f"{cursor}{STOPPED}\n".encode())
    os._exit(128 + number)


def _below(process: int) -> list[int]:
    """Processes that one has begun, and theirs; Linux knows them by /proc."""
    found: list[int] = []
    for file in Path(f"/proc/{process}/task").glob("*/children"):
        with suppress(OSError):
            for child in map(int, file.read_text(encoding="ascii").split()):
                found += [*_below(child), child]
    return found
