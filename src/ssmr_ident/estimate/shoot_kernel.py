"""Elimination of the states at the borders of stretches: a block-tridiagonal system with a border of parameters."""

from __future__ import annotations

import numpy as np

from ssmr_ident.core.kernel import kernel


@kernel
def eliminate(h, g, step_slopes, rest, weight, n, damping):
    """Normal equations of a chain of stretches, their states eliminated.

    Of sum 1/2 d'H_s d + g_s'd with d = (state s, parameters) and the defects 1/2 |F_s d + r_s - state (s + 1)|_W.

    Parameters
    ----------
    h, g : (s, q, q), (s, q) float
        Per stretch; q = n states and m parameters.
    step_slopes : (s, n, q) float
        F, of a stretch's end.
    rest : (s, n) float
        r, end less the next begin; that of the last stretch does not count.
    weight : (n,) float
    n : int
    damping : (n,) float
        Added to every state's own curvature.

    Returns
    -------
    (m, m), (m,) float
        What is left for the parameters.
    (s, n, n), (s, n, m), (s, n) float
        state s = gain·state (s + 1) + by_par·parameters + base.
    """
    count, q = g.shape
    m = q - n
    left, right = np.zeros((m, m)), np.zeros(m)
    gain, by_par, base = np.zeros((count, n, n)), np.zeros((count, n, m)), np.zeros((count, n))
    p, cross, lin = np.zeros((n, n)), np.zeros((n, m)), np.zeros(n)
    for s in range(count):
        p = p + h[s, :n, :n] + np.diag(damping)
        cross = cross + h[s, :n, n:]
        lin = lin + g[s, :n]
        left += h[s, n:, n:]
        right += g[s, n:]
        if s == count - 1:
            inverse = np.linalg.inv(p)
            by_par[s] = -inverse @ cross
            base[s] = -inverse @ lin
            left -= cross.T @ (inverse @ cross)
            right -= cross.T @ (inverse @ lin)
        else:
            f = np.ascontiguousarray(step_slopes[s, :, :n])
            fg = np.ascontiguousarray(step_slopes[s, :, n:])
            wf = f * weight.reshape((n, 1))
            wfg = fg * weight.reshape((n, 1))
            wr = weight * rest[s]
            inverse = np.linalg.inv(p + f.T @ wf)
            own = cross + f.T @ wfg
            line = lin + f.T @ wr
            gain[s] = inverse @ wf.T
            by_par[s] = -inverse @ own
            base[s] = -inverse @ line
            left += fg.T @ wfg - own.T @ (inverse @ own)
            right += fg.T @ wr - own.T @ (inverse @ line)
            kept = wf @ inverse
            p = np.diag(weight) - kept @ wf.T
            cross = -wfg + kept @ own
            lin = -wr + kept @ line
    return left, right, gain, by_par, base
