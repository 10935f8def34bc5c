"""The call as it was typed, for the end of a page."""

from __future__ import annotations

import shlex
import sys


def called() -> str:
    """The command line, quoted so that it can be typed again."""
    return shlex.join(["ident", *sys.argv[1:]])
