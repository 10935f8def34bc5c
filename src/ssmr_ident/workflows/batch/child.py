"""The process that sessions run in, one after the other: a line of JSON in is a session, a line out its row.

It ends with who started it, whatever that died of: its standard input is at its end then. Called with ``--fork`` it
reads no sessions but forks processes that do.
"""

from __future__ import annotations

import os
import queue
import socket
import sys
import threading
from importlib import import_module


def main() -> None:
    """Answer until the input ends."""
    if sys.argv[1:] == ["--fork"]:
        from ssmr_ident.workflows.batch.forked import serve, watched

        line = socket.socket(fileno=os.dup(0))
        with watched(line):
            import_module("ssmr_ident.workflows.batch.session_run")
        serve(line)
    answers = os.fdopen(os.dup(1), "w", encoding="utf-8", buffering=1)
    os.dup2(2, 1)  # whatever else is printed is no answer
    lines: queue.SimpleQueue[str] = queue.SimpleQueue()
    threading.Thread(target=_read, args=(lines,), daemon=True).start()
    from ssmr_ident.workflows.batch.session_run import run_session
    from ssmr_ident.workflows.batch.task import Task

    while True:
        print(run_session(Task.from_line(lines.get())), file=answers, flush=True)


def _read(lines: queue.SimpleQueue[str]) -> None:
    for line in sys.stdin:
        lines.put(line)
    os._exit(0)


if __name__ == "__main__":
    main()
