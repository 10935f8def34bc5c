"""Kicks in place of a smooth force: what they do to a linear system, and what they leave of it."""

from __future__ import annotations

import numpy as np

Array = np.ndarray


def kicks(a: Array, by_force: Array, step: float) -> tuple[Array, Array]:
    """What one newton adds as a kick of half a step, and how far from the state kicks then leave the system.

    Kicks at the ends of steps are the trapezoidal rule for what a force does; by Euler and Maclaurin they leave
    step^2 / 12 of (B f' - A B f) at the end, and the same with the other sign at the begin. So nothing adds up, and the
    state is known to the fourth order.

    Parameters
    ----------
    a : (…, n, n) float
        State matrix.
    by_force : (…, n) float
        B, what one newton adds to the rate of the states.
    step : float [s]

    Returns
    -------
    kick, aside : (…, n) float
        ``kick`` / 6 is what a force that rises by a newton over the step leaves, ``aside`` what the newton itself does.
    """
    return 0.5 * step * by_force, step**2 / 12.0 * np.einsum("...ij,...j->...i", a, by_force)


def seen_by(rows: Array, by_force: Array, kick: Array, aside: Array) -> tuple[Array, Array]:
    """What channels ``rows``, (…, c, n), show of a force, (…, c), and of its rise over the last step, (…, c), where
    the states are those that kicks leave."""
    return by_force - np.einsum("...ij,...j->...i", rows, aside), np.einsum("...ij,...j->...i", rows, kick) / 6.0
