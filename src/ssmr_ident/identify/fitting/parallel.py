"""Independent pieces of a fit side by side; compiled loops let go of the interpreter while they run."""

from __future__ import annotations

import os
import threading
from collections.abc import Callable, Iterator, Sequence
from contextvars import copy_context
from typing import Any, TypeVar

S = TypeVar("S")
T = TypeVar("T")


def processors() -> int:
    """Those that this process may use, which may be fewer than the machine has."""
    if hasattr(os, "sched_getaffinity"):
        return len(os.sched_getaffinity(0))
    return os.cpu_count() or 1


class _Call:
    """What one call asks for; whoever has time takes the next item. Looked at and changed under the pool's lock."""

    def __init__(self, function: Callable[[Any], Any], items: Sequence[Any]) -> None:
        self.function, self.items = function, items
        self.context = copy_context()
        self.taken = 0
        self.results: dict[int, Any] = {}
        self.errors: dict[int, BaseException] = {}

    def work(self, index: int) -> Any:
        # settings of who asked hold wherever it is worked out
        return self.context.copy().run(self.function, self.items[index])


Task = tuple[_Call, int]


class Pool:
    """Threads that work on what is asked for, and on what is asked for from within that.

    Who asks works as well. Whole fits are worth more side by side than the recordings of one: a thread without work
    takes from the call that was begun first, and what is called from within another call goes one by one as long as
    every thread has work. Who waits for an item that another has taken takes from calls begun later than its own,
    that other's among them, so that nothing waits for a thread that waits for it. What holds a lock of its own, as a
    cached property does while it is worked out, must not ask. Why: decision 23.

    Parameters
    ----------
    workers : int
        Threads, the caller's among them.
    """

    def __init__(self, workers: int) -> None:
        self.workers = workers
        self._lock = threading.Lock()
        self._begun, self._ended = threading.Condition(self._lock), threading.Condition(self._lock)
        self._open: list[_Call] = []
        self._idle = self._waiting = self._started = 0

    def side_by_side(self, function: Callable[[S], T], items: Sequence[S]) -> Iterator[T]:
        """``function`` of every item, in their order, each as soon as it and those before it are known."""
        if self.workers == 1 or len(items) < 2 or (self._open and not (self._idle or self._waiting)):
            return map(function, items)
        return self._shared_out(_Call(function, items))

    def _shared_out(self, call: _Call) -> Iterator[Any]:
        with self._lock:
            self._open.append(call)
            while self._started < self.workers - 1:
                self._started += 1
                threading.Thread(target=self._help, name=f"side-by-side-{self._started}", daemon=True).start()
            self._begun.notify(len(call.items))
            if self._waiting:
                self._ended.notify_all()
        try:
            for index in range(len(call.items)):
                yield self._result(call, index)
        finally:
            with self._lock:
                call.taken = len(call.items)  # what nobody has begun is not wanted any more
                self._open.remove(call)

    def _result(self, call: _Call, index: int) -> Any:
        while True:
            with self._lock:
                while index not in call.results and index not in call.errors:
                    later = self._open[: self._open.index(call) : -1]
                    if task := self._next([call, *later]):
                        break
                    self._waiting += 1
                    try:
                        self._ended.wait()
                    finally:
                        self._waiting -= 1
                else:
                    if index in call.errors:
                        raise call.errors.pop(index)
                    return call.results.pop(index)
            self._done(task)

    def _help(self) -> None:
        while True:
            with self._lock:
                while not (task := self._next(self._open)):
                    self._idle += 1
                    self._begun.wait()
                    self._idle -= 1
            self._done(task)
            del task  # or a thread without work would keep what it worked on last

    @staticmethod
    def _next(calls: Sequence[_Call]) -> Task | None:
        for call in calls:
            if call.taken < len(call.items):
                call.taken += 1
                return call, call.taken - 1
        return None

    def _done(self, task: Task) -> None:
        call, index = task
        found: dict[int, Any] = call.results
        try:
            result = call.work(index)
        except BaseException as error:  # raised again where it was asked for
            result, found = error, call.errors
        with self._lock:
            found[index] = result
            if self._waiting:
                self._ended.notify_all()


_POOL = Pool(min(8, processors()))


def side_by_side(function: Callable[[S], T], items: Sequence[S]) -> Iterator[T]:
    """``function`` of every item, in their order, each as soon as it and those before it are known."""
    return _POOL.side_by_side(function, items)
