"""Runs in processes side by side, which end with who began them: when it is asked to stop, and when it is killed."""

from __future__ import annotations

import multiprocessing
import os
import signal
import threading
import time
from collections.abc import Callable, Iterator, Sequence
from concurrent.futures import Future, ProcessPoolExecutor
from contextlib import ExitStack, contextmanager
from pathlib import Path
from typing import Any

from ssmr_ident.core.atomic import remove_begun
from ssmr_ident.physics.effects import effects_of

PATIENCE_S = 0.4
"""For processes that are asked to end to take away what they have begun to write."""

_OWN = ExitStack()
"""Of a process of the pool: what its catalogue has beside the package's."""

Submit = Callable[..., "Future[dict[str, Any]]"]


@contextmanager
def side_by_side(count: int, laws: Sequence[Path]) -> Iterator[Submit]:
    """What gives work to ``count`` processes, each with effects of its own; an error ends them, whatever they are at.

    Parameters
    ----------
    count : int
    laws : sequence of path
        Python files with effects beyond the catalogue.
    """
    others = multiprocessing.active_children()
    spawned = multiprocessing.get_context("spawn")
    pool = ProcessPoolExecutor(count, mp_context=spawned, initializer=_prepared, initargs=tuple(laws))

    def submit(*asked: Any) -> Future[dict[str, Any]]:
        with _deaf():  # processes are begun as work is given out, and hear what who begins them hears
            return pool.submit(*asked)

    try:
        yield submit
    except BaseException:
        _end([child for child in multiprocessing.active_children() if child not in others])
        raise
    finally:
        pool.shutdown(cancel_futures=True)


@contextmanager
def _deaf() -> Iterator[None]:
    """Signals wait; in a process begun meanwhile they wait until it asks for them.

    A terminal's Ctrl-C goes to all processes, and each of them would say that it was interrupted.
    """
    if not hasattr(signal, "pthread_sigmask"):
        yield
        return
    before = signal.pthread_sigmask(signal.SIG_BLOCK, {signal.SIGINT, signal.SIGTERM})
    try:
        yield
    finally:
        signal.pthread_sigmask(signal.SIG_SETMASK, before)


def _end(children: Sequence[Any]) -> None:
    for child in children:
        child.terminate()
    until = time.monotonic() + PATIENCE_S
    for child in children:
        child.join(max(0.0, until - time.monotonic()))
        child.kill()


def _prepared(*laws: Path) -> None:
    """Make a process of the pool ready: it ends when asked to and with who began it, and knows further effects."""
    signal.signal(signal.SIGTERM, _asked_to_end)
    if hasattr(signal, "pthread_sigmask"):
        signal.pthread_sigmask(signal.SIG_UNBLOCK, {signal.SIGTERM})
    threading.Thread(target=_end_with, args=(multiprocessing.parent_process(),), daemon=True).start()
    _OWN.enter_context(effects_of(*laws))


def _asked_to_end(number: int, frame: object) -> None:
    remove_begun()
    os._exit(128 + number)


def _end_with(parent: Any) -> None:
    """A process that was killed cannot end those of its pool, and they would wait for work for ever."""
    parent.join()
    os._exit(1)
