"""Independent pieces of work side by side, in threads: compiled loops let go of the interpreter while they run."""

from __future__ import annotations

import os
from collections.abc import Callable, Iterator, Sequence
from concurrent.futures import CancelledError, Future, ThreadPoolExecutor
from contextvars import Context, ContextVar, copy_context
from functools import cache
from threading import Event, Lock
from typing import Any, TypeVar

S = TypeVar("S")
T = TypeVar("T")

MOST = 8
"""Threads at the most: half of a fit is the interpreter, which one thread has at a time."""

_NOT_WANTED: ContextVar[tuple[Event, ...]] = ContextVar("not_wanted", default=())
"""Of every call that an item is worked out for, from within which it may have been asked."""


def processors() -> int:
    """Those that this process may use, which may be fewer than the machine has."""
    if hasattr(os, "sched_getaffinity"):
        return len(os.sched_getaffinity(0))
    return os.cpu_count() or 1


def side_by_side(function: Callable[[S], T], items: Sequence[S]) -> Iterator[T]:
    """``function`` of every item, in their order, each as soon as it and those before it are known.

    What is asked from within an item is shared out as well where a thread has nothing to do, and goes one by one where
    all have work. What holds a lock of its own, as a cached property does while it is worked out, must not ask.

    Where results are not wanted any more, because their reader has gone or an item has failed, what has begun ends at
    the next thing that it asks for itself.
    """
    return _pool().side_by_side(function, items)


@cache
def _pool() -> Pool:
    return Pool(min(MOST, processors()))


class Pool:
    """Threads for ``side_by_side``.

    Parameters
    ----------
    workers : int
        For one, everything is worked out where it is asked.
    """

    def __init__(self, workers: int) -> None:
        self._workers, self._at_work, self._lock = workers, 0, Lock()
        self._threads = ThreadPoolExecutor(workers, "side-by-side")

    def side_by_side(self, function: Callable[[S], T], items: Sequence[S]) -> Iterator[T]:
        """As the function of that name."""
        _still_wanted()
        within = bool(_NOT_WANTED.get())
        if self._workers == 1 or len(items) < 2 or (within and self._at_work >= self._workers):
            return map(function, items)
        return self._shared_out(function, items, within)

    def _shared_out(self, function: Callable[[Any], T], items: Sequence[Any], within: bool) -> Iterator[T]:
        gone = Event()
        settings = copy_context()  # those of who asks hold wherever an item is worked out
        settings.run(_NOT_WANTED.set, (*_NOT_WANTED.get(), gone))
        asked = {k: self._threads.submit(self._work, settings.copy(), function, item) for k, item in enumerate(items)}
        # a thread that asks works on what no other has begun, so that none waits for work that has no thread
        untaken = iter(range(len(items) if within else 0))
        try:
            for index in range(len(items)):
                while not asked[index].done():
                    free = next((k for k in untaken if k in asked and asked[k].cancel()), None)
                    if free is None:
                        break
                    asked[free] = _here(settings.copy(), function, items[free])
                yield asked.pop(index).result()
        finally:
            gone.set()
            for future in asked.values():
                future.cancel()

    def _work(self, settings: Context, function: Callable[[S], T], item: S) -> T:
        with self._lock:
            self._at_work += 1
        try:
            return settings.run(_wanted, function, item)
        finally:
            with self._lock:
                self._at_work -= 1


def _here(settings: Context, function: Callable[[S], T], item: S) -> Future[T]:
    """An item worked out by who asks; what it fails with is raised where its result is read."""
    found: Future[T] = Future()
    try:
        found.set_result(settings.run(_wanted, function, item))
    except Exception as error:
        found.set_exception(error)
    return found


def _wanted(function: Callable[[S], T], item: S) -> T:
    _still_wanted()
    return function(item)


def _still_wanted() -> None:
    if any(gone.is_set() for gone in _NOT_WANTED.get()):
        raise CancelledError
