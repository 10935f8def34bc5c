"""Sessions on the processors of this machine."""

from __future__ import annotations

import os
import queue
import threading
from collections.abc import Iterator, Sequence
from typing import Any

from ssmr_ident.workflows.batch.forked import FORKS, ForkServer
from ssmr_ident.workflows.batch.guarded import COMMAND, Closed, Guarded, environment
from ssmr_ident.workflows.batch.task import Task


def run_here(tasks: Sequence[Task], jobs: int, timeout: float) -> Iterator[dict[str, Any]]:
    """Rows in the order in which they are done.

    Parameters
    ----------
    tasks : sequence of Task
    jobs : int
        Processes; 0 for one on each processor that this process may use.
    timeout : float [s]
    """
    allowed = sorted(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else [None] * (os.cpu_count() or 1)
    count = min(jobs or len(allowed), len(tasks))
    waiting: queue.SimpleQueue[Task] = queue.SimpleQueue()
    rows: queue.SimpleQueue[dict[str, Any] | BaseException] = queue.SimpleQueue()
    for task in tasks:
        waiting.put(task)
    server = ForkServer(COMMAND, environment()) if FORKS and count else None
    children = [Guarded(timeout, allowed[k % len(allowed)], server) for k in range(count)]

    def work(child: Guarded) -> None:
        try:
            while True:
                rows.put(child.run(waiting.get_nowait()))
        except (queue.Empty, Closed):
            child.stop()
        except BaseException as error:  # as a full disk: raised again by who waits for the rows
            rows.put(error)

    threads = [threading.Thread(target=work, args=(child,), daemon=True) for child in children]
    for thread in threads:
        thread.start()
    try:
        for _ in tasks:
            row = rows.get()
            if isinstance(row, BaseException):
                raise row
            yield row
    except BaseException:
        if server is not None:
            server.kill()  # a thread may be waiting for what it still imports
        raise
    finally:
        for child in children:
            child.close()
        for thread in threads:
            thread.join()
        if server is not None:
            server.close()
