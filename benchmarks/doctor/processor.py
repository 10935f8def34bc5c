"""Seconds of the processor, without those in which loops are compiled for the first time on this machine."""

from __future__ import annotations

import time
from collections.abc import Iterator
from contextlib import contextmanager

from numba.core.event import Event, Listener, install_listener


class Compiling(Listener):
    """Adds up what compiling takes of the processor."""

    def __init__(self) -> None:
        self.seconds = 0.0
        self._depth = 0
        self._begun = 0.0

    def on_start(self, event: Event) -> None:
        if self._depth == 0:
            self._begun = time.process_time()
        self._depth += 1

    def on_end(self, event: Event) -> None:
        self._depth -= 1
        if self._depth == 0:
            self.seconds += time.process_time() - self._begun


@contextmanager
def timed(seconds: list[float]) -> Iterator[None]:
    """Put the seconds of what is done within into a list."""
    compiling, begun = Compiling(), time.process_time()
    with install_listener("numba:compile", compiling):
        yield
    seconds.append(time.process_time() - begun - compiling.seconds)
