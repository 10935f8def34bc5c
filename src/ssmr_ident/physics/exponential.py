"""Exponentials of many small matrices, of which a library's are taken one by one in an interpreter."""

from __future__ import annotations

import numpy as np

from ssmr_ident.core.kernel import kernel

TERMS, LARGEST = 13, 0.5
"""Terms of the series, and the largest norm that it is taken of: what is left out is below 1e-14."""


@kernel
def exponentials(matrices):
    """exp of each of (k, n, n) float: Taylor's series of a 2^-m part of it, squared m times.

    Source: Moler and Van Loan, Nineteen Dubious Ways to Compute the Exponential of a Matrix (2003), methods 1 and 3.
    """
    found = np.empty_like(matrices)
    n = matrices.shape[1]
    for k in range(matrices.shape[0]):
        norm = 0.0
        for i in range(n):
            norm = max(norm, np.abs(matrices[k, i]).sum())
        squarings = 0
        while norm > LARGEST and squarings < 1000:
            norm *= 0.5
            squarings += 1
        part = matrices[k] * 0.5**squarings
        e = np.eye(n) + part / TERMS
        for term in range(TERMS - 1, 0, -1):
            e = np.eye(n) + part @ e / term
        for _ in range(squarings):
            e = e @ e
        found[k] = e
    return found
