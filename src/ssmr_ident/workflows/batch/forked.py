"""Processes forked from one that has imported what sessions need, so that each is ready at once.

A process begun anew takes seconds to import; where a session hangs or kills its own, that would cost its neighbours.
"""

from __future__ import annotations

import os
import select
import signal
import socket
import subprocess
import sys
import threading
from collections.abc import Iterator, Sequence
from contextlib import contextmanager, suppress
from types import TracebackType
from typing import IO


class Forked:
    """One of them, as ``subprocess.Popen`` shows a process."""

    def __init__(self, server: ForkServer, pid: int, ask: int, answered: int) -> None:
        self._server, self.pid = server, pid
        self.stdin: IO[str] | None = os.fdopen(ask, "w", encoding="utf-8")
        self.stdout: IO[str] | None = os.fdopen(answered, encoding="utf-8")
        self._code: int | None = None

    def kill(self) -> None:
        """End it; its number stays its own until somebody asks how it ended."""
        if self._code is None:
            with suppress(ProcessLookupError):
                os.kill(self.pid, signal.SIGKILL)

    def poll(self) -> int | None:
        """Exit status, minus the number of a signal; None while it lives."""
        return self._ended("poll")

    def wait(self) -> int:
        """Exit status, once it has ended."""
        code = self._ended("wait")
        assert code is not None
        return code

    def _ended(self, word: str) -> int | None:
        if self._code is None:
            try:
                said = self._server.told(f"{word} {self.pid}")
            except OSError:  # nobody is left who would be told: it goes with its server
                self.kill()
                said = str(-signal.SIGKILL)
            self._code = int(said) if said else None
        return self._code

    def __enter__(self) -> Forked:
        return self

    def __exit__(self, kind: type[BaseException] | None, error: BaseException | None, at: TracebackType | None) -> None:
        for stream in (self.stdin, self.stdout):
            assert stream is not None
            with suppress(BrokenPipeError):
                stream.close()


class ForkServer:
    """The process that forks; ``ssmr_ident.workflows.batch.child`` is its other half."""

    def __init__(self, command: Sequence[str], environment: dict[str, str]) -> None:
        self._line, theirs = socket.socketpair()
        with theirs:
            self._process = subprocess.Popen(
                [*command, "--fork"], stdin=theirs.fileno(), stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL,
                env=environment, start_new_session=True,
            )  # fmt: skip
        self._answers = self._line.makefile(encoding="ascii")
        self._one_at_a_time = threading.Lock()

    def fork(self, said: IO[str]) -> Forked:
        """A process whose standard error is a file.

        Raises
        ------
        OSError
            The server is gone.
        """
        asked, ask = os.pipe()
        answered, answer = os.pipe()
        try:
            pid = int(self.told("fork", (asked, answer, said.fileno())))
        except OSError:
            os.close(ask)
            os.close(answered)
            raise
        finally:
            os.close(asked)
            os.close(answer)
        return Forked(self, pid, ask, answered)

    def told(self, word: str, descriptors: Sequence[int] = ()) -> str:
        """What the server answers to a word."""
        with self._one_at_a_time:
            socket.send_fds(self._line, [word.encode()], descriptors)
            line = self._answers.readline()
        if not line:
            raise ConnectionResetError("the process that forks has ended")
        return line.strip()

    def kill(self) -> None:
        """End the process, from any thread; who waits for its answer gets an OSError."""
        self._process.kill()

    def close(self) -> None:
        """End the process and let go of it, once nobody asks it any more."""
        self.kill()
        self._process.wait()
        self._answers.close()
        self._line.close()


@contextmanager
def watched(line: socket.socket) -> Iterator[None]:
    """End this process with who started it, while it does not listen; no thread is left for those that it forks."""
    done = threading.Event()
    gone = select.poll()
    gone.register(line, select.POLLRDHUP)

    def watch() -> None:
        while not done.is_set():
            if gone.poll(100):
                os._exit(0)

    thread = threading.Thread(target=watch)
    thread.start()
    try:
        yield
    finally:
        done.set()
        thread.join()


def serve(line: socket.socket) -> None:
    """Fork and tell how those forked ended, until nobody asks any more; returns in every process that was forked."""
    while True:
        word, descriptors, *_ = socket.recv_fds(line, 64, 3)
        verb, _, number = word.decode().partition(" ")
        if not verb:
            os._exit(0)
        if verb == "fork":
            pid = os.fork()
            if pid == 0:
                line.close()
                for place, descriptor in enumerate(descriptors):
                    os.dup2(descriptor, place)
                    os.close(descriptor)
                return
            for descriptor in descriptors:
                os.close(descriptor)
            answer = str(pid)
        else:
            ended, status = os.waitpid(int(number), os.WNOHANG if verb == "poll" else 0)
            answer = str(os.waitstatus_to_exitcode(status)) if ended else ""
        line.sendall(f"{answer}\n".encode())


FORKS = sys.platform == "linux"
"""Elsewhere libraries of the system do not bear it."""
