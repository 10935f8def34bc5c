"""The one numba decorator: cached between processes, and no Python exceptions inside the loop.

numba's default error model checks every division and costs several times the time of the step; with
``error_model="numpy"`` 0/0 gives NaN silently, so whoever runs a kernel checks that its result is finite.

numba asks of a cached loop whether its own file has changed, not whether one has that it calls or takes numbers from:
after an update in place a loop would go on with the old law of a tire, or read its state at the old places.
"""

from __future__ import annotations

import hashlib
import os
from collections.abc import Callable
from contextlib import suppress
from pathlib import Path
from typing import Any

from numba import njit
from numba.core.caching import FunctionCache

STAMP = "compiled_from.sha256"


def forget_other_sources(package: Path) -> bool:
    """Delete what was compiled beside other sources than those that a package has now.

    Parameters
    ----------
    package : Path
        Folder whose files, at whatever depth, kernels are made of. Where it cannot be written to, numba keeps nothing
        there either.

    Returns
    -------
    bool
        Whether sources were other ones, or not known.
    """
    # an interpreter that keeps no bytecode does not make the package's own; numba makes one wherever it keeps loops
    kept = package / "__pycache__"
    if not os.access(kept if kept.is_dir() else package, os.W_OK):
        return False
    kept.mkdir(exist_ok=True)
    digest = hashlib.sha256()
    for file in sorted(package.rglob("*.py")):
        facts = file.stat()
        digest.update(f"{file.relative_to(package)} {facts.st_size} {facts.st_mtime_ns}\n".encode())
    stamp = kept / STAMP
    if stamp.is_file() and stamp.read_text(encoding="ascii") == digest.hexdigest():
        return False
    for index in package.rglob("__pycache__/*.nbi"):
        index.unlink(missing_ok=True)
    stamp.write_text(digest.hexdigest(), encoding="ascii")
    return True


class _Cache(FunctionCache):
    """numba's own, which a full disk costs its use and not the run."""

    def save_overload(self, sig: Any, data: Any) -> None:
        with suppress(OSError):
            super().save_overload(sig, data)  # type: ignore[no-untyped-call]


def kernel(function: Callable[..., Any]) -> Any:
    """Compile a function when it is first called, and keep what was compiled where that can be written."""
    compiled: Any = njit(error_model="numpy", nogil=True, fastmath=False)(function)
    with suppress(RuntimeError):  # numba's word for no folder that may be written to: compiled anew in every run
        compiled._cache = _Cache(function)  # type: ignore[no-untyped-call]
    return compiled


forget_other_sources(Path(__file__).parents[1])
