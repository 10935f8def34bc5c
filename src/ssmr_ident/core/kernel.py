"""The one numba decorator: cached between processes, and no Python exceptions inside the loop.

numba's default error model checks every division and costs several times the time of the step; with
``error_model="numpy"`` 0/0 gives NaN silently, so whoever runs a kernel checks that its result is finite.
"""

from __future__ import annotations

from collections.abc import Callable
from contextlib import suppress
from pathlib import Path
from typing import Any

from numba import njit
from numba.core.caching import FunctionCache

from ssmr_ident.core.kernel_sources import forget_other_sources


class _Cache(FunctionCache):
    """numba's own, which a full disk costs its use and not the run."""

    def save_overload(self, sig: Any, data: Any) -> None:
        with suppress(OSError):
            super().save_overload(sig, data)  # type: ignore[no-untyped-call]


def kernel(function: Callable[..., Any]) -> Any:
    """Compile a function when it is first called, and keep what was compiled where that can be written."""
    return _kept(function, forceinline=False)


def inlined(function: Callable[..., Any]) -> Any:
    """A kernel that is written out where it is called: to hand over a tuple of arrays costs half a microsecond."""
    return _kept(function, forceinline=True)


def _kept(function: Callable[..., Any], forceinline: bool) -> Any:
    compiled: Any = njit(error_model="numpy", nogil=True, fastmath=False, forceinline=forceinline)(function)
    with suppress(RuntimeError):  # numba's word for no folder that may be written to: compiled anew in every run
        compiled._cache = _Cache(function)  # type: ignore[no-untyped-call]
    return compiled


forget_other_sources(Path(__file__).parents[1])
