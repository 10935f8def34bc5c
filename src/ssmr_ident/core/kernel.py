"""The one numba decorator: cached between processes, and no Python exceptions inside the loop.

numba's default error model checks every division and costs several times the time of the step; with
``error_model="numpy"`` 0/0 gives NaN silently, so whoever runs a kernel checks that its result is finite.
"""

from __future__ import annotations

from numba import njit

kernel = njit(error_model="numpy", nogil=True, cache=True, fastmath=False)
