"""Independent pieces of a fit side by side; compiled loops let go of the interpreter while they run."""

from __future__ import annotations

import os
import threading
from collections.abc import Callable, Iterator, Sequence
from concurrent.futures import ThreadPoolExecutor
from typing import TypeVar

S = TypeVar("S")
T = TypeVar("T")


def processors() -> int:
    """Those that this process may use, which may be fewer than the machine has."""
    if hasattr(os, "sched_getaffinity"):
        return len(os.sched_getaffinity(0))
    return os.cpu_count() or 1


_WORKERS = min(8, processors())
_POOL = ThreadPoolExecutor(max_workers=_WORKERS)
_HERE = threading.local()


def side_by_side(function: Callable[[S], T], items: Sequence[S]) -> Iterator[T]:
    """``function`` of every item, in their order, each as soon as it and those before it are known.

    Whole fits are worth more side by side than the recordings of one: what is called from within another such call
    goes one by one, so nothing waits for a worker that waits for it.
    """
    if _WORKERS == 1 or len(items) < 2 or getattr(_HERE, "inside", False):
        return map(function, items)
    return _POOL.map(_inside(function), items)


def _inside(function: Callable[[S], T]) -> Callable[[S], T]:
    def called(item: S) -> T:
        _HERE.inside = True
        try:
            return function(item)
        finally:
            _HERE.inside = False

    return called
