"""Independent pieces of work side by side, in threads: compiled loops let go of the interpreter while they run."""

from __future__ import annotations

import os
from collections.abc import Callable, Iterator, Sequence
from concurrent.futures import CancelledError, Future, ThreadPoolExecutor
from contextvars import Context, ContextVar, copy_context
from functools import cache
from threading import Event
from typing import Any, TypeVar

S = TypeVar("S")
T = TypeVar("T")

MOST = 8
"""Threads at the most: half of a fit is the interpreter, which one thread has at a time."""

_NOT_WANTED: ContextVar[tuple[Event, ...]] = ContextVar("not_wanted", default=())


def processors() -> int:
    """Those that this process may use, which may be fewer than the machine has."""
    if hasattr(os, "sched_getaffinity"):
        return len(os.sched_getaffinity(0))
    return os.cpu_count() or 1


@cache
def _threads() -> ThreadPoolExecutor | None:
    """As many as there are processors beside the one that asks, of whom one may be waiting; None for one processor."""
    return ThreadPoolExecutor(min(MOST, processors()), "side-by-side") if processors() > 1 else None


def side_by_side(function: Callable[[S], T], items: Sequence[S]) -> Iterator[T]:
    """``function`` of every item, in their order, each as soon as it and those before it are known.

    Who asks works as well: on what no thread has begun yet. What is asked from within an item is shared out in the same
    way, behind what was asked before, so that whole fits go before the recordings of one; and nothing waits for work
    that has no thread. What holds a lock of its own, as a cached property does while it is worked out, must not ask.

    Where results are not wanted any more, because their reader has gone or an item has failed, what has begun ends at
    the next thing that it asks for itself.
    """
    _still_wanted()
    threads = _threads()
    return map(function, items) if threads is None or len(items) < 2 else _shared_out(threads, function, items)


def _shared_out(threads: ThreadPoolExecutor, function: Callable[[Any], T], items: Sequence[Any]) -> Iterator[T]:
    gone = Event()
    settings = copy_context()  # those of who asks hold wherever an item is worked out
    settings.run(_NOT_WANTED.set, (*_NOT_WANTED.get(), gone))
    asked = {k: threads.submit(settings.copy().run, _work, function, item) for k, item in enumerate(items)}
    untaken = iter(range(len(items)))
    try:
        for index in range(len(items)):
            while not asked[index].done():
                free = next((k for k in untaken if k in asked and asked[k].cancel()), None)
                if free is None:  # a thread has begun it
                    break
                asked[free] = _here(settings.copy(), function, items[free])
            yield asked.pop(index).result()
    finally:
        gone.set()
        for future in asked.values():
            future.cancel()


def _here(settings: Context, function: Callable[[S], T], item: S) -> Future[T]:
    """An item worked out by who asks; what it fails with is raised where its result is read."""
    found: Future[T] = Future()
    try:
        found.set_result(settings.run(_work, function, item))
    except Exception as error:
        found.set_exception(error)
    return found


def _work(function: Callable[[S], T], item: S) -> T:
    _still_wanted()
    return function(item)


def _still_wanted() -> None:
    if any(gone.is_set() for gone in _NOT_WANTED.get()):
        raise CancelledError
