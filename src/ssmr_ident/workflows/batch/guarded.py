"""A session in a process of its own, which is started once and kept as long as it answers in time."""

from __future__ import annotations

import json
import math
import os
import signal
import subprocess
import sys
import tempfile
import threading
from contextlib import suppress
from pathlib import Path
from typing import IO, Any

from ssmr_ident.core.atomic import write_text
from ssmr_ident.core.documents import json_text
from ssmr_ident.workflows.batch.forked import Forked, ForkServer
from ssmr_ident.workflows.batch.task import ROW, Task

COMMAND = (sys.executable, "-m", "ssmr_ident.workflows.batch.child")


def environment() -> dict[str, str]:
    """Of a process that sessions run in: matrices are small, and threads of their algebra only wait for each other."""
    return {**os.environ, "OPENBLAS_NUM_THREADS": "1"}


class Closed(Exception):
    """Nobody waits for the answer any more."""


class Guarded:
    """Runs one session at a time in a child process; a child that hangs or dies costs its session alone.

    Parameters
    ----------
    timeout : float [s]
        A session may take as long; ``inf`` for any time.
    processor : int or None
        The one that the child keeps to, where the system can say so.
    server : ForkServer or None
        What forks the child; None to begin it anew.
    """

    def __init__(self, timeout: float, processor: int | None = None, server: ForkServer | None = None) -> None:
        self.timeout, self.processor, self.server = timeout, processor, server
        self._child: subprocess.Popen[str] | Forked | None = None
        self._said: IO[str] | None = None
        self._closed = False

    def run(self, task: Task) -> dict[str, Any]:
        """The session's row; ``status`` is ``timeout`` or ``killed`` where its process did not get to write one.

        Raises
        ------
        Closed
            ``close`` was called meanwhile.
        """
        child = self._living()
        if self._closed:
            child.kill()
        assert child.stdin is not None
        assert child.stdout is not None
        late = threading.Event()

        def stop() -> None:
            late.set()
            child.kill()

        timer = threading.Timer(min(self.timeout, threading.TIMEOUT_MAX), stop)
        timer.daemon = True
        if math.isfinite(self.timeout):
            timer.start()
        try:
            child.stdin.write(task.as_line() + "\n")
            child.stdin.flush()
            line = child.stdout.readline()
        except BrokenPipeError:
            line = ""
        finally:
            timer.cancel()
        if line.endswith("\n") and not late.is_set():
            return dict(json.loads(line))
        code, said = self._ended(child)
        if self._closed:
            raise Closed
        if late.is_set():
            return _lost(task, "timeout", f"took longer than {self.timeout:g} s")
        return _lost(task, "killed", f"its process ended with {_death(code, said)}")

    def close(self) -> None:
        """End the child, from any thread; a session that it is at has no row."""
        self._closed = True
        if self._child is not None:
            self._child.kill()

    def stop(self) -> None:
        """End the child, from the thread that runs sessions in it."""
        self.close()
        if self._child is not None:
            self._ended(self._child)

    def _living(self) -> subprocess.Popen[str] | Forked:
        if self._child is not None and self._child.poll() is not None:
            self._ended(self._child)
        if self._child is None:
            self._said = tempfile.TemporaryFile("w+", encoding="utf-8", errors="replace")  # noqa: SIM115 - lives on
            self._child = self._begun(self._said)
            if self.processor is not None and hasattr(os, "sched_setaffinity"):
                os.sched_setaffinity(self._child.pid, {self.processor})
        return self._child

    def _begun(self, said: IO[str]) -> subprocess.Popen[str] | Forked:
        if self.server is not None:
            with suppress(OSError):  # one that has ended costs time alone
                return self.server.fork(said)
        if self._closed:
            said.close()
            raise Closed
        return subprocess.Popen(
            COMMAND, stdin=subprocess.PIPE, stdout=subprocess.PIPE, stderr=said, text=True, encoding="utf-8",
            env=environment(), start_new_session=os.name == "posix",  # the terminal's Ctrl-C is for who waits for all
        )  # fmt: skip

    def _ended(self, child: subprocess.Popen[str] | Forked) -> tuple[int, str]:
        """Let go of a child: its exit status, and the last line that it said."""
        assert self._said is not None
        self._child = None
        with child, self._said as said:
            code = child.wait()
            said.seek(0)
            return code, next((line for line in reversed(said.read().split("\n")) if line.strip()), "")


def _lost(task: Task, status: str, error: str) -> dict[str, Any]:
    row = {"session": task.name, "status": status, "error": error, "fingerprint": task.fingerprint()}
    Path(task.out).mkdir(parents=True, exist_ok=True)
    write_text(Path(task.out) / ROW, json_text(row))
    return row


def _death(code: int, said: str) -> str:
    how = f"signal {signal.Signals(-code).name}" if code < 0 else f"exit status {code}"
    return how + (f": {said.strip()[:200]}" if said else "")
