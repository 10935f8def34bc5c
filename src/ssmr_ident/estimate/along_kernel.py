"""A law's force along a given path."""

from __future__ import annotations

from ssmr_ident.core.kernel import kernel
from ssmr_ident.physics.element import element_next
from ssmr_ident.simulate.rig_kernel import law_force


@kernel
def force_along(path, drive, step, stiffness, e, terms, gears, out):
    """Fill ``out``, (n,) float [N], along ``path``, (n, ≥ 2) float: deflection and its rate every ``step`` [s];
    ``drive``, (n,) float [N], is what ``gears`` carry."""
    z = (0.0, 0.0, 0.0)
    for n in range(len(path)):
        out[n] = law_force(path[n, 0], path[n, 1], z, n * step, stiffness, drive[n], e, terms, gears)
        if n + 1 < len(path):
            z = element_next(z, (path[n + 1, 0] - path[n, 0]) / step, step, True, e)
