"""``ident`` as it is typed, in this process: for what it says and how it ends, where no program need be started."""

from __future__ import annotations

import contextlib
import io
import os
import subprocess
from pathlib import Path
from unittest import mock

from ssmr_ident import cli


def typed(*words: str, cwd: Path | None = None, **environment: str) -> subprocess.CompletedProcess[str]:
    """What a program of these words would print, and the status that it would end with."""
    out, told = io.StringIO(), io.StringIO()
    with (
        contextlib.chdir(cwd or Path.cwd()),
        mock.patch("sys.argv", ["ident", *words]),
        mock.patch.dict(os.environ, environment),
        contextlib.redirect_stdout(out),
        contextlib.redirect_stderr(told),
    ):
        try:
            cli.main()
        except SystemExit as end:
            status = end.code
    return subprocess.CompletedProcess(words, int(status or 0), out.getvalue(), told.getvalue())
