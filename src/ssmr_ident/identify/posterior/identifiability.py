"""Directions in parameter space that recordings leave as they were: the null space of the Fisher information."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

Array = np.ndarray
Direction = tuple[tuple[str, float], ...]

UNTOLD = 0.01
"""Share of the prior's information below which the data are said to tell nothing."""

SHOWN = 0.1
"""Share of a direction's largest part from which a parameter is named in it."""


def flat_directions(names: Sequence[str], information: Array) -> tuple[Direction, ...]:
    """Combinations with less information in the data than a hundredth of the prior's; single parameters left out.

    Parameters
    ----------
    names : sequence of str
    information : (n, n) float
        Of the data alone, in prior standard deviations.

    Returns
    -------
    tuple of directions
        Each as shares of its parameters, the largest first.

    Notes
    -----
    Only combinations of parameters that the data do inform in some other combination are named: a
    parameter that no observation depends on is simply not informed.
    """
    touched = [k for k in range(len(names)) if information[k, k] > 1.0]
    if len(touched) < 2:
        return ()
    values, vectors = np.linalg.eigh(information[np.ix_(touched, touched)])
    found = []
    for value, vector in zip(values, vectors.T, strict=True):
        if value > UNTOLD:
            break
        order = np.argsort(-np.abs(vector))
        parts = [
            (names[touched[k]], float(vector[k])) for k in order if abs(vector[k]) > SHOWN * np.max(np.abs(vector))
        ]
        if len(parts) > 1:
            found.append(tuple(parts))
    return tuple(found)
