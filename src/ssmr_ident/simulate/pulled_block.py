"""A block that a drive pulls over a surface: it sticks until it is let go, and slides until it stands.

Between two such moments drive and block are a linear oscillator, which is stepped exactly:

    stuck:    F = k (h - x) + d h'
    sliding:  m x'' = F - f,  F = k (h - x) + d (h' - x'),  f = f_k + (F_0 - f_k) exp(-(x'/v_s)^n)

with the head's position h, the force F_0 at which it was let go, and f_k that may change along the way. It is let go
where the force reaches a threshold, or at moments that are given: those at which a real one was.
"""

from __future__ import annotations

import math

import numpy as np

from ssmr_ident.core.kernel import kernel

Array = np.ndarray

FINE = 0.25
"""Of a radian of the oscillator, in which events are placed along a straight line."""


def pull(
    mass: float,
    stiffness: float,
    damping: float,
    kinetic: Array,
    excess: float,
    head: Array,
    step: float,
    moments: Array | None = None,
    falling: float = 0.0,
    exponent: float = 2.0,
) -> tuple[Array, Array]:
    """Force in the drive, and the forces at which the block was let go.

    Parameters
    ----------
    mass : float [kg]
    stiffness : float [N/m]
    damping : float [N s/m]
        Of the drive, in parallel.
    kinetic : (n,) float [N]
        Friction while it slides.
    excess : float [N]
        Of the static friction over the kinetic one: there it is let go, once all given moments are past.
    head : (n,) float [m]
    step : float [s]
    moments : (k,) float [s], optional
        From the first sample, in order.
    falling, exponent : float [m/s], float
        Speed v_s over which friction falls to the kinetic one, 0: at once; and how steeply.

    Returns
    -------
    (n,) float [N], (j,) float [N]
    """
    given = np.zeros(0) if moments is None else np.asarray(moments, dtype=float)
    force, tops = np.empty(len(head)), np.empty(len(given) + 4096)
    turning = math.sqrt(stiffness / mass)
    substeps = max(1, math.ceil(step * turning / FINE))
    count = _pull(
        mass, stiffness, damping, kinetic, excess, given, falling, exponent, head, step, substeps, force, tops
    )
    return force, tops[: min(count, len(tops))]


@kernel
def _pull(mass, stiffness, damping, kinetic, excess, moments, falling, exponent, head, step, substeps, out, tops):
    z, u, stuck, top, count, given = 0.0, 0.0, True, 0.0, 0, 0
    h = step / substeps
    for n in range(out.shape[0]):
        rate = (head[n + 1] - head[n]) / step if n + 1 < out.shape[0] else (head[n] - head[n - 1]) / step
        force = stiffness * z + damping * (rate if stuck else u)
        out[n] = max(force, 0.0)
        if not stuck:
            u += rate - (head[n] - head[n - 1]) / step if n > 0 else 0.0
        for m in range(substeps):
            left = h
            if stuck:
                begin, now = stiffness * z + damping * rate, n * step + m * h
                if given < moments.shape[0]:
                    wait = moments[given] - now
                else:
                    wait = (kinetic[n] + excess - begin) / (stiffness * rate) if rate > 0.0 else h
                if wait >= h:
                    z += rate * h
                    continue
                wait = max(wait, 0.0)
                z += rate * wait
                left = h - wait
                stuck, u, top = False, rate, stiffness * z + damping * rate
                if given < moments.shape[0]:
                    given += 1
                if count < tops.shape[0]:
                    tops[count] = top
                count += 1
            friction = kinetic[n]
            if falling > 0.0:
                speed = (rate - u) / falling
                friction += (top - kinetic[n]) * math.exp(-(max(speed, 0.0) ** exponent))
            z_next, u_next = _slid(z - friction / stiffness, u, stiffness / mass, damping / mass, left)
            if u_next > rate:  # it would go backwards: it stands
                share = (rate - u) / (u_next - u) if u_next > u else 0.0
                share = min(max(share, 0.0), 1.0)
                z_stop, _ = _slid(z - friction / stiffness, u, stiffness / mass, damping / mass, share * left)
                z = z_stop + friction / stiffness + rate * (1.0 - share) * left
                stuck, u = True, rate
            else:
                z, u = z_next + friction / stiffness, u_next
    return count


@kernel
def _slid(y, u, square, loss, time):
    """(y, u) of y'' + loss y' + square y = 0 after a time."""
    half = 0.5 * loss
    rest = square - half * half
    fall = math.exp(-half * time)
    if rest > 0.0:
        w = math.sqrt(rest)
        c, s = math.cos(w * time), math.sin(w * time) / w
    elif rest < 0.0:
        w = math.sqrt(-rest)
        c, s = math.cosh(w * time), math.sinh(w * time) / w
    else:
        c, s = 1.0, time
    return fall * (y * (c + half * s) + u * s), fall * (u * (c - half * s) - square * y * s)
