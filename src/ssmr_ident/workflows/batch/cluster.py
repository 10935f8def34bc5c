"""Sessions on a Dask cluster whose workers see the same folders as this machine."""

from __future__ import annotations

import threading
from collections.abc import Iterator, Sequence
from itertools import islice
from typing import Any

from ssmr_ident.core.errors import InputError
from ssmr_ident.workflows.batch.guarded import Guarded
from ssmr_ident.workflows.batch.task import Task

_OWN = threading.local()
AT_ONCE = 10
"""Sessions handed out for each thread of the cluster, so that none waits for the next and the scheduler holds few."""


def run_on_cluster(tasks: Sequence[Task], scheduler: str, timeout: float) -> Iterator[dict[str, Any]]:
    """Rows in the order in which they are done; what a lost worker had is done by another.

    Parameters
    ----------
    tasks : sequence of Task
    scheduler : str
        Address, as in ``tcp://10.0.0.1:8786``.
    timeout : float [s]

    Raises
    ------
    InputError
        Dask is missing, or no scheduler answers there.
    """
    try:
        from distributed import Client, as_completed
    except ModuleNotFoundError as error:
        raise InputError("--scheduler", "needs Dask distributed", "pip install 'ssmr_ident[batch]'") from error
    try:
        client = Client(scheduler, timeout=10, set_as_default=False)
    except (OSError, ValueError, ImportError) as error:
        raise InputError(f"--scheduler {scheduler}", "does not answer", "Start one: dask scheduler") from error
    with client, client.as_current():
        waiting = iter(tasks)
        first = AT_ONCE * max(1, sum(client.nthreads().values()))
        begun = [client.submit(_run, task, timeout, pure=False) for task in islice(waiting, first)]
        done = as_completed(begun, with_results=False)
        for future in done:
            yield future.result()
            if (task := next(waiting, None)) is not None:
                done.add(client.submit(_run, task, timeout, pure=False))


def _run(task: Task, timeout: float) -> dict[str, Any]:
    """On a worker, whose thread keeps a process; a row that is there already is not made again."""
    if (row := task.done()) is not None:
        return row
    own: Guarded | None = getattr(_OWN, "child", None)
    if own is None or own.timeout != timeout:
        own = _OWN.child = Guarded(timeout)
    return own.run(task)
